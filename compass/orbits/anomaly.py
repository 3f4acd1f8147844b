"""Anomalies: the mean one of the true one."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def mean_of_true(true_anomaly: ArrayLike, eccentricity: ArrayLike) -> NDArray[np.float64]:
    """Mean anomaly, radians, of a true anomaly, in the same revolution.

    ``tan E/2 = sqrt((1-e)/(1+e)) tan nu/2``, ``M = E - e sin E``.

    Parameters
    ----------
    true_anomaly, eccentricity
        Radians and 0 up to below 1, of shapes that broadcast.
    """
    nu, e = np.asarray(true_anomaly, dtype=float), np.asarray(eccentricity, dtype=float)
    turns = 2 * np.pi * np.round(nu / (2 * np.pi))
    half = 0.5 * (nu - turns)
    eccentric = 2 * np.arctan2(np.sqrt(1 - e) * np.sin(half), np.sqrt(1 + e) * np.cos(half))
    return np.asarray(eccentric - e * np.sin(eccentric) + turns)

"""Observability along a flight by the approximations of Yu et al. 2018, in its coordinates."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.papers.yu2018_observability import (
    LINEAR,
    PUBLISHED_QUADRATIC,
    QUADRATIC,
    approximate_degrees,
)
from compass.entry.beacons import Beacons
from compass.entry.model import EntryModel
from compass.papers.spherical import spherical_parameters

Method = Literal["quadratic", "published-quadratic", "linear"]
_NUMBERS = {
    "quadratic": QUADRATIC,
    "published-quadratic": PUBLISHED_QUADRATIC,
    "linear": LINEAR,
}


def approximate_degree(
    model: EntryModel, states: ArrayLike, beacons: Beacons, method: Method, orders: int = 6
) -> NDArray[np.float64]:
    """``sigma_min / sigma_max`` of ranges to beacons at rest, SI, shape (t,).

    Parameters
    ----------
    model, states, beacons
        The world, entry states (t, 6 or 8) and beacons at their times.
    method
        See `compass.core.papers.yu2018_observability.approximate_matrix`.
    orders
        Number of Lie derivatives, the zeroth included.
    """
    x = np.asarray(states, dtype=float)
    x = np.ascontiguousarray(model.full_state(x) if x.shape[-1] < 8 else x)
    r, out = np.ascontiguousarray(beacons.r), np.empty(len(x))
    approximate_degrees(x, spherical_parameters(model), r, orders, _NUMBERS[method], out)
    return out

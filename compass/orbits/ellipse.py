"""Ellipses in closed form: still, or turning at the secular rates of J2."""

import numpy as np
from numpy.typing import NDArray

from compass.core.kepler import elliptic_states
from compass.orbits.constellation import Constellation
from compass.orbits.period import secular_rates


def elliptic(
    c: Constellation, seconds: NDArray[np.float64], *, drifting: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inertial positions (m) and velocities (m/s) at seconds after the epoch, shape (n, t, 3).

    Parameters
    ----------
    c
        The orbits.
    seconds
        Shape (t,).
    drifting
        Whether node, periapsis and mean anomaly drift under J2 (elements are taken as mean).
    """
    still = np.zeros(c.size)
    rates: tuple[NDArray[np.float64], ...] = (still, still, c.mean_motion)
    if drifting:
        rates = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    elements = (c.semi_major_axis, c.eccentricity, c.inclination, c.raan, c.argument_of_periapsis)
    # a copy, for what a constellation holds is read-only, which is another type to the compiler
    r, v = elliptic_states(*np.stack([*elements, c.mean_anomaly, *rates]), seconds)
    return r, v

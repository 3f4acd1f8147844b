"""Impulses from one circular orbit to another: what they cost.

References
----------
.. [1] Vallado 2013, Fundamentals of Astrodynamics and Applications, 4th ed., algorithm 36
   (Hohmann transfer) and section 6.4 (change of the node alone).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_GM


def hohmann(start: ArrayLike, end: ArrayLike, gm: float = MARS_GM.value) -> NDArray[np.float64]:
    """Both impulses of a Hohmann transfer between coplanar circles, m/s.

    ``|v_p - sqrt(GM/r1)| + |sqrt(GM/r2) - v_a|`` with the vis-viva speeds v_p, v_a of the
    transfer ellipse, whose semi-major axis is (r1 + r2)/2 [1]_.

    Parameters
    ----------
    start, end
        Radii r1 and r2, metres.
    gm
        m^3/s^2.
    """
    r1, r2 = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    first = np.sqrt(gm / r1) * np.abs(np.sqrt(2 * r2 / (r1 + r2)) - 1)
    second = np.sqrt(gm / r2) * np.abs(1 - np.sqrt(2 * r1 / (r1 + r2)))
    return np.asarray(first + second)


def node_change(
    radius: ArrayLike, inclination: ArrayLike, turn: ArrayLike, gm: float = MARS_GM.value
) -> NDArray[np.float64]:
    """Impulse that turns the node of a circular orbit, inclination kept, m/s.

    The planes lie theta apart, ``sin(theta/2) = sin i |sin(dRAAN/2)|``, and the impulse at
    their common line is ``2 v sin(theta/2)`` [1]_.

    Parameters
    ----------
    radius, inclination, turn
        Metres; radians.
    gm
        m^3/s^2.
    """
    half = np.sin(inclination) * np.abs(np.sin(np.asarray(turn, dtype=float) / 2))
    return np.asarray(2 * np.sqrt(gm / np.asarray(radius, dtype=float)) * half)

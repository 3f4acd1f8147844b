"""Periods: of an orbit, of the ground tracks, and the radius that keeps pace with Mars."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.bodies import MARS_GM, MARS_J2, MARS_J2_RADIUS, MARS_ROTATION_RATE, sidereal_day
from compass.errors import ArgumentError
from compass.orbits.constellation import Constellation


def orbital_period(semi_major_axis: ArrayLike, gm: float = MARS_GM.value) -> NDArray[np.float64]:
    """Two-body period ``2 pi sqrt(a^3/GM)``, seconds."""
    return 2 * np.pi * np.sqrt(np.asarray(semi_major_axis, dtype=float) ** 3 / gm)


def secular_rates(
    semi_major_axis: ArrayLike,
    eccentricity: ArrayLike,
    inclination: ArrayLike,
    gm: float = MARS_GM.value,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """First-order secular rates of node, periapsis and mean anomaly under J2, rad/s.

    With ``k = 3/2 n J2 (R/p)^2``: ``dRAAN/dt = -k cos i``,
    ``dargp/dt = k (2 - 5/2 sin^2 i)``, ``dM/dt = n + k sqrt(1-e^2) (1 - 3/2 sin^2 i)``.

    References
    ----------
    Vallado 2013, Fundamentals of Astrodynamics and Applications, 4th ed., eqs. 9-37 to 9-41.
    """
    a = np.asarray(semi_major_axis, dtype=float)
    e = np.asarray(eccentricity, dtype=float)
    sin2 = np.sin(inclination) ** 2
    n = np.sqrt(gm / a**3)
    k = 1.5 * n * MARS_J2.value * (MARS_J2_RADIUS.value / (a * (1 - e**2))) ** 2
    return (
        -k * np.cos(inclination),
        k * (2 - 2.5 * sin2),
        n + k * np.sqrt(1 - e**2) * (1 - 1.5 * sin2),
    )


def areosynchronous_radius(
    *, j2: bool = False, inclination: float = 0.0, gm: float = MARS_GM.value
) -> float:
    """Radius of the circular orbit whose ground track closes after one rotation of Mars, metres.

    Without J2, ``a = (GM/omega^2)^(1/3)``. With J2, the radius at which argument of latitude
    keeps pace with Mars under the drifting node: ``dargp/dt + dM/dt = omega - dRAAN/dt``.

    Parameters
    ----------
    j2
        Whether to include the secular rates of J2.
    inclination
        Radians; only the J2 rates depend on it.
    gm
        Gravitational parameter, m^3/s^2.
    """
    omega = MARS_ROTATION_RATE.value
    kepler = float((gm / omega**2) ** (1.0 / 3.0))
    if not j2:
        return kepler

    def pace(a: float) -> float:
        node, periapsis, anomaly = secular_rates(a, 0.0, inclination, gm)
        return float(periapsis + anomaly + node - omega)

    from scipy.optimize import brentq

    return float(brentq(pace, 0.99 * kepler, 1.01 * kepler, xtol=1e-6, rtol=1e-14))


@checked
def areosynchronous_radius_km(*, j2: bool = False, inclination_deg: float = 0.0) -> float:
    """Radius of the circular orbit whose ground track closes after one rotation of Mars, km.

    Parameters
    ----------
    j2
        Whether to include the secular rates of J2.
    inclination_deg
        0 to 180 degrees; only the J2 rates depend on it.

    Raises
    ------
    ArgumentError
        An inclination out of range.

    Examples
    --------
    >>> import compass
    >>> round(compass.areosynchronous_radius_km(), 2)
    20427.68
    """
    if not 0.0 <= inclination_deg <= 180.0:
        raise ArgumentError(f"inclination_deg = {inclination_deg:g}: allowed 0 to 180 degrees")
    return areosynchronous_radius(j2=j2, inclination=math.radians(inclination_deg)) / 1e3


def repeat_radius(revolutions: int, rotations: int, gm: float = MARS_GM.value) -> float:
    """Radius at which so many revolutions take so many rotations of Mars, two-body, metres.

    ``a = (GM/n^2)^(1/3)`` with ``n = omega revolutions/rotations``: the ground track closes.
    """
    motion = MARS_ROTATION_RATE.value * (revolutions / rotations)
    return float((gm / motion**2) ** (1.0 / 3.0))


@dataclass(frozen=True)
class RepeatPeriod:
    """The time after which the ground tracks repeat, as nearly as they do.

    Attributes
    ----------
    duration
        Seconds.
    sidereal_days, revolutions
        Mars rotations and orbits in it; for orbits of unequal period, those of the first.
    closure
        Largest angle by which a satellite can miss its old place in the sky of Mars's centre,
        radians, wherever on its orbit the repeat begins.
    """

    duration: float
    sidereal_days: int
    revolutions: int
    closure: float


def repeat_period(constellation: Constellation, *, max_days: int = 10) -> RepeatPeriod:
    """Smallest whole number of Mars rotations after which the ground tracks (nearly) repeat.

    Of 1 to `max_days` rotations, or of as many as the slowest satellite needs for one and a half
    revolutions, the first in which every satellite makes a revolution or more and comes back to
    within 1 degree in two-body motion; if there is none, the one that closes best. The miss is
    reported either way. An empty constellation repeats at once, after one rotation.
    """
    motion = constellation.mean_motion
    slowest = 2 * np.pi / motion.min() / sidereal_day() if motion.size else 0.0
    longest = max(max_days, int(np.ceil(1.5 * slowest)))
    days, closure = closing_days(motion, longest, constellation.eccentricity)
    duration = int(days) * sidereal_day()
    revolutions = int(np.round(duration * motion[0] / (2 * np.pi))) if motion.size else 0
    return RepeatPeriod(duration, int(days), revolutions, float(closure))


def closing_days(
    mean_motion: ArrayLike, max_days: int = 10, eccentricity: ArrayLike = 0.0
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Rotations of Mars in the `repeat_period` of orbits of these mean motions, and its closure.

    Parameters
    ----------
    mean_motion
        rad/s, shape (..., n): n satellites of each of many constellations.
    max_days
        Most rotations.
    eccentricity
        Of each, broadcast.
    """
    days = np.arange(1, max_days + 1)
    motion = np.asarray(mean_motion, dtype=float)[..., np.newaxis, :]
    turns = (days * sidereal_day())[:, np.newaxis] * motion / (2 * np.pi)
    behind = 2 * np.pi * np.abs(turns - np.round(turns))
    e = np.broadcast_to(eccentricity, np.shape(mean_motion))[..., np.newaxis, :]
    each = np.where(turns >= 0.5, widest_miss(behind, e), np.inf)
    miss = each.max(axis=-1, initial=0.0)
    close = miss <= np.radians(1.0)
    best = np.where(close.any(axis=-1), close.argmax(axis=-1), miss.argmin(axis=-1))
    return days[best], np.take_along_axis(miss, best[..., np.newaxis], axis=-1)[..., 0]


def widest_miss(behind: ArrayLike, eccentricity: ArrayLike) -> NDArray[np.float64]:
    """Widest angle in the sky between places on an orbit that mean anomalies set apart, radians.

    The true anomaly runs fastest, and evenly to both sides, at periapsis: the widest angle is
    ``2 nu(behind/2)``, with ``tan(nu/2) = sqrt((1 + e)/(1 - e)) tan(E/2)``.

    Parameters
    ----------
    behind
        Difference of mean anomalies, 0 to pi radians.
    eccentricity
        Broadcast against it.
    """
    half, e = np.broadcast_arrays(np.asarray(behind, dtype=float) / 2, eccentricity)
    if not np.any(e > 0):
        return 2 * half
    low, high = half, np.minimum(half / (1 - e), np.pi)
    for _ in range(60):  # E - e sin E grows with E
        middle = 0.5 * (low + high)
        short = middle - e * np.sin(middle) < half
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return np.asarray(4 * np.arctan(np.sqrt((1 + e) / (1 - e)) * np.tan(high / 2)))

"""The Earth and the Sun as seen from Mars."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import ASTRONOMICAL_UNIT
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, mci_from_icrf

_J2000_JULIAN_DATE = 2451545.0
_MARS = 4
_RANGE_SECONDS = 100.0 * 365.25 * SECONDS_PER_DAY


def sun_earth_states(seconds: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Sun and the Earth from Mars's centre, ICRF: states, shape (t, 6), m and m/s.

    Geometric, without light time and aberration, which together turn the direction of the Earth
    by the relative speed over that of light: at most 39 arcseconds.

    Parameters
    ----------
    seconds
        TDB seconds past J2000, shape (t,); 1900 to 2100.

    Raises
    ------
    ArgumentError
        A time outside 1900 to 2100, where the theories hold.

    References
    ----------
    1. Mars: Simon et al. 1994, Astron. Astrophys. 282:663, with their largest error over 1800
       to 2050 of 17 arcseconds in longitude (``plan94`` of ERFA).
    2. Earth: Moisson and Bretagnon 2001, Celest. Mech. Dyn. Astron. 80:205 (VSOP2000),
       simplified; within 12 km of DE405 over 1900 to 2100 (``epv00`` of ERFA).
    """
    sun, days = sun_states(seconds)
    import erfa

    return sun, _flat(erfa.epv00(_J2000_JULIAN_DATE, days)[0]) + sun


def sun_states(seconds: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Sun alone as `sun_earth_states` does, and the days past J2000, shape (t,)."""
    t = np.atleast_1d(np.asarray(seconds, dtype=float))
    if np.any(np.abs(t) > _RANGE_SECONDS):
        raise ArgumentError(
            "epoch: Earth and Sun are known from 1900 to 2100; choose an epoch and duration inside"
        )
    import erfa

    days = t / SECONDS_PER_DAY
    return -_flat(erfa.plan94(_J2000_JULIAN_DATE, days, _MARS)), days


def _flat(pv: NDArray) -> NDArray[np.float64]:
    """States (t, 6) in SI of ERFA's structured positions and velocities in au and au/day."""
    au = ASTRONOMICAL_UNIT.value
    return np.concatenate([pv["p"] * au, pv["v"] * (au / SECONDS_PER_DAY)], axis=-1)


def sun_mci(epoch: float, times: ArrayLike) -> NDArray[np.float64]:
    """Places of the Sun, which take less than the Earth's, as `sun_earth_mci`, m, shape (t, 3)."""
    sun, _ = sun_states(epoch + np.atleast_1d(np.asarray(times, dtype=float)))
    return np.asarray(sun[:, :3] @ mci_from_icrf(epoch).T)


def sun_earth_mci(
    epoch: float, times: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return `sun_earth_states` in the inertial frame of `epoch`, at seconds after it."""
    rotation = mci_from_icrf(epoch)
    sun, earth = sun_earth_states(epoch + np.atleast_1d(np.asarray(times, dtype=float)))
    turned = [(s.reshape(-1, 2, 3) @ rotation.T).reshape(-1, 6) for s in (sun, earth)]
    return turned[0], turned[1]


def sun_earth_mars_angle(seconds: ArrayLike) -> NDArray[np.float64]:
    """Angle Sun-Earth-Mars: how far Mars stands from the Sun in the Earth's sky, radians, (t,)."""
    sun, earth = sun_earth_states(seconds)
    to_sun, to_mars = sun[:, :3] - earth[:, :3], -earth[:, :3]
    return _angle(to_sun, to_mars)


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))


def conjunction_seasons(
    epoch: float, duration: float, threshold: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Spans in which Mars stands closer to the Sun in the Earth's sky than a threshold.

    Parameters
    ----------
    epoch
        TDB seconds past J2000.
    duration
        Length of the search after it, seconds.
    threshold
        Sun-Earth-Mars angle, radians.

    Returns
    -------
    begins, ends
        Seconds after the epoch, to a second. The angle is sampled daily, over which it moves by
        less than a degree: a season shorter than a day may be missed.
    """
    from scipy.optimize import brentq

    def excess(t: float) -> float:
        return float(sun_earth_mars_angle([epoch + t])[0]) - threshold

    count = max(int(np.ceil(duration / SECONDS_PER_DAY)) + 1, 2)
    times = np.linspace(0.0, duration, count)
    above = sun_earth_mars_angle(epoch + times) - threshold >= 0
    turns = [
        brentq(excess, times[k], times[k + 1], xtol=0.5)
        for k in np.flatnonzero(above[1:] != above[:-1])
    ]
    edges = np.array(([] if above[0] else [0.0]) + turns + ([] if above[-1] else [duration]))
    return edges[::2], edges[1::2]

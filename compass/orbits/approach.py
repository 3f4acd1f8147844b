"""How near satellites come to Phobos and Deimos on their paths."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.motion import states
from compass.moons import MoonName, moon_row
from compass.orbits.trajectory import Trajectory

MOONS: tuple[MoonName, ...] = ("phobos", "deimos")

#: First step, s, and to what the least distance is found, m: the moons' theory errs by 45 km.
STEP, GOOD = 3600.0, 100.0


@dataclass(frozen=True)
class Approach:
    """The least distance of any satellite from a moon's centre.

    Attributes
    ----------
    moon, satellite
        Names.
    time
        Seconds after the epoch.
    distance
        Metres.
    """

    moon: MoonName
    satellite: str
    time: float
    distance: float


def closest_approaches(path: Trajectory, start: float, stop: float) -> tuple[Approach, ...]:
    """The closest approach to each moon, found by halving intervals of time.

    Within h of a moment a distance d changes by less than ``(V + v) h``, V and v the fastest that
    satellites and the moon move: an interval in which this leaves more than the least distance
    known is done with. To `GOOD`.

    Parameters
    ----------
    path
        Where satellites are.
    start, stop
        Seconds after the epoch.
    """
    return tuple(_closest(path, name, start, stop) for name in MOONS)


def _closest(path: Trajectory, name: MoonName, start: float, stop: float) -> Approach:
    row = moon_row(name, path.epoch, 0.5 * (start + stop))
    count = max(int(np.ceil((stop - start) / STEP)), 1)
    half = 0.5 * (stop - start) / count
    middles = np.asarray(start + half * (2.0 * np.arange(count) + 1.0), dtype=np.float64)
    speed = _fastest(path, row, middles)
    open_at = np.tile(middles, (path.size, 1))
    which = np.repeat(np.arange(path.size), count)
    times = open_at.ravel()
    best = (np.inf, 0, start)
    while times.size:
        distance = _distances(path, row, which, times)
        k = int(distance.argmin())
        if distance[k] < best[0]:
            best = (float(distance[k]), int(which[k]), float(times[k]))
        kept = distance - speed * half < best[0] - GOOD
        half *= 0.5
        which = np.repeat(which[kept], 2)
        times = (times[kept][:, None] + half * np.array([-1.0, 1.0])).ravel()
    return Approach(name, path.satellite_names[best[1]], best[2], best[0])


def _distances(
    path: Trajectory, row: NDArray[np.float64], which: NDArray, times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances of satellites from a moon, one a time, shape (k,)."""
    moon = states(row, np.zeros((1, 6)), times)[:, :3]
    distances = np.empty(times.size)
    for s in np.unique(which):
        own = which == s
        one = path.only(int(s)).states(times[own])[0][0]
        distances[own] = np.linalg.norm(one - moon[own], axis=-1)
    return distances


def _fastest(path: Trajectory, row: NDArray[np.float64], times: NDArray[np.float64]) -> float:
    """Bound on how fast a distance changes, m/s: speeds at moments, and a hundredth more."""
    v = path.states(times)[1]
    moon = states(row, np.zeros((1, 6)), times)[:, 3:]
    fastest = [float(np.linalg.norm(x, axis=-1).max()) for x in (v, moon)]
    return 1.01 * sum(fastest)

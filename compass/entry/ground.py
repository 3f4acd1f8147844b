"""Where landers come down: sites and regions, each by turns, and the entries that lead there.

An entry is aimed by flying it from its own goal: where it then comes down says how the whole flight
must be turned about Mars's centre to end at the goal. The turn changes the air's speed over the
ground a little; aimed again from there, what is left shrinks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, log2
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.entry.arrivals import Arrivals, draw_arrivals
from compass.errors import ArgumentError
from compass.frames import direction, east_north_up, latitude_longitude

Array = NDArray[np.float64]

#: Points among which those inside a region are looked for, at most.
MOST_POINTS = 1 << 20

#: How often flights are aimed; the first turns them by the whole length of a flight.
AIMED = 3


class Area(Protocol):
    """A part of the sphere."""

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether unit vectors (..., 3) lie inside."""

    def latitudes(self) -> tuple[float, float]:
        """Least and greatest latitude, radians."""


@dataclass(frozen=True)
class Ground:
    """Where landers come down.

    Attributes
    ----------
    names
        Of the sites and regions.
    places
        Latitude and longitude of each that is a site, radians; None of regions.
    areas
        Parts of each that is a region, any of which will do; none of sites.
    """

    names: tuple[str, ...]
    places: tuple[tuple[float, float] | None, ...]
    areas: tuple[tuple[Area, ...], ...]

    def draw(self, count: int, seed: int) -> Arrivals:
        """Goals of so many entries, by turns at each site and spread evenly over each region.

        Azimuths, of the flight where it ends, and moments as of
        `compass.entry.arrivals.draw_arrivals`, with its errors; and a region too small to be met.
        """
        drawn = draw_arrivals(count, seed)
        latitude, longitude = drawn.latitude.copy(), drawn.longitude.copy()
        for k, place in enumerate(self.places):
            turn = slice(k, count, len(self.places))
            wanted = len(range(*turn.indices(count)))
            if place is None:
                latitude[turn], longitude[turn] = self._spread(k, wanted, seed)
            else:
                latitude[turn], longitude[turn] = place
        return Arrivals(latitude, longitude, drawn.azimuth, drawn.phase)

    def kept(self, tried: Arrivals, instead: Arrivals) -> Arrivals:
        """Return goals that lie in a region, and others' place where they do not."""
        points = direction(tried.latitude, tried.longitude)
        inside = self._inside(points, [part for parts in self.areas for part in parts])
        latitude = np.where(inside, tried.latitude, instead.latitude)
        longitude = np.where(inside, tried.longitude, instead.longitude)
        return Arrivals(latitude, longitude, tried.azimuth, tried.phase)

    def _spread(self, k: int, wanted: int, seed: int) -> tuple[Array, Array]:
        """Latitudes and longitudes of points in a region."""
        from scipy.stats import qmc

        parts = self.areas[k]
        ends = np.array([part.latitudes() for part in parts])
        low, high = np.sin([ends.min(), ends.max()])
        stream = qmc.Sobol(2, scramble=True, seed=np.random.default_rng([seed, k]))
        size = 1 << max(ceil(log2(max(wanted, 1))), 4)
        inside, tried = np.empty((0, 3)), 0
        while len(inside) < wanted and tried < MOST_POINTS:
            u, v = stream.random(size).T
            points = direction(np.arcsin(low + (high - low) * u), 2.0 * np.pi * v - np.pi)
            inside = np.concatenate([inside, points[self._inside(points, parts)]])
            tried += size
            size = tried
        if not len(inside):
            raise ArgumentError(f"region = {self.names[k]}: too small to land in; name a site")
        latitude, longitude = latitude_longitude(np.resize(inside, (wanted, 3)))
        return np.asarray(latitude), np.asarray(longitude)

    @staticmethod
    def _inside(points: Array, parts: "list[Area] | tuple[Area, ...]") -> NDArray[np.bool_]:
        inside = np.zeros(len(points), dtype=bool)
        for part in parts:
            inside |= part.contains(points)
        return inside


def aimed(fly: Callable[[Arrivals], tuple[Array, Array]], goals: Arrivals) -> Arrivals:
    """Entries that come down at goals, on the azimuths wanted there.

    Parameters
    ----------
    fly
        Latitudes and longitudes at which entries come down, radians.
    goals
        Where they are to; to some metres of flights of a few hundred kilometres (tests).
    """
    wanted = direction(goals.latitude, goals.longitude)
    place = wanted
    east, north, _ = np.moveaxis(east_north_up(goals.latitude, goals.longitude), -2, 0)
    heading = np.sin(goals.azimuth)[:, None] * east + np.cos(goals.azimuth)[:, None] * north
    entries = goals
    for _ in range(AIMED):
        came = direction(*fly(entries))
        place, heading = (_turned(vector, came, wanted) for vector in (place, heading))
        latitude, longitude = latitude_longitude(place)
        east, north, _ = np.moveaxis(east_north_up(latitude, longitude), -2, 0)
        azimuth = np.arctan2((heading * east).sum(axis=1), (heading * north).sum(axis=1))
        entries = Arrivals(latitude, longitude, azimuth % (2 * np.pi), goals.phase)
    return entries


def _turned(vectors: Array, start: Array, end: Array) -> Array:
    """Vectors turned as the shortest turn from unit vectors to others turns them, (m, 3)."""
    axis = np.cross(start, end)
    cosine = (start * end).sum(axis=1, keepdims=True)
    along = (axis * vectors).sum(axis=1, keepdims=True)
    return np.asarray(cosine * vectors + np.cross(axis, vectors) + axis * along / (1.0 + cosine))

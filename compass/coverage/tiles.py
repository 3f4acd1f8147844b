"""The place where a share is least: tiles of latitude and longitude by bounds, halved.

The share at one place is a bound from above; of a tile there is one from below of which no place
has less. The tile whose bound is lowest is looked at in its middle, or where it meets the
region, and halved.
"""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from compass.core.compiling import worked
from compass.coverage.region import GLOBE, Region
from compass.frames import Figure, direction, planetocentric_latitude

#: Longest sides of the first tiles, radians: of latitudes alone, and where longitudes count too.
FIRST, FIRST_OF_PLACES = 0.1, 0.4

#: South, north (geodetic), west and east of a tile, radians.
Sides = tuple[float, float, float, float]


@dataclass(frozen=True)
class Least:
    """A least share between bounds, the geodetic latitude of the place with the upper, the cost."""

    low: float
    high: float
    latitude: float
    looked: int
    stopped: str


@dataclass(frozen=True)
class Tiles:
    """Where the least share is looked for, and how.

    Attributes
    ----------
    bound
        Of a tile the share of which no place has less, what its middle has at least, and boxes
        looked at.
    at
        Of a place (geodetic latitude, longitude) a share from above, and boxes looked at.
    figure
        On which the places are.
    places
        Whether every place counts by itself; else all of a circle of latitude count alike.
    region
        Of which places count, where they do by themselves.
    longitudes
        West and east of the stretch that stands for all.
    """

    bound: Callable[[Sides], tuple[float, float, int]]
    at: Callable[[float, float], tuple[float, int]]
    figure: Figure
    places: bool = False
    region: Region = GLOBE
    longitudes: tuple[float, float] = (-np.pi, np.pi)

    def least(
        self,
        south: float,
        north: float,
        *,
        width: float,
        level: float | None,
        most: float,
        seconds: float = np.inf,
        narrow: float = np.inf,
    ) -> Least:
        """Bracket the least share between two geodetic latitudes.

        Until the bounds are `width` apart, or both on one side of `level` and `narrow` apart, or
        `most` boxes or `seconds` are spent; of tiles that are not looked at by then nothing is
        known.
        """
        tiles: list[tuple[float, Sides, float]] = []
        high, where, looked, began = 1.0, south, 0, worked()

        def spent() -> str:
            late = worked() - began >= seconds
            return "boxes" if looked >= most else "time" if late else ""

        def push(tile: Sides, known: float = 0.0) -> None:
            nonlocal looked
            if not self._outside(tile):
                low, middle, boxes = (known, known, 0) if spent() else self.bound(tile)
                looked += boxes
                heapq.heappush(tiles, (low, tile, middle))

        def look(tile: Sides) -> None:
            nonlocal looked, high, where
            if spot := next(self._spots(tile), None):
                value, boxes = self.at(*spot)
                looked += boxes
                if value <= high:
                    high, where = value, spot[0]

        longest = FIRST_OF_PLACES if self.places else FIRST
        columns = _parts(*self.longitudes, longest) if self.places else [(0.0, 0.0)]
        for rows, turn in product(_parts(south, north, longest), columns):
            push((*rows, *turn))
        stopped = ""
        while tiles:
            low, tile, middle = tiles[0]
            told = level is not None and (low >= level or high < level)
            if high - low <= width or (told and high - low <= narrow):
                break
            if stopped := spent():
                break
            heapq.heappop(tiles)
            if middle < high:
                look(tile)
            for half in self._halves(tile):
                push(half, low)
        if high == 1.0 and tiles:  # told from below alone: say what a place has too
            look(tiles[0][1])
        return Least(min(tiles[0][0] if tiles else 1.0, high), high, where, looked, stopped)

    def _spots(self, tile: Sides) -> Iterator[tuple[float, float]]:
        """Places of a tile in the region: of its middle, its sides and corners."""
        south, north, west, east = tile
        for part, along in product((0.5, 0.0, 1.0), (0.5, 0.0, 1.0)):
            latitude, longitude = south + part * (north - south), west + along * (east - west)
            if not self.places or self.region.contains(self._direction(latitude, longitude)):
                yield latitude, longitude

    def _halves(self, tile: Sides) -> tuple[Sides, Sides]:
        south, north, west, east = tile
        middle = 0.5 * (south + north)
        if self.places and (east - west) * np.cos(middle) > north - south:
            cut = 0.5 * (west + east)
            return (south, north, west, cut), (south, north, cut, east)
        return (south, middle, west, east), (middle, north, west, east)

    def _outside(self, tile: Sides) -> bool:
        """Whether no place of a tile is in the region, surely."""
        if not (self.places and self.region.mars_fixed):
            return False
        south, north, west, east = tile
        # a planetocentric latitude turns by at most so much of the geodetic one
        reach = 0.5 * (north - south) * self.figure.stretch**2 + 0.5 * (east - west) + 1e-9
        middle = self._direction(0.5 * (south + north), 0.5 * (west + east))
        return bool(np.any(self.region.normals @ middle - self.region.floors < -reach))

    def _direction(self, latitude: float, longitude: float) -> np.ndarray:
        return direction(float(planetocentric_latitude(latitude, self.figure)), longitude)


def _parts(low: float, high: float, longest: float) -> list[tuple[float, float]]:
    """Equal parts of a stretch, none longer than that."""
    count = max(int(np.ceil((high - low) / longest)), 1)
    return list(pairwise(np.linspace(low, high, count + 1).tolist()))

"""The share of time with a small dilution, or error, at the worst place of a region.

The share at one place is a bound from above; for a tile of latitudes, and of longitudes where they
count, the time in which all of it keeps the limit is one from below (`compass.core.certified`). The
tile whose bound is lowest is looked at in its middle, or where it meets the region, and halved.
"""

import heapq
from collections.abc import Iterator
from itertools import pairwise, product
from typing import Any, Unpack

import numpy as np

from compass.core.certified.everywhere import kept_everywhere
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Circle, Spot, Tile
from compass.coverage.certified_question import Asked, Question
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.region import GLOBE, Region, latitude_band
from compass.frames import direction, planetocentric_latitude
from compass.orbits import Constellation

#: Longest sides of the first tiles, radians.
FIRST = 0.1

#: What sums of so many shares may be off by.
ROUNDING = 1e-9

#: A tile's latitudes and longitudes: south, north, west, east.
Sides = tuple[float, float, float, float]


def certified_worst_place(
    constellation: Constellation,
    limit: float,
    level: float,
    *,
    south: float,
    north: float,
    region: Region = GLOBE,
    width: float = 1e-3,
    budget_boxes: float = 1e6,
    effort: Effort | None = None,
    **asked: Unpack[Asked],
) -> tuple[CertifiedShare, float]:
    """Bracket the share of time at the worst place between two latitudes, or of a region there.

    Parameters
    ----------
    constellation, limit
        As in `compass.coverage.certified_share.certified_share`.
    level
        Stop when both bounds are on one side of this share.
    south, north
        Planetocentric latitudes, radians.
    region
        Of which places at these latitudes count, where they turn with Mars.
    width, budget_boxes
        How near the bounds are to come, and boxes for those from below.
    effort
        How far to go at each place.
    **asked
        As of `certified_share` but for ``place``. With ``duration`` every place counts by itself;
        without, all of a circle of latitude alike.

    Returns
    -------
    share, latitude
        And the planetocentric latitude of the place with the upper bound.
    """
    search = _Search(constellation, limit, south, north, region, effort or Effort(), asked)
    return search.run(level, width, budget_boxes)


class _Search:
    """Tiles by the bounds of their shares."""

    def __init__(
        self,
        constellation: Constellation,
        limit: float,
        south: float,
        north: float,
        region: Region,
        effort: Effort,
        asked: Asked,
    ) -> None:
        self.constellation, self.limit, self.region = constellation, limit, region
        self.effort, self.asked = effort, asked
        self.places = asked.get("duration") is not None
        whole = Tile(south, north, -np.pi, np.pi) if self.places else latitude_band(south, north)
        of_all: Asked = {**asked, "place": whole}
        self.question = Question(constellation, **of_all)
        self.question.check(limit)
        self.arrays = self.question.arrays(limit)
        self.looked, self.least, self.where = 0, 1.0, south
        self.tiles: list[tuple[float, Sides]] = []

    def run(self, level: float, width: float, most: float) -> tuple[CertifiedShare, float]:
        """Halve the worst tile until the bounds tell, or `most` boxes are spent."""
        south, north = self.question.domain.sides[0].tolist()
        columns = _parts(-np.pi, np.pi) if self.places else [(0.0, 0.0)]
        for a, b in _parts(south, north):
            for west, east in columns:
                self._push((a, b, west, east))
        stopped = ""
        while self.tiles:
            low, tile = self.tiles[0]
            if low >= level or self.least < level or self.least - low <= width:
                break
            if self.looked >= most:
                stopped = "boxes"
                break
            heapq.heappop(self.tiles)
            self._middle(tile, width)
            for half in self._halves(tile):
                self._push(half)
        if self.least == 1.0 and self.tiles:  # told from below alone: say what a place has too
            self._middle(self.tiles[0][1], width)
        low = min(self.tiles[0][0] if self.tiles else 1.0, self.least)
        scope = self.question.domain.scope
        return CertifiedShare(low, self.least, self.looked, scope, stopped), self.where

    def _push(self, tile: Sides) -> None:
        """Bound a tile from below, unless it lies outside of the region."""
        if self._outside(tile):
            return
        south, north, west, east = tile
        boxes = self.question.boxes()[:, :6]
        if self.places:
            one = boxes[(boxes[:, 0] == boxes[0, 0]) & (boxes[:, 1] == boxes[0, 1])].copy()
            one[:, 1], one[:, 4] = 0.5 * (west + east), 0.5 * (east - west) * (1 + 1e-15)
        else:
            one = boxes[boxes[:, 0] == boxes[0, 0]].copy()
        one[:, 0], one[:, 3] = 0.5 * (south + north), 0.5 * (north - south) * (1 + 1e-15)
        orbits, circles, breaks, paths, _, numbers, mask = self.arrays
        share, looked = kept_everywhere(
            one, self.places, self.question.speed, orbits, circles, breaks, paths, numbers, mask
        )
        self.looked += int(looked)
        heapq.heappush(self.tiles, (max(0.0, float(share) - ROUNDING), tile))

    def _middle(self, tile: Sides, width: float) -> None:
        """Bound the worst share from above by that of a place in a tile and the region."""
        spots = [spot for spot in self._spots(tile) if self._inside(*spot)]
        if not spots:
            return
        latitude, longitude = spots[0]
        place: Any = Spot(latitude, longitude) if self.places else Circle(latitude)
        asked: Asked = {**self.asked, "place": place}
        found = self.effort.share(
            self.constellation,
            self.limit,
            width=0.25 * width,
            budget_boxes=1e5,
            **asked,
        )
        if found.high <= self.least:
            self.least, self.where = found.high, latitude

    def _spots(self, tile: Sides) -> Iterator[tuple[float, float]]:
        """Planetocentric latitudes and longitudes of a tile: its middle, its sides and corners."""
        south, north, west, east = tile
        for part, along in product((0.5, 0.0, 1.0), (0.5, 0.0, 1.0)):
            b = south + part * (north - south)
            latitude = float(planetocentric_latitude(b, self.question.figure))
            yield latitude, west + along * (east - west)

    def _inside(self, latitude: float, longitude: float) -> bool:
        return not self.places or bool(self.region.contains(direction(latitude, longitude)))

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
        flattening = self.question.domain.flattening
        reach = 0.5 * (north - south) / (1.0 - flattening) + 0.5 * (east - west) + 1e-9
        latitude = float(planetocentric_latitude(0.5 * (south + north), self.question.figure))
        middle = direction(latitude, 0.5 * (west + east))
        sides = self.region.normals @ middle - self.region.floors
        return bool(np.any(sides < -reach))


def _parts(low: float, high: float) -> list[tuple[float, float]]:
    """Equal parts of a stretch, none longer than `FIRST`."""
    count = max(int(np.ceil((high - low) / FIRST)), 1)
    return list(pairwise(np.linspace(low, high, count + 1).tolist()))

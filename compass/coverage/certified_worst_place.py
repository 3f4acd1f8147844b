"""The share of time with a small dilution, or error, at the worst place of a region.

Of a tile of latitudes, and of longitudes where they count, from below by lines under the shares of
its places (`compass.core.certified.everywhere`).
"""

from typing import Any, Unpack

import numpy as np

from compass.core.certified.everywhere import kept_everywhere
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Circle, Spot, Tile
from compass.coverage.certified_question import Asked, Question
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.region import GLOBE, Region, latitude_band
from compass.coverage.tiles import Sides, Tiles
from compass.frames import planetocentric_latitude
from compass.orbits import Constellation

#: How near bounds at a place come at first, at most four times as far.
COARSE = 1e-3

#: What sums of so many shares may be off by, and boxes for the share at one place.
ROUNDING, AT_A_PLACE = 1e-9, 1e5


def certified_worst_place(
    constellation: Constellation,
    limit: float,
    level: float | None,
    *,
    south: float,
    north: float,
    region: Region = GLOBE,
    longitudes: float = 2 * np.pi,
    width: float = 1e-3,
    narrow: float = np.inf,
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
        Stop when both bounds are on one side of this share, and `narrow` apart.
    south, north
        Planetocentric latitudes, radians.
    region
        Of which places at these latitudes count, where they turn with Mars.
    longitudes
        How many of them stand for all, radians, as of alike patterns over the ground.
    width, narrow, budget_boxes
        How near the bounds are to come, and where it is told on which side of `level` they are;
        boxes for those from below.
    effort
        Its seconds instead of boxes, if it has any; how far to go at each place.
    **asked
        As of `certified_share` but for ``place``. With ``duration`` every place counts by itself;
        without, all of a circle of latitude alike.

    Returns
    -------
    share, latitude
        And the planetocentric latitude of the place with the upper bound.
    """
    known, places = effort or Effort(), asked.get("duration") is not None
    whole = Tile(south, north, -np.pi, np.pi) if places else latitude_band(south, north)
    of_all: Asked = {**asked, "place": whole}
    question = Question(constellation, **of_all)
    question.check(limit)
    first = question.boxes()[:, :6]
    first = first[(first[:, 0] == first[0, 0]) & ((first[:, 1] == first[0, 1]) | (not places))]
    given = question.speed, question.problem()
    (square,) = question.squares([limit])

    def bound(tile: Sides) -> tuple[float, float, int]:
        boxes = first.copy()
        for axis, (low, high) in ((0, tile[:2]), (1, tile[2:]))[: 2 if places else 1]:
            boxes[:, axis] = 0.5 * (low + high)
            boxes[:, 3 + axis] = 0.5 * (high - low) * (1 + 1e-15)
        share, middle, looked = kept_everywhere(boxes, places, square, *given)
        return max(0.0, float(share) - ROUNDING), float(middle), int(looked)

    def at(latitude: float, longitude: float) -> tuple[float, int]:
        centric = float(planetocentric_latitude(latitude, question.figure))
        place: Any = Spot(centric, longitude) if places else Circle(centric)
        here: Asked = {**asked, "place": place}
        for near in (max(width, COARSE), width):
            share = known.share(
                constellation, limit, width=0.25 * near, budget_boxes=AT_A_PLACE, **here
            )
            if level is None or not share.low < level <= share.high:
                break
        return share.high, 0

    low, high = question.domain.sides[0].tolist()
    tiles = Tiles(bound, at, question.figure, places, region, (-np.pi, longitudes - np.pi))
    spent = known.budget(budget_boxes, by_width=False)
    least = tiles.least(
        low,
        high,
        width=width,
        narrow=narrow,
        level=level,
        most=spent["budget_boxes"],
        seconds=spent["budget_s"],
    )
    share = CertifiedShare(
        least.low, least.high, least.looked, question.domain.scope, least.stopped
    )
    return share, float(planetocentric_latitude(least.latitude, question.figure))

"""By how much the k-th best satellite clears the horizon of users, at worst: between proven bounds.

Users either stand anywhere on their circles of latitude, for ever, or on Mars for a span of time.
For orbits of one period that is no fraction of Mars's rotation the circle and the place are one
claim for ever: longitude and phase together come arbitrarily near every pair of values.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from math import inf, log
from time import perf_counter

import numpy as np

from compass.core import clearance as kernels
from compass.cores import shared
from compass.coverage.certified_longitudes import weighed_share
from compass.coverage.clearance_layout import Laid, Moving, check_users, lay_out, place_of
from compass.coverage.region import GLOBE
from compass.coverage.tiles import Sides, Tiles
from compass.coverage.users import Users, centric
from compass.errors import ArgumentError
from compass.orbits import Constellation

#: How near bounds are to come, radians, and to the question whether all is clear.
TOLERANCE, FINEST = 1e-4, 1e-7

#: Boxes to look at, some seconds for fifteen satellites; and for a margin alone, once it is clear
#: on which side of zero it lies.
MOST_BOXES, MARGIN_BOXES = 4_000_000, 200_000

#: How near bounds of the share of a polygon come, one after the other.
FIRST_WIDTHS = (0.3, 0.1, 0.03, 0.01)

#: Part of the boxes for a margin that one bound of it may take: others are to be tried after it.
ONE_BOUND = 0.5

#: Equal parts of the time in which shares over a span are looked for, several at once.
TIMES = 4

#: One over the part of the boxes for the worst place that one tile may take: there are many.
A_TILE = 8

#: How many times as many boxes a measure of a quarter takes, as long as that is not known.
GROWTH = 2.6

#: Boxes by which it is told how many there are in so many seconds.
TRIAL_BOXES = 20_000

#: Satellites times boxes, each of which looks at all of them: a minute at the most, so that many
#: satellites have an answer too, in wider bounds.
MOST_SIGHTS = 160_000_000


@dataclass(frozen=True)
class Clearance:
    """Least clearance of the k-th best satellite, between bounds.

    Attributes
    ----------
    low, high
        Radians; the horizon may rise by `low` and not by more than `high`. Minus infinity without
        k satellites.
    time, latitude, longitude
        Where and when `high` is: seconds after the epoch, planetocentric and Mars-fixed, radians.
    seen
        Satellites above the horizon there.
    boxes
        Boxes looked at.
    """

    low: float
    high: float
    time: float
    latitude: float
    longitude: float
    seen: int
    boxes: int

    @property
    def holds(self) -> bool | None:
        """Whether k are always above the horizon; None if the bounds do not tell."""
        return True if self.low >= 0.0 else False if self.high < 0.0 else None


def always_clear(
    constellation: Moving,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    most: int | None = None,
) -> bool:
    """Whether `fold` satellites are proven to be always above the horizon; quickly where not.

    Parameters and errors as in `least_clearance`.
    """
    check_users(constellation, users, fold)
    if constellation.size < fold:
        return False
    most = _affordable(most, constellation.size)
    laid = lay_out(constellation, users, span)
    low, *_ = _least(laid, fold, laid.missed, FINEST, most, 0.0)
    return bool(low - laid.missed >= 0.0)


@dataclass(frozen=True)
class Share:
    """Share of time, or of area and time, with k satellites above the horizon, between bounds."""

    low: float
    high: float
    boxes: int


def least_clearance(
    constellation: Moving,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    enough: float = inf,
    tolerance: float = TOLERANCE,
    most: int | None = None,
) -> Clearance:
    """Bracket the least clearance of the `fold`-th best satellite.

    Parameters
    ----------
    constellation
        Orbits in two-body motion, or paths, which need a span.
    users
        Whose horizon.
    fold
        At least 1.
    span
        Seconds after the epoch; users then stand on Mars. Without it they stand anywhere on their
        circles of latitude, for ever.
    enough
        Clearances from this on need not be told apart, radians.
    tolerance
        How near the bounds are to come; nearer where they lie on both sides of zero.
    most
        Boxes to look at; `MOST_BOXES` if left out; fewer with many satellites.

    Raises
    ------
    ArgumentError
        A fold below 1, satellites inside Mars, users who look through it, orbits of different
        periods without a span, a span of too many revolutions.
    """
    check_users(constellation, users, fold)
    if constellation.size < fold:
        return Clearance(
            low=-inf,
            high=-inf,
            time=0.0,
            latitude=centric(users.south, users.figure),
            longitude=np.nan,
            seen=0,
            boxes=0,
        )
    most = _affordable(most, constellation.size)
    laid = lay_out(constellation, users, span)
    found = _least(laid, fold, 0.0, tolerance, min(most, MARGIN_BOXES))
    if found[0] < 0.0 <= found[1]:
        found = _least(laid, fold, 0.0, FINEST, most)
    if found[0] >= 0.0 or found[1] < 0.0:
        found = _margin(laid, fold, found, enough, tolerance, min(most, MARGIN_BOXES))
    low, high, worst, seen, boxes = found
    low -= laid.missed
    if not np.isfinite(high):
        raise ArgumentError(f"region = {users.name}: has no place")
    time, latitude, longitude = place_of(constellation, users, laid, worst)
    return Clearance(
        low=float(low),
        high=float(high),
        time=time,
        latitude=latitude,
        longitude=longitude,
        seen=int(seen),
        boxes=int(boxes),
    )


def clear_share(
    constellation: Moving,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    width: float = 1e-4,
    level: float | None = None,
    most: int | None = None,
    seconds: float | None = None,
) -> Share:
    """Bracket the share of time, of several latitudes of area and time, with `fold` in view.

    Parameters
    ----------
    constellation, users, fold, span
        As in `least_clearance`, with its errors.
    width
        How near the bounds are to come.
    level
        Stop, too, when both are on one side of this.
    most
        Boxes to look at; `MOST_BOXES` if left out; fewer with many satellites.
    seconds
        Look at as many boxes as that takes, about, instead, by a trial of some.
    """
    check_users(constellation, users, fold)
    if constellation.size < fold:
        return Share(0.0, 0.0, 0)
    run = partial(_in_parts, lay_out(constellation, users, span), fold)
    left = _boxes(run, constellation.size, most, seconds)
    finest, total, low, high, before = 1e-2, 0, 0.0, 1.0, 0
    while True:
        found = run(finest, left)
        total, left = total + found.boxes, left - found.boxes
        # a pass that is cut short says less than the one before
        low, high = max(low, found.low), min(high, found.high)
        told = level is not None and (low >= level or high < level)
        if told or high - low <= width:
            return Share(low, high, total)
        growth = max(found.boxes / before, 1.5) if before else GROWTH
        before = found.boxes
        if growth * before <= left:
            finest *= 0.25
        elif left > 1.5 * before:  # boxes grow as a power of the measure at which they end
            finest *= (0.8 * left / before) ** (-log(4.0) / log(growth))
        else:
            return Share(low, high, total)


def polygon_share(
    constellation: Constellation,
    users: Users,
    fold: int,
    *,
    width: float = 1e-3,
    level: float | None = None,
    most: int | None = None,
    seconds: float | None = None,
) -> Share:
    """Bracket the share of area and time of a polygon for ever, where tracks do not close.

    Every place then meets all longitudes alike: belts of latitude weigh by the polygon's width
    (`compass.coverage.certified_longitudes`). Parameters and errors as in `clear_share`.
    """
    check_users(constellation, users, fold)
    if constellation.size < fold:
        return Share(0.0, 0.0, 0)
    everyone = users.belt()

    def belt(
        south: float, north: float, near: float, seconds: float, boxes: float
    ) -> tuple[float, float, int, str]:
        part, left = replace(everyone, south=south, north=north), max(int(boxes), 1)
        share = clear_share(constellation, part, fold, width=near, most=left)
        short = share.high - share.low > near
        return share.low, share.high, share.boxes, "boxes" if short else ""

    low, high, boxes = 0.0, 1.0, 0
    run = partial(_in_parts, lay_out(constellation, everyone, None), fold)
    left = _boxes(run, constellation.size, most, seconds)
    for near in (*(one for one in FIRST_WIDTHS if one > width), width):
        below, above, looked, _ = weighed_share(
            users.region.normals,
            1.0 - (users.figure.polar_radius / users.figure.equatorial_radius) ** 2,
            (users.south, users.north),
            belt,
            near,
            budget_s=inf,
            budget_boxes=left - boxes,
            level=level,
            progress=lambda width: None,
        )
        low, high, boxes = max(low, below), min(high, above), boxes + looked
        told = level is not None and (low >= level or high < level)
        if told or high - low <= width or boxes >= left:
            break
    return Share(float(low), float(high), boxes)


def _in_parts(laid: Laid, fold: int, finest: float, most: int) -> Share:
    """Bounds of a share of area and time, over some parts of the time at once, a thread a core."""
    begin, end = laid.domain[2]
    if not laid.turn or end <= begin:
        return _share(laid, fold, 0, finest, most)

    def part(edges: tuple[float, float]) -> Share:
        domain = np.array([*laid.domain[:2], edges])
        return _share(replace(laid, domain=domain), fold, 0, finest, most // TIMES)

    times = np.linspace(begin, end, TIMES + 1).tolist()
    found = list(shared(part, pairwise(times)))
    low = sum(share.low for share in found) / TIMES
    high = sum(share.high for share in found) / TIMES
    return Share(low, high, sum(share.boxes for share in found))


def _share(laid: Laid, fold: int, whole: int, finest: float, most: int) -> Share:
    """Bounds of a share from boxes down to a measure.

    With `whole` 1 of the time in which all latitudes at one longitude have the fold, with 2 all
    longitudes too; the upper bound is then none of that.
    """
    clear, hidden, undecided, boxes = kernels.clear_share(
        laid.question, fold, laid.domain, whole, finest, most
    )
    if not clear + hidden + undecided > 0.0:
        raise ArgumentError("region: has no area")
    whole = clear + hidden + undecided
    # sums of so many parts round by so many last places; what symmetry misses moves rims
    error = 4e-16 * boxes + 1e-10 + 0.5 * laid.orbits.shape[0] * laid.missed
    low = max(0.0, clear / whole - error)
    high = max(low, min(1.0, (clear + undecided) / whole + error))
    return Share(float(low), float(high), int(boxes))


def worst_share(
    constellation: Moving,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    width: float = 1e-3,
    level: float | None = None,
    most: int | None = None,
    seconds: float | None = None,
) -> tuple[Share, float]:
    """Bracket the share of time with `fold` in view where that is least (`compass.coverage.tiles`).

    Of circles of latitude for ever, or of every place of the users' region by itself in a span.

    Returns
    -------
    share, latitude
        And the geodetic latitude at which the upper bound was found, radians.
    """
    check_users(constellation, users, fold)
    if constellation.size < fold:
        return Share(0.0, 0.0, 0), users.south
    run = partial(_share, lay_out(constellation, users, span), fold, 0)
    most, places = _boxes(run, constellation.size, most, seconds), span is not None

    def at(latitude: float, longitude: float) -> tuple[float, int]:
        here = replace(users, south=latitude, north=latitude, region=GLOBE)
        here = replace(here, longitude=longitude if places else None)
        found = clear_share(
            constellation, here, fold, span=span, width=0.25 * width, level=level, most=most // 4
        )
        return found.high, found.boxes

    def bound(tile: Sides) -> tuple[float, float, int]:
        south, north, west, east = tile
        laid = lay_out(constellation, replace(users, south=south, north=north, region=GLOBE), span)
        if places:
            laid.domain[1] = west, east
        side = max(north - south, east - west)
        fine = max(0.05 * side, 1e-6) if places else max(0.02 * side**2, 1e-8)
        found = _share(laid, fold, 2 if places else 1, fine, max(most // A_TILE, 1))
        return found.low, found.low, found.boxes

    mirrored = users.south == -users.north and users.alike_all_around and not places
    tiles = Tiles(bound, at, users.figure, places, users.region)
    south = 0.0 if mirrored else users.south
    found = tiles.least(south, users.north, width=width, level=level, most=most)
    return Share(found.low, found.high, found.looked), found.latitude


def _affordable(most: int | None, satellites: int) -> int:
    """Boxes to look at with so many satellites."""
    return min(MOST_BOXES if most is None else most, MOST_SIGHTS // satellites)


def _boxes(
    run: Callable[[float, int], Share], satellites: int, most: int | None, seconds: float | None
) -> int:
    """Boxes to look at: so many, or as many as so many seconds take by a trial of some.

    A trial is a run down to a measure, within a number of boxes.
    """
    if seconds is None:
        return _affordable(most, satellites)
    run(1e-6, TIMES)  # its kernel is there then
    began = perf_counter()
    tried = run(1e-6, TRIAL_BOXES).boxes
    return max(int(tried * seconds / max(perf_counter() - began, 1e-6)), 1)


def _margin(
    laid: Laid, fold: int, found: tuple, enough: float, tolerance: float, most: int
) -> tuple:
    """Bring bounds of a clearance together by halves, as near as so many boxes suffice for.

    That all is clear by half of what is seen takes few boxes to prove, and shows what is less
    clear; all that is to be told apart at once would be looked at over and over at a high guess.
    """
    low, high, worst, seen, boxes = found
    top, looked = enough, 0
    while min(high, top) - low > tolerance and looked < most:
        middle = 0.5 * (low + min(high, top))
        least, seen_least, *where, few = _least(
            laid, fold, middle, tolerance, int(ONE_BOUND * most)
        )
        looked += few
        if seen_least < high:
            high, (worst, seen) = seen_least, where
        if least <= low:
            top = middle  # more than boxes suffice for
        low = max(low, least)
    return low, high, worst, seen, boxes + looked


def _least(
    laid: Laid, fold: int, enough: float, tolerance: float, most: int, give_up: float = -inf
) -> tuple:
    return kernels.least_clearance(
        laid.question, fold, laid.domain, enough, give_up, tolerance, most
    )

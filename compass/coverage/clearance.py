"""By how much the k-th best satellite clears the horizon of users, at worst: between proven bounds.

Users either stand anywhere on their circles of latitude, for ever, or on Mars for a span of time.
For orbits of one period that is no fraction of Mars's rotation the circle and the place are one
claim for ever: longitude and phase together come arbitrarily near every pair of values.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core import clearance as kernels
from compass.coverage.region import GLOBE, Region
from compass.errors import ArgumentError
from compass.frames import Figure, planetographic_latitude, prime_meridian_angle
from compass.orbits import Constellation
from compass.orbits.symmetry import mirrors, one_circle, one_period, shifts
from compass.sites import Mask, Site

#: How near bounds are to come, radians, and to the question whether all is clear.
TOLERANCE, FINEST = 1e-4, 1e-7

#: Boxes to look at, some seconds for fifteen satellites; and for a margin alone, once it is clear
#: on which side of zero it lies.
MOST_BOXES, MARGIN_BOXES = 4_000_000, 400_000

#: Revolutions over which phases are good to what bounds allow for.
MOST_REVOLUTIONS = 5000.0


@dataclass(frozen=True)
class Users:
    """Places that share a horizon.

    Attributes
    ----------
    name
        What to call them.
    south, north
        Geodetic latitudes, radians; equal for a site.
    figure
        The figure over which they stand.
    mask
        Their horizon by azimuth.
    below
        Added to the horizon, radians: negative for users who look down.
    height
        Above the figure along its normal, metres.
    longitude
        Of a site, radians east; None elsewhere.
    region
        To which part of the belt they belong, where that turns with Mars.
    """

    name: str
    south: float
    north: float
    figure: Figure
    mask: Mask = field(default_factory=Mask)
    below: float = 0.0
    height: float = 0.0
    longitude: float | None = None
    region: Region = GLOBE

    @property
    def is_belt(self) -> bool:
        """Whether they stand at every longitude."""
        return self.longitude is None and not self.region.mars_fixed

    @property
    def alike_all_around(self) -> bool:
        """Whether the horizon is the same in every direction."""
        return self.mask.is_constant

    def belt(self) -> "Users":
        """The users and all others on their circles of latitude."""
        return replace(self, longitude=None, region=GLOBE)


def site_users(site: Site, mask: Mask | None = None) -> Users:
    """Users at a site, over its own horizon or another."""
    latitude = geodetic(site.latitude, site.figure)
    return Users(
        site.name,
        latitude,
        latitude,
        site.figure,
        site.mask if mask is None else mask,
        height=site.height,
        longitude=site.longitude,
    )


def region_users(
    region: Region, figure: Figure, mask: Mask, *, below: float = 0.0, height: float = 0.0
) -> Users:
    """Users in a region, at a height above the ground."""
    south, north = (geodetic(b, figure) for b in region.latitudes())
    return Users(
        region.name,
        south,
        north,
        figure,
        mask,
        below,
        height,
        region=region if region.mars_fixed else GLOBE,
    )


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
    constellation: Constellation,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    most: int | None = None,
) -> bool:
    """Whether `fold` satellites are proven to be always above the horizon; quickly where not.

    Parameters and errors as in `least_clearance`.
    """
    _check(constellation, users, fold)
    if constellation.size < fold:
        return False
    most = MOST_BOXES if most is None else most
    laid = _lay_out(constellation, users, span)
    low, *_ = _least(laid, fold, laid.missed, FINEST, most, 0.0)
    return bool(low - laid.missed >= 0.0)


@dataclass(frozen=True)
class Share:
    """Share of time, or of area and time, with k satellites above the horizon, between bounds."""

    low: float
    high: float
    boxes: int


def least_clearance(
    constellation: Constellation,
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
        Orbits in two-body motion.
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
        Boxes to look at; `MOST_BOXES` if left out.

    Raises
    ------
    ArgumentError
        A fold below 1, users above the satellites or who look through Mars, orbits of different
        periods without a span, a span of too many revolutions.
    """
    _check(constellation, users, fold)
    if constellation.size < fold:
        return Clearance(-inf, -inf, 0.0, centric(users.south, users.figure), np.nan, 0, 0)
    most = MOST_BOXES if most is None else most
    laid = _lay_out(constellation, users, span)
    found = _least(laid, fold, enough, tolerance, min(most, MARGIN_BOXES))
    if found[0] < 0.0 <= found[1]:
        found = _least(laid, fold, 0.0, FINEST, most)
    low, high, worst, seen, boxes = found
    low -= laid.missed
    if not np.isfinite(high):
        raise ArgumentError(f"region = {users.name}: has no place")
    time, latitude, longitude = _place(constellation, users, laid, worst)
    return Clearance(float(low), float(high), time, latitude, longitude, int(seen), int(boxes))


def clear_share(
    constellation: Constellation,
    users: Users,
    fold: int,
    *,
    span: tuple[float, float] | None = None,
    width: float = 1e-4,
    level: float | None = None,
    most: int | None = None,
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
        Boxes to look at; `MOST_BOXES` if left out.
    """
    _check(constellation, users, fold)
    if constellation.size < fold:
        return Share(0.0, 0.0, 0)
    laid = _lay_out(constellation, users, span)
    most = MOST_BOXES if most is None else most
    finest, total = 1e-2, 0
    while True:
        found = _share(laid, fold, False, finest, most - total)
        total += found.boxes
        told = level is not None and (found.low >= level or found.high < level)
        if told or found.high - found.low <= width or total >= most:
            return replace(found, boxes=total)
        finest *= 0.25


def _share(laid: "_Laid", fold: int, everywhere: bool, finest: float, most: int) -> Share:
    """Bounds of a share from boxes down to a measure.

    `everywhere`: of several latitudes, of the time in which all of them at one longitude have the
    fold; the upper bound is then none of that.
    """
    clear, hidden, undecided, boxes = kernels.clear_share(
        *laid.arrays(), fold, laid.domain, everywhere, finest, most
    )
    whole = clear + hidden + undecided
    # sums of so many parts round by so many last places; what symmetry misses moves rims
    error = 4e-16 * boxes + 1e-10 + 0.5 * laid.orbits.shape[0] * laid.missed
    low = max(0.0, clear / whole - error)
    high = max(low, min(1.0, (clear + undecided) / whole + error))
    return Share(float(low), float(high), int(boxes))


def worst_share(
    constellation: Constellation,
    users: Users,
    fold: int,
    *,
    width: float = 1e-3,
    level: float | None = None,
    most: int | None = None,
) -> tuple[Share, float]:
    """Bracket the share of time with `fold` in view at the worst latitude of a belt, for ever.

    Of a belt, the time in which all of it at one longitude has the fold is a lower bound for each
    of its latitudes, the share at one of them an upper bound; the belt whose bound is lowest is
    halved.

    Returns
    -------
    share, latitude
        And the geodetic latitude at which the upper bound was found, radians.
    """
    _check(constellation, users, fold)
    if constellation.size < fold:
        return Share(0.0, 0.0, 0), users.south
    most = MOST_BOXES if most is None else most
    south = 0.0 if users.south == -users.north and users.alike_all_around else users.south
    edges = np.linspace(south, users.north, max(2, int(np.ceil((users.north - south) / 0.1)) + 1))
    open_belts: list[tuple[float, float, float]] = []
    least, where, total = 1.0, users.south, 0

    def look(low: float, high: float) -> None:
        nonlocal least, where, total
        middle = 0.5 * (low + high)
        circle = replace(users, south=middle, north=middle, longitude=None, region=GLOBE)
        at = clear_share(constellation, circle, fold, width=0.25 * width, most=most - total)
        total += at.boxes
        if at.high < least:
            least, where = at.high, middle
        laid = _lay_out(constellation, replace(circle, south=low, north=high), None)
        fine = max(0.02 * (high - low) ** 2, 1e-8)
        all_of_it = _share(laid, fold, True, fine, most)
        total += all_of_it.boxes
        open_belts.append((all_of_it.low, low, high))

    for low, high in pairwise(edges):
        look(float(low), float(high))
    while True:
        open_belts.sort()
        bound, low, high = open_belts[0]
        told = level is not None and (bound >= level or least < level)
        if told or least - bound <= width or total >= most:
            return Share(min(bound, least), least, total), where
        del open_belts[0]
        middle = 0.5 * (low + high)
        look(low, middle)
        look(middle, high)


@dataclass(frozen=True, eq=False)
class _Laid:
    """What kernels take of a question."""

    orbits: NDArray[np.float64]
    figure: NDArray[np.float64]
    turn: float
    horizon: NDArray[np.float64]
    region: Region
    domain: NDArray[np.float64]
    missed: float
    pace: float
    start: float

    def arrays(self) -> tuple[Any, ...]:
        """In the kernels' order."""
        return (
            self.orbits,
            self.figure,
            self.turn,
            self.horizon[0],
            self.horizon[1],
            self.region.normals,
            self.region.floors,
        )


def _least(
    laid: _Laid, fold: int, enough: float, tolerance: float, most: int, give_up: float = -inf
) -> tuple:
    return kernels.least_clearance(
        *laid.arrays(), fold, laid.domain, enough, give_up, tolerance, most
    )


def _check(c: Constellation, users: Users, fold: int) -> None:
    if fold < 1:
        raise ArgumentError(f"fold = {fold}: must be a whole number from 1 on")
    surface = users.figure.equatorial_radius
    if c.size and c.periapsis_radius.min() <= surface + users.height:
        lowest = (c.periapsis_radius.min() - surface) / 1e3
        raise ArgumentError(
            f"altitude_km = {users.height / 1e3:g}: satellites come down to {lowest:.6g} km, and "
            "who is above one sees it in a ring, not in a cap; ask for users below all of them"
        )
    dip = float(np.arccos(min(1.0, surface / (users.figure.polar_radius + users.height))))
    if users.mask.lowest + users.below < -dip - 1e-12:
        raise ArgumentError(
            f"mask_deg = {np.degrees(users.mask.lowest + users.below):g}: below the limb of Mars, "
            f"{-np.degrees(dip):.4g} deg as seen from {users.height / 1e3:g} km; ask for more"
        )


def _lay_out(c: Constellation, users: Users, span: tuple[float, float] | None) -> _Laid:
    """Orbits, frame and domain of a question."""
    pace = float(c.mean_motion.mean())
    flattening = 1.0 - (users.figure.polar_radius / users.figure.equatorial_radius) ** 2
    bend = users.figure.equatorial_radius / np.sqrt(1.0 - flattening) + users.height
    figure = np.array([users.figure.equatorial_radius, flattening, users.height, bend])
    horizon = np.array([users.mask.azimuth, np.array(users.mask.elevation) + users.below])
    if users.alike_all_around:
        horizon = np.ascontiguousarray(horizon[:, :1])
    if span is None:
        turn, angle, start, missed = 0.0, 0.0, 0.0, 0.0
        domain, missed = _torus(c, users)
        shortest = c.periapsis_radius.min() - users.figure.equatorial_radius - users.height
        missed *= float(c.apoapsis_radius.max() / shortest)
    else:
        start, missed, turn = span[0], 0.0, MARS_ROTATION_RATE.value / pace
        angle = float(prime_meridian_angle(c.epoch, start))
        revolutions = (span[1] - start) * pace / (2 * np.pi)
        if revolutions > MOST_REVOLUTIONS:
            raise ArgumentError(
                f"days = {(span[1] - start) / 86400:g}: {revolutions:.0f} revolutions, more than "
                f"{MOST_REVOLUTIONS:g}; ask for fewer days"
            )
        west, east = 0.0, 2 * np.pi
        if users.longitude is not None:
            west = east = users.longitude
        phases = [0.0, (span[1] - start) * pace]
        domain = np.array([[users.south, users.north], [west, east], phases])
    orbits = _orbits(c, pace, turn, angle, start)
    return _Laid(orbits, figure, turn, horizon, users.region, domain, missed, pace, start)


def _orbits(
    c: Constellation, pace: float, turn: float, angle: float, start: float
) -> NDArray[np.float64]:
    """Rows as the kernels take them, seen from the meridian at `angle`, phases from `start` on.

    In the frame that turns by `turn` a radian of phase, of a position at angular rate w about the
    pole h: ``|w h - turn z| r`` across, convex in w, and the radial speed besides.
    """
    e, i, node, w = c.eccentricity, c.inclination, c.raan - angle, c.argument_of_periapsis
    co, so, ci, si, cw, sw = (
        np.cos(node), np.sin(node), np.cos(i), np.sin(i), np.cos(w), np.sin(w),
    )  # fmt: skip
    towards = np.stack([co * cw - so * ci * sw, so * cw + co * ci * sw, si * sw], axis=1)
    across = np.stack([-co * sw - so * ci * cw, -so * sw + co * ci * cw, si * cw], axis=1)
    root = np.sqrt(1.0 - e * e)
    mean = c.mean_motion / pace
    rates = mean * root / np.array([(1.0 - e) ** 2, (1.0 + e) ** 2])
    fastest = np.sqrt((rates**2 - 2 * rates * turn * ci + turn**2).clip(0.0).max(axis=0))
    swift = np.hypot(fastest * (1.0 + e), mean * e / root) * c.semi_major_axis
    if turn == 0.0:
        swift = mean * c.semi_major_axis * np.sqrt((1.0 + e) / (1.0 - e))
    a = c.semi_major_axis[:, np.newaxis]
    anomaly = c.mean_anomaly + c.mean_motion * start
    columns = (a * towards, a * root[:, np.newaxis] * across)
    return np.ascontiguousarray(
        np.column_stack([*columns, e, anomaly, mean, swift * (1.0 + 1e-12)])
    )


def _torus(c: Constellation, users: Users) -> tuple[NDArray[np.float64], float]:
    """Latitudes, longitudes and phases that decide for ever; by how much symmetries miss, radians.

    With shifts a place sees alike at ``(l, th)`` and ``(l - turn, th + phase)``; of horizons alike
    all around north sees what south sees, half a turn and half a revolution on, and, with half
    turns about nodes, ``(l, th)`` is as ``(turn + pi - l, pi - phase - th)``.
    """
    if not one_period(c):
        raise ArgumentError(
            "orbits of different periods: a claim for ever would need every combination of their "
            "phases; give days"
        )
    around = 2 * np.pi
    south, north, first, half, missed = users.south, users.north, 0.0, 1.0, 0.0
    turns = phases = 1
    if one_circle(c):
        found = shifts(c)
        still = np.abs(np.mod(found.phase + np.pi, around) - np.pi) < 1e-9
        turns = max(int(still.sum()), 1)
        phases, missed = len(found) // turns, found.mismatch
        if users.alike_all_around:
            south = 0.0 if south == -north else south
            back = mirrors(c)
            if len(back):
                first, half = 0.5 * (np.pi - float(back.phase[0])), 0.5
                missed += back.mismatch
    last = first + around * half / phases
    if one_circle(c) and not np.any(c.inclination):
        first = last = 0.0  # a ring over the equator only turns, and users are at every longitude
        turns = 1
    east = around / turns
    if south == north and abs(south) == np.pi / 2 and users.alike_all_around:
        east = 0.0  # a pole has one longitude
    return np.array([[south, north], [0.0, east], [first, last]]), missed


def _place(
    c: Constellation, users: Users, laid: _Laid, worst: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Seconds after the epoch, planetocentric latitude, Mars-fixed longitude of a box's centre."""
    time = laid.start + float(worst[2]) / laid.pace
    longitude = float(worst[1])
    if laid.turn == 0.0:
        time = laid.start + float(np.mod(worst[2], 2 * np.pi)) / laid.pace
        longitude -= float(prime_meridian_angle(c.epoch, time))
    longitude = float(np.mod(longitude + np.pi, 2 * np.pi) - np.pi)
    return time, centric(float(worst[0]), users.figure), longitude


def geodetic(latitude: float, figure: Figure) -> float:
    """Geodetic latitude of a planetocentric one; a pole is one to the last bit."""
    if abs(latitude) == np.pi / 2:
        return latitude
    return float(planetographic_latitude(latitude, figure))


def centric(latitude: float, figure: Figure) -> float:
    """Planetocentric latitude of a geodetic one on the figure."""
    a, b = figure.equatorial_radius, figure.polar_radius
    return float(np.arctan2(b * b * np.sin(latitude), a * a * np.cos(latitude)))

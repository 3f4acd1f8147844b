"""Where and when a certified share is taken, and which symmetry spares looking at most of it.

For circles of one radius the share over all longitudes and all time is the mean over a torus of
longitude l and phase th (Mars's rotation only turns the longitudes). With moves of the elements
that are verified on every satellite (`compass.orbits.symmetry`), a place sees alike at

* ``(b, l, th)`` and ``(b, l - turn, th + phase)`` for each shift: of G shifts q leave the phase
  alone, so ``l in [0, 2 pi/q)`` and 2 pi q/G of phase hold everything once;
* ``(b, l, th)`` and ``(-b, l + pi, th + pi)``: the mirror image of a circular orbit in the
  equator is the orbit half a turn and half a revolution on, so north stands for south;
* with a half turn about a line of nodes and the mirror image, ``(b, l, th)`` and
  ``(b, turn + pi - l, pi - phase - th)``: half of the phase, from ``(pi - phase)/2`` on.

A mask by azimuth has no mirror and keeps only the shifts. What the moves miss is added to the
error of the satellites' places.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, Region
from compass.coverage.symmetry import Span
from compass.errors import ArgumentError
from compass.frames import Figure, planetographic_latitude
from compass.orbits import Constellation, repeat_period
from compass.orbits.period import secular_rates
from compass.orbits.symmetry import mirrors, one_circle, one_period, shifts


@dataclass(frozen=True)
class Circle:
    """All places of a latitude (planetocentric, radians)."""

    latitude: float


@dataclass(frozen=True)
class Spot:
    """One place that turns with Mars: planetocentric latitude and east longitude, radians."""

    latitude: float
    longitude: float


@dataclass(frozen=True)
class Tile:
    """Between two latitudes and from a western to an eastern longitude, turning with Mars."""

    south: float
    north: float
    west: float
    east: float


Place = Region | Circle | Spot | Tile


@dataclass(frozen=True, eq=False)
class Domain:
    """A box of latitude, longitude and time, and the orbits over it, as the kernels take them.

    Attributes
    ----------
    sides
        Lowest and highest geodetic latitude, longitude and time, shape (3, 2); radians and
        radians of the mean motion.
    orbits, circles, normals
        See `compass.core.certified`; lengths in equatorial radii.
    flattening
        Eccentricity squared of the ellipsoid.
    slack
        Error of the satellites' places.
    scope
        For which motion and how long, in words.
    """

    sides: NDArray[np.float64]
    orbits: NDArray[np.float64]
    circles: NDArray[np.float64]
    normals: NDArray[np.float64]
    flattening: float
    slack: float
    scope: str


def domain_of(
    constellation: Constellation,
    figure: Figure,
    place: Place = GLOBE,
    *,
    mirrored: bool = True,
    symmetric: bool = True,
    drifting: bool = False,
    duration: float | None = None,
) -> Domain:
    """Lay out the box that decides about a place.

    Parameters
    ----------
    constellation
        The orbits.
    figure
        The ellipsoid on which users stand.
    place
        A region, a circle of latitude, a spot or a tile.
    mirrored
        Whether the mask is the same in all directions.
    symmetric
        Whether to use symmetry at all.
    drifting
        Whether mean elements drift under J2.
    duration
        Seconds from the epoch; without it all time where the motion allows it, else the repeat
        period of the ground tracks.

    Raises
    ------
    ArgumentError
        No satellite, orbits that meet the planet, a span of zero, or a region that is not a band
        or a polygon with great-circle edges.
    """
    c = constellation
    if c.size == 0:
        raise ArgumentError("constellation: no satellite; nothing to certify")
    if c.periapsis_radius.min() <= figure.equatorial_radius:
        raise ArgumentError(
            f"constellation: an orbit comes down to {c.periapsis_radius.min() / 1e3:.6g} km, "
            f"inside the planet of {figure.equatorial_radius / 1e3:.6g} km"
        )
    if duration is not None and not 0 < duration < np.inf:
        raise ArgumentError(f"duration_h = {duration / 3600.0:g}: must be positive and finite")
    e2 = 1.0 - (figure.polar_radius / figure.equatorial_radius) ** 2
    south, north, west, east, normals = _sides(place, figure)
    fixed = isinstance(place, Spot | Tile) or len(normals) > 0
    alike = one_circle(c) and (not drifting or np.unique(c.inclination).size == 1)
    if duration is None and not fixed and (alike or (one_period(c) and not drifting)):
        if not alike:
            sides = np.array([[south, north], [0.0, 2 * np.pi], [0.0, 2 * np.pi]])
            orbits, circles = _orbits(c, figure, float(c.mean_motion[0]), 0.0, 0.0, False)
            scope = "for all time, two-body motion; one revolution, no symmetry"
            return Domain(sides, orbits, circles, normals, e2, 1e-13, scope)
        motion = "mean motion under J2" if drifting else "two-body motion"
        torus = _torus(c, figure, south, north, e2, mirrored, symmetric)
        return replace(torus, scope=f"for all time, {motion}; {torus.scope}")
    span = repeat_period(c).duration if duration is None else duration
    pace = float(c.mean_motion.mean())
    angle = rate = error = 0.0
    if fixed:
        over = Span(0.0, span, False, "")
        frame = motion_of(c, over, Region("", np.zeros((1, 3)), np.zeros(1), mars_fixed=True))
        angle, rate, error = frame.frame_angle, float(frame.spin[2]), frame.frame_error
    orbits, circles = _orbits(c, figure, pace, angle, rate, drifting)
    sides = np.array([[south, north], [west, east], [0.0, span * pace]])
    reach = c.apoapsis_radius.max() / figure.equatorial_radius
    motion = "mean motion under J2" if drifting else "two-body motion"
    scope = f"over {span / 3600:.6g} h from the epoch, {motion}; no symmetry"
    # phases over a long span round by 4 roundoffs of their size
    slack = reach * (error + 4.4e-16 * (span * pace + 8.0) / (1.0 - c.eccentricity.max()) ** 2)
    return Domain(sides, orbits, circles, normals, e2, float(slack), scope)


def _torus(
    c: Constellation,
    figure: Figure,
    south: float,
    north: float,
    e2: float,
    mirrored: bool,
    symmetric: bool,
) -> Domain:
    """Box that decides for ever, of circles of one radius."""
    orbits, circles = _orbits(c, figure, float(c.mean_motion[0]), 0.0, 0.0, False)
    radius = float(orbits[0, 0])
    turns, phases, reason, missed = 1, 1, "no symmetry", 0.0
    first, half = 0.0, 1.0
    if symmetric:
        found = shifts(c)
        still = np.abs(np.mod(found.phase + np.pi, 2 * np.pi) - np.pi) < 1e-9
        turns = max(int(still.sum()), 1)
        phases, missed = len(found) // turns, found.mismatch
        reason = f"{len(found)} verified shifts"
        if mirrored:
            reason += ", north mirrors south"
            if south == -north:
                south = 0.0
            back = mirrors(c)
            if len(back):
                first, half = 0.5 * (np.pi - float(back.phase[0])), 0.5
                missed += back.mismatch
                reason += ", half turns run it backwards"
    sides = np.array(
        [
            [south, north],
            [0.0, 2 * np.pi / turns],
            [first, first + 2 * np.pi * half / phases],
        ]
    )
    empty = np.empty((0, 3))
    return Domain(sides, orbits, circles, empty, e2, radius * missed + 1e-14 * radius, reason)


def _sides(place: Place, figure: Figure) -> tuple[float, float, float, float, NDArray[np.float64]]:
    """Geodetic latitudes, longitudes and great-circle edges of a place."""

    def geodetic(latitude: float) -> float:
        if not -np.pi / 2 <= latitude <= np.pi / 2:
            raise ArgumentError(
                f"latitude_deg = {np.degrees(latitude):g}: allowed -90 to 90 degrees"
            )
        return float(planetographic_latitude(latitude, figure))

    none, turn = np.empty((0, 3)), 2 * np.pi
    if isinstance(place, Circle):
        b = geodetic(place.latitude)
        return b, b, 0.0, turn, none
    if isinstance(place, Spot):
        b = geodetic(place.latitude)
        return b, b, place.longitude, place.longitude, none
    if isinstance(place, Tile):
        if not (place.south < place.north and place.west < place.east <= place.west + turn):
            raise ArgumentError(
                "tile: give south below north, and west below east by at most 360 degrees"
            )
        return geodetic(place.south), geodetic(place.north), place.west, place.east, none
    south, north = -np.pi / 2, np.pi / 2
    if place.mars_fixed:
        if np.any(place.floors != 0.0):
            raise ArgumentError(f"region = {place.name}: edges must be great circles")
        return south, north, 0.0, turn, np.ascontiguousarray(place.normals)
    for normal, floor in zip(place.normals, place.floors, strict=True):
        if normal[2] > 0:
            south = float(np.arcsin(floor))
        else:
            north = float(-np.arcsin(floor))
    return geodetic(south), geodetic(north), 0.0, turn, none


def _orbits(
    c: Constellation, figure: Figure, pace: float, angle: float, rate: float, drifting: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Orbits and circles as the kernels take them, in a frame at `angle` that turns at `rate`.

    Greatest speed and acceleration: at periapsis, ``v + w r`` and ``a + 2 w v + w^2 r`` with w all
    that turns the orbit besides.
    """
    still = np.zeros(c.size)
    rates = (still, still, c.mean_motion)
    if drifting:
        rates = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    a, e = c.semi_major_axis / figure.equatorial_radius, c.eccentricity
    node, periapsis, mean = (np.asarray(r) / pace for r in rates)
    node = node - rate / pace
    low, high = a * (1 - e), a * (1 + e)
    turning = np.abs(node) + np.abs(periapsis)
    speed = mean * a * np.sqrt((1 + e) / (1 - e))
    pull = mean**2 * a**3 / low**2
    orbits = np.stack(
        [
            a,
            e,
            np.cos(c.inclination),
            np.sin(c.inclination),
            c.raan - angle,
            c.argument_of_periapsis,
            c.mean_anomaly,
            node,
            periapsis,
            mean,
            (speed + turning * high) * (1 + 1e-12),
            (pull + 2 * turning * speed + turning**2 * high) * (1 + 1e-12),
        ],
        axis=1,
    )
    if not (np.all(e == 0) and np.unique(a).size == 1 and np.unique(node).size == 1):
        return orbits, np.empty((0, 6))
    if np.any(mean != 1.0) or np.any(periapsis != 0.0):
        return orbits, np.empty((0, 6))
    u = c.argument_of_periapsis + c.mean_anomaly
    co, so, ci = np.cos(orbits[:, 4]), np.sin(orbits[:, 4]), orbits[:, 2]
    towards = np.stack([co, so, 0 * co], axis=1)
    across = np.stack([-so * ci, co * ci, orbits[:, 3]], axis=1)
    cu, su = np.cos(u)[:, np.newaxis], np.sin(u)[:, np.newaxis]
    start, later = cu * towards + su * across, cu * across - su * towards
    return orbits, np.ascontiguousarray(np.hstack([start, later]) * a[:, np.newaxis])

"""Where and when a certified share is taken, and which symmetry spares looking at most of it.

For circles of one radius the share over all longitudes and all time is the mean over a torus of
longitude and phase (Mars's rotation only turns the longitudes), of which a part decides
(`compass.coverage.symmetry.deciding_part`). What the moves miss that carry it into the rest is
added to the error of the satellites' places.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certified_orbits import orbit_rows
from compass.coverage.certified_places import Place, Spot, Tile, for_ever, sides_of
from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, Region
from compass.coverage.symmetry import Span, deciding_part
from compass.errors import ArgumentError
from compass.frames import Figure, prime_meridian_angle
from compass.orbits import Constellation, repeat_period
from compass.orbits.motion import AnyMotion, Motion, as_motion
from compass.orbits.period import secular_rates
from compass.orbits.symmetry import one_circle, one_period
from compass.orbits.trajectory import Trajectory

#: Lowest height of users over the figure, metres: no floor on Mars is as deep.
DEEPEST = -20_000.0


@dataclass(frozen=True, eq=False)
class Domain:
    """A box of latitude, longitude and time, and the orbits over it, as the kernels take them.

    Attributes
    ----------
    sides
        Lowest and highest geodetic latitude, longitude and time, shape (3, 2); radians and
        radians of the mean motion.
    orbits, circles, breaks, paths, normals
        See `compass.core.certified`; lengths in equatorial radii.
    flattening
        Eccentricity squared of the ellipsoid.
    height
        Of users over it.
    slack
        Error of the satellites' places.
    scope
        For which motion and how long, in words.
    pace
        Radians of the domain's time in a second.
    drift
        How fast the pattern as a whole turns about the pole, rad/s.
    turning
        Whether longitudes turn with Mars.
    motion
        How the satellites move.
    weighed
        A polygon by whose width in longitude latitudes weigh; None: all alike.
    """

    sides: NDArray[np.float64]
    orbits: NDArray[np.float64]
    circles: NDArray[np.float64]
    normals: NDArray[np.float64]
    flattening: float
    height: float
    slack: float
    scope: str
    pace: float
    drift: float = 0.0
    turning: bool = False
    motion: Motion = field(default_factory=Motion)
    weighed: Region | None = None
    breaks: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))
    paths: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 1, 3, 1)))

    def moment(self, time: float, longitude: float, epoch: float) -> tuple[float, float]:
        """Seconds after the epoch, and east longitude on Mars in (-pi, pi], of a point."""
        seconds = time / self.pace
        if not self.turning:
            turned = prime_meridian_angle(epoch, seconds)
            longitude += self.drift * seconds - float(turned)
        return seconds, float(np.pi - np.mod(np.pi - longitude, 2 * np.pi))


def domain_of(
    constellation: Constellation,
    figure: Figure,
    place: Place = GLOBE,
    *,
    mirrored: bool = True,
    symmetric: bool = True,
    motion: AnyMotion = "two-body",
    height: float = 0.0,
    closed: bool = False,
    since: float = 0.0,
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
    motion
        How the satellites move.
    height
        Of users over the ellipsoid, metres.
    closed
        Whether ground tracks are meant to close. Then a place that turns with Mars sees one repeat
        period again and again; else, for ever, every longitude of its latitude alike.
    since
        Seconds from the epoch to the beginning of `duration`.
    duration
        Seconds; without it all time where the motion allows it, else the repeat period of the
        ground tracks.

    Raises
    ------
    ArgumentError
        No satellite, orbits that meet the planet, a span of zero, or a region that is not a band
        or a polygon with great-circle edges.
    """
    c, moved = constellation, as_motion(motion)
    _check(c, figure, height, since, duration)
    e2 = 1.0 - (figure.polar_radius / figure.equatorial_radius) ** 2
    high = height / figure.equatorial_radius
    drifting = moved.model == "j2"
    steady = moved.is_closed_form and one_period(c) and duration is None
    steady &= not drifting or (c.is_circular and np.unique(c.inclination).size == 1)
    weighed = place if isinstance(place, Region) and place.mars_fixed else None
    place = for_ever(place) if steady and not closed else place
    south, north, west, east, normals = sides_of(place, figure)
    turning = isinstance(place, Spot | Tile) or len(normals) > 0
    if steady and not turning:
        title = f"for all time, {moved.title}"
        if one_circle(c):
            torus = _torus(c, figure, south, north, e2, mirrored, symmetric)
            drift, pace = 0.0, float(c.mean_motion[0])
            if drifting:
                node, periapsis, mean = secular_rates(
                    c.semi_major_axis, c.eccentricity, c.inclination, c.gm
                )
                drift, pace = float(node[0]), float(periapsis[0] + mean[0])
            scope = f"{title}; {torus.scope}"
            return replace(
                torus,
                scope=scope,
                height=high,
                pace=pace,
                drift=drift,
                motion=moved,
                weighed=weighed,
            )
        sides = np.array([[south, north], [0.0, 2 * np.pi], [0.0, 2 * np.pi]])
        pace = float(c.mean_motion[0])
        orbits, circles = orbit_rows(c, figure, pace, 0.0, 0.0, False)
        scope = f"{title}; one revolution, no symmetry"
        return Domain(
            sides=sides,
            orbits=orbits,
            circles=circles,
            normals=normals,
            flattening=e2,
            height=high,
            slack=1e-13,
            scope=scope,
            pace=pace,
            motion=moved,
            weighed=weighed,
        )
    span = Span(
        since, since + (repeat_period(c).duration if duration is None else duration), False, ""
    )
    pace = float(c.mean_motion.mean())
    angle = rate = error = 0.0
    if turning:
        _, frame = motion_of(c, span, Region("", np.zeros((1, 3)), np.zeros(1), mars_fixed=True))
        angle, rate, error = frame.angle, float(frame.spin[2]), frame.error
    sides = np.array([[south, north], [west, east], [span.start * pace, span.stop * pace]])
    length = span.stop - span.start
    begin = f"{since / 3600:.6g} h after the epoch" if since else "the epoch"
    scope = f"over {length / 3600:.6g} h from {begin}, {moved.title}; no symmetry"
    if not moved.is_closed_form:
        path = moved.trajectory(c, span.start, span.stop)
        return _along(
            path, figure, sides, normals, e2, high, error, scope, pace, (angle, rate), moved
        )
    orbits, circles = orbit_rows(c, figure, pace, angle, rate, drifting)
    reach = c.apoapsis_radius.max() / figure.equatorial_radius
    # phases over a long span round by 4 roundoffs of their size
    late = 4.4e-16 * (span.stop * pace + 8.0) / (1.0 - c.eccentricity.max()) ** 2
    slack = float(reach * (error + late))
    return Domain(
        sides=sides,
        orbits=orbits,
        circles=circles,
        normals=normals,
        flattening=e2,
        height=high,
        slack=slack,
        scope=scope,
        pace=pace,
        drift=0.0,
        turning=turning,
        motion=moved,
    )


def _check(
    c: Constellation, figure: Figure, height: float, since: float, duration: float | None
) -> None:
    """Refuse what cannot be asked about."""
    if c.size == 0:
        raise ArgumentError("constellation: no satellite; nothing to certify")
    if not DEEPEST <= height < np.inf:
        raise ArgumentError(f"height = {height:g} m: must be {DEEPEST:g} or more")
    least, most = float(c.periapsis_radius.min()), float(c.apoapsis_radius.max())
    if least <= figure.equatorial_radius:
        raise ArgumentError(
            f"constellation: an orbit comes down to {least / 1e3:.6g} km, "
            f"inside the planet of {figure.equatorial_radius / 1e3:.6g} km"
        )
    if least <= figure.equatorial_radius + height and figure.polar_radius + height <= most:
        raise ArgumentError(
            f"altitude_km = {height / 1e3:.6g}: among the satellites, from {least / 1e3:.6g} to "
            f"{most / 1e3:.6g} km from the centre of Mars, which come as near as one likes; ask "
            "for users below or above them"
        )
    if not 0 <= since < np.inf:
        raise ArgumentError(f"since = {since:g} s: must be 0 or more")
    if duration is not None and not 0 < duration < np.inf:
        raise ArgumentError(f"duration_h = {duration / 3600.0:g}: must be positive and finite")


def _along(
    path: Trajectory,
    figure: Figure,
    sides: NDArray[np.float64],
    normals: NDArray[np.float64],
    e2: float,
    height: float,
    error: float,
    scope: str,
    pace: float,
    frame: tuple[float, float],
    motion: Motion,
) -> Domain:
    """Box of time over paths, seen from a frame at an angle that turns at a rate (rad, rad/s)."""
    radius, (angle, rate) = figure.equatorial_radius, frame
    start, stop = sides[2] / pace
    first = max(int(np.searchsorted(path.breaks, start, side="right")) - 1, 0)
    last = max(int(np.searchsorted(path.breaks, stop, side="left")), first + 1)
    low, high, speed, pull = path.bounds(start, stop).T
    if low.min() <= radius * (1.0 + height):
        raise ArgumentError("constellation: a path comes down to the planet, or its bound does")
    w = abs(rate)
    orbits = np.zeros((path.size, 12))
    orbits[:, 0], orbits[:, 4], orbits[:, 7] = high / radius, -angle, -rate / pace
    orbits[:, 10] = (speed + w * high) / (radius * pace) * (1 + 1e-12)
    orbits[:, 11] = (pull + 2 * w * speed + w * w * high) / (radius * pace**2) * (1 + 1e-12)
    slack = float((path.errors[first:last].max() + error * high.max()) / radius) + 1e-14
    return Domain(
        sides=sides,
        orbits=orbits,
        circles=np.empty((0, 6)),
        normals=normals,
        flattening=e2,
        height=height,
        slack=slack,
        scope=scope + (f"; paths {path.estimated}" if path.estimated else ""),
        pace=pace,
        drift=0.0,
        turning=angle != 0.0 or rate != 0.0,
        motion=motion,
        breaks=np.ascontiguousarray(path.breaks[first : last + 1] * pace),
        paths=np.ascontiguousarray(path.paths[first:last] / radius),
    )


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
    orbits, circles = orbit_rows(c, figure, float(c.mean_motion[0]), 0.0, 0.0, False)
    radius = float(orbits[0, 0])
    east, phases, reason, missed = 2 * np.pi, (0.0, 2 * np.pi), "no symmetry", 0.0
    if symmetric:
        part = deciding_part(c, mirrored=mirrored)
        east, phases, reason, missed = part.longitude, part.phases, part.reason, part.mismatch
        if mirrored and south == -north:
            south = 0.0
    sides = np.array([[south, north], [0.0, east], phases])
    empty = np.empty((0, 3))
    slack = radius * missed + 1e-14 * radius
    return Domain(
        sides=sides,
        orbits=orbits,
        circles=circles,
        normals=empty,
        flattening=e2,
        height=0.0,
        slack=slack,
        scope=reason,
        pace=1.0,
    )

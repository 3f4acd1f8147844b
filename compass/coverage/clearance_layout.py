"""Questions about clearances as kernels take them: motion, frame, and the domain that decides."""

from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.clearance import COARSE, Question
from compass.coverage.motion import MERIDIAN_CURVATURE
from compass.coverage.region import Region
from compass.coverage.symmetry import deciding_part
from compass.coverage.users import Users, centric, check_limb
from compass.errors import ArgumentError, whole_number
from compass.frames import prime_meridian_angle
from compass.orbits import Constellation
from compass.orbits.symmetry import one_circle, one_period
from compass.orbits.trajectory import LOOKED, LOOKS, Trajectory

#: Revolutions over which phases are good to what bounds allow for.
MOST_REVOLUTIONS = 5000.0


#: Orbits that keep their shape, or paths.
Moving = Constellation | Trajectory


def check_users(c: Moving, users: Users, fold: int) -> None:
    """Refuse a fold below 1, satellites that come down to Mars, and users who look through it."""
    whole_number("fold", fold, 1)
    surface = users.figure.equatorial_radius
    if isinstance(c, Trajectory):
        lowest = c.bounds(c.start, c.stop)[:, 0].min(initial=np.inf)
    else:
        lowest = c.periapsis_radius.min(initial=np.inf)
    if lowest <= surface:
        raise ArgumentError(
            f"constellation: an orbit comes down to {lowest / 1e3:.6g} km, "
            f"inside Mars of {surface / 1e3:.6g} km"
        )
    check_limb(users)


@dataclass(frozen=True, eq=False)
class Laid:
    """What kernels take of a question, with the seconds and the phase at which it begins."""

    orbits: NDArray[np.float64]
    figure: NDArray[np.float64]
    turn: float
    horizon: NDArray[np.float64]
    region: Region
    domain: NDArray[np.float64]
    missed: float
    pace: float
    start: float
    breaks: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))
    paths: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0, 3, 0)))

    @property
    def question(self) -> Question:
        """As kernels take it."""
        return Question(
            self.orbits,
            self.breaks,
            self.paths,
            self.figure,
            self.turn,
            self.horizon[0],
            self.horizon[1],
            self.region.normals,
            self.region.floors,
        )


def lay_out(c: Moving, users: Users, span: tuple[float, float] | None) -> Laid:
    """Orbits or paths, frame and domain of a question; paths need a span."""
    flattening = 1.0 - (users.figure.polar_radius / users.figure.equatorial_radius) ** 2
    bend = users.figure.equatorial_radius / np.sqrt(1.0 - flattening) + users.height
    beam = np.pi if users.beam is None else users.beam
    figure = np.array([users.figure.equatorial_radius, flattening, users.height, bend, beam])
    horizon = np.array([users.mask.azimuth, users.mask.elevation])
    if users.alike_all_around:
        horizon = np.ascontiguousarray(horizon[:, :1])
    if isinstance(c, Trajectory):
        assert span is not None
        return _along(c, users, figure, horizon, span)
    pace = float(c.mean_motion.mean())
    if span is None:
        turn, angle, start, missed = 0.0, 0.0, 0.0, 0.0
        domain, missed = _torus(c, users)
        missed = missed and missed * _lever(c, users)
    else:
        start, missed, turn = span[0], 0.0, MARS_ROTATION_RATE.value / pace
        angle = float(prime_meridian_angle(c.epoch, start))
        revolutions = (span[1] - start) * pace / (2 * np.pi)
        if revolutions > MOST_REVOLUTIONS:
            raise ArgumentError(
                f"days = {(span[1] - start) / 86400:g}: {revolutions:.0f} revolutions, more than "
                f"{MOST_REVOLUTIONS:g}; ask for fewer days"
            )
        domain = _box(users, (span[1] - start) * pace)
    orbits = _orbits(c, pace, turn, angle, start)
    return Laid(orbits, figure, turn, horizon, users.region, domain, missed, pace, start)


def _box(users: Users, phase: float) -> NDArray[np.float64]:
    """Latitudes, longitudes and phases of users who stand on Mars."""
    west, east = 0.0, 2 * np.pi
    if users.longitude is not None:
        west = east = users.longitude
    return np.array([[users.south, users.north], [west, east], [0.0, phase]])


def _along(
    path: Trajectory,
    users: Users,
    figure: NDArray[np.float64],
    horizon: NDArray[np.float64],
    span: tuple[float, float],
) -> Laid:
    """Paths over a span, seen from the meridian at its begin, which turns with Mars.

    Mars's rotation is taken as its chord over the span, which departs from it by at most an eighth
    of its curvature times the span squared: an error of places, as that of the paths is.
    """
    start, stop = span
    first = max(int(np.searchsorted(path.breaks, start, side="right")) - 1, 0)
    last = max(int(np.searchsorted(path.breaks, stop, side="left")), first + 1)
    angle, end = (float(w) for w in prime_meridian_angle(path.epoch, [start, stop]))
    rate = (end - angle) / (stop - start)
    r, v = (one[:, 0] for one in path.states([start]))
    pace = float((np.linalg.norm(v, axis=-1) / np.linalg.norm(r, axis=-1)).mean())
    high = path.bounds(start, stop)[:, 1]
    swift = np.zeros(path.size)
    for k in range(first, last):
        swift = np.maximum(swift, _fastest(path, k, rate))
    off = MERIDIAN_CURVATURE * (stop - start) ** 2 / 8 + 2 * np.spacing(max(abs(angle), abs(end)))
    orbits = np.zeros((path.size, 11))
    orbits[:, 0] = high  # by its size sides of boxes are compared
    orbits[:, 9] = swift / pace
    breaks = (path.breaks[first : last + 1] - start) * pace
    # between two moments of a box what paths stand for moves as they do, but for twice their error
    # at the moments themselves and at every break between
    ahead = np.searchsorted(breaks, breaks + COARSE, side="right")
    most = int((ahead - np.arange(len(breaks))).max())
    orbits[:, 10] = 2 * (most + 1) * path.errors[first:last].max(axis=0) + (off + 1e-15) * high
    ca, sa = np.cos(angle), np.sin(angle)
    turned = np.array(path.paths[first:last])
    turned[:, :, 0] = ca * path.paths[first:last, :, 0] + sa * path.paths[first:last, :, 1]
    turned[:, :, 1] = ca * path.paths[first:last, :, 1] - sa * path.paths[first:last, :, 0]
    return Laid(
        orbits,
        figure,
        rate / pace,
        horizon,
        users.region,
        _box(users, (stop - start) * pace),
        0.0,
        pace,
        start,
        np.ascontiguousarray(breaks),
        np.ascontiguousarray(turned),
    )


def _fastest(path: Trajectory, piece: int, rate: float) -> NDArray[np.float64]:
    """Bound on the speed over a stretch in a frame that turns about the pole, m/s, shape (n,).

    The largest at `LOOKS` moments, and how far the nearest of these is times the derivative's
    bound: the sum of the magnitudes of its Legendre coefficients.
    """
    half = 0.5 * (path.breaks[piece + 1] - path.breaks[piece])
    place = np.moveaxis(path.paths[piece], -1, 0)
    speed = legendre.legder(place) / half
    speed = np.concatenate([speed, np.zeros((1, *speed.shape[1:]))])
    speed[..., 0] += rate * place[..., 1]
    speed[..., 1] -= rate * place[..., 0]
    seen = np.linalg.norm(np.moveaxis(legendre.legval(LOOKED, speed), -1, 0), axis=-1)
    bend = np.linalg.norm(legendre.legder(speed), axis=-1).sum(axis=0)
    return np.asarray((seen.max(axis=0) + bend / LOOKS) * (1.0 + 1e-12))


def _lever(c: Constellation, users: Users) -> float:
    """By how much more than a satellite about Mars's centre its sights turn, at most."""
    a, b = users.figure.equatorial_radius + users.height, users.figure.polar_radius + users.height
    shortest = max(c.periapsis_radius.min() - a, b - c.apoapsis_radius.max())
    if shortest <= 0.0:  # users among the satellites, which may come as near as one likes
        return np.inf
    turn = float(c.apoapsis_radius.max() / shortest)
    return turn if users.beam is None else turn + 1.0


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
        np.column_stack([*columns, e, anomaly, mean, swift * (1.0 + 1e-12), np.zeros(c.size)])
    )


def _torus(c: Constellation, users: Users) -> tuple[NDArray[np.float64], float]:
    """Latitudes, longitudes and phases that decide for ever; what symmetries miss, radians."""
    if not one_period(c):
        raise ArgumentError(
            "orbits of different periods: a claim for ever would need every combination of their "
            "phases; give days"
        )
    around, missed = 2 * np.pi, 0.0
    south, east, phases = users.south, around, (0.0, around)
    if one_circle(c):
        part = deciding_part(c, mirrored=users.alike_all_around)
        east, phases, missed = part.longitude, part.phases, part.mismatch
        if users.alike_all_around and south == -users.north:
            south = 0.0
        if not np.any(c.inclination):
            # a ring over the equator only turns, and users are at every longitude
            east, phases = around, (0.0, 0.0)
    if south == users.north and abs(south) == np.pi / 2 and users.alike_all_around:
        east = 0.0  # a pole has one longitude
    return np.array([[south, users.north], [0.0, east], phases]), missed


def place_of(
    c: Moving, users: Users, laid: Laid, worst: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Seconds after the epoch, planetocentric latitude, Mars-fixed longitude of a box's centre."""
    time = laid.start + float(worst[2]) / laid.pace
    longitude = float(worst[1])
    if laid.turn == 0.0:
        time = laid.start + float(np.mod(worst[2], 2 * np.pi)) / laid.pace
        longitude -= float(prime_meridian_angle(c.epoch, time))
    longitude = float(np.mod(longitude + np.pi, 2 * np.pi) - np.pi)
    return time, centric(float(worst[0]), users.figure), longitude

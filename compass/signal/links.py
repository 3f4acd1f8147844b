"""Who tracks whom when: the rows of all measurements of an arc."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.determine import STATES, in_turn
from compass.core.motion import states
from compass.design import Design
from compass.frames import Figure, mci_from_icrf, prime_meridian_angle
from compass.moons import moon_row
from compass.planets import sun_earth_mci
from compass.tracking import Tracker, Tracking

Array = NDArray[Any]

#: Columns of a row: two satellites' states and what is considered of a tracker.
WIDTH = 2 * STATES + 5
MINUTE, SHIFT, COMPLEXES = 60.0, 8 * 3600.0, 3
CLOCK = 6

#: Satellites nearer to each other than this are not linked, m: the line between them turns with
#: their errors, so that a range along it is not linear in them (100 m make 5 cm at this distance).
NEAREST = 1e5

#: Rotation of the Earth, rad/s (IERS Conventions 2010, table 1.2).
EARTH_SPIN = 7.292115e-5


@dataclass(frozen=True)
class Rows:
    """Measurements in order of time, as `compass.core.determine.follow` takes them.

    Attributes
    ----------
    first, columns, values, variances
        See there.
    considered
        Variance of each considered number, behind the satellites' states.
    counts
        How many measurements each kind of tracker made.
    tracked
        By kind of tracker: which satellites are measured when, shape (satellite, epoch).
    """

    first: NDArray[np.int64]
    columns: NDArray[np.int64]
    values: Array
    variances: Array
    considered: Array
    counts: dict[str, int]
    tracked: dict[str, NDArray[np.bool_]]


@dataclass(frozen=True)
class _Sight:
    """One tracker's satellites: which are in view, directions and distances, who it is.

    Shapes (satellite, epoch), with a last axis of 3 for vectors; `axes` are the tracker's own
    coordinates in the inertial frame, (epoch, 3, 3), and `spin` how fast they turn there, rad/s,
    (epoch, 3).
    """

    kind: str
    tracker: Tracker
    seen: NDArray[np.bool_]
    away: Array
    speed: Array
    on_duty: NDArray[np.bool_]
    axes: Array
    spin: Array

    @property
    def busy(self) -> NDArray[np.bool_]:
        """Which may be measured: in view of a tracker on duty."""
        return self.seen & self.on_duty


def measurement_rows(design: Design, tracking: Tracking, times: Array, r: Array, v: Array) -> Rows:
    """Rows of every measurement of an arc.

    Parameters
    ----------
    design
        Its stations, figure and mask.
    tracking
        Who tracks.
    times
        Epochs, s, shape (t,).
    r, v
        Inertial states of the satellites, m and m/s, shape (n, t, 3).
    """
    n = r.shape[0]
    parts: list[tuple[Array, NDArray[np.int64], Array, Array]] = []
    considered: list[float] = []
    counts = dict.fromkeys(tracking.kinds, 0)
    tracked = {kind: np.zeros((n, len(times)), bool) for kind in tracking.kinds}
    for sight in _sights(design, tracking, times, r, v):
        at = STATES * n + len(considered)
        tracker = sight.tracker
        considered += [tracker.bias**2, tracker.time_bias**2] + [tracker.position**2] * 3
        busy = in_turn(sight.busy) if tracker.schedule == "in-turn" else sight.busy
        tracked[sight.kind] |= busy
        for part in _rows(sight, busy, at, tracking.step):
            parts.append(part)
            counts[sight.kind] += len(part[0])
    if tracking.crosslinks is not None:
        one, two = np.triu_indices(n, 1)
        busy = clear_of(design.figure, r[one], r[two])
        busy &= np.linalg.norm(r[two] - r[one], axis=-1) >= NEAREST
        if tracking.crosslinks.schedule == "in-turn":
            busy = in_turn(busy)
        np.logical_or.at(tracked["crosslinks"], one, busy)
        np.logical_or.at(tracked["crosslinks"], two, busy)
        for part in _crosslinks(busy, one, two, tracking, r, v):
            parts.append(part)
            counts["crosslinks"] += len(part[0])
    epoch = np.concatenate([np.zeros(0), *(p[0] for p in parts)]).astype(np.int64)
    order = np.argsort(epoch, kind="stable")
    columns = np.concatenate([np.zeros((0, WIDTH), np.int64), *(p[1] for p in parts)])
    values = np.concatenate([np.zeros((0, WIDTH)), *(p[2] for p in parts)])
    variances = np.concatenate([np.zeros(0), *(p[3] for p in parts)])
    first = np.searchsorted(epoch[order], np.arange(len(times) + 1))
    return Rows(
        first=first,
        columns=columns[order],
        values=values[order],
        variances=variances[order],
        considered=np.array(considered),
        counts=counts,
        tracked=tracked,
    )


def _sights(
    design: Design, tracking: Tracking, times: Array, r: Array, v: Array
) -> Iterator[_Sight]:
    """Every tracker with its view of the satellites, but for crosslinks."""
    epoch = design.constellation.epoch
    always = np.ones(len(times), bool)
    if tracking.earth is not None:
        earth = sun_earth_mci(epoch, times)[1]
        away, speed = r - earth[:, :3], v - earth[:, 3:]
        seen = clear_of(design.figure, np.broadcast_to(earth[:, :3], r.shape), r)
        tilt = mci_from_icrf(epoch)
        axes = tilt @ _turn(EARTH_SPIN * times)
        spin = np.broadcast_to(EARTH_SPIN * tilt[:, 2], (len(times), 3))
        for complex_ in range(COMPLEXES):
            duty = (times // SHIFT).astype(int) % COMPLEXES == complex_
            yield _Sight(
                kind="earth",
                tracker=tracking.earth,
                seen=seen,
                away=away,
                speed=speed,
                on_duty=duty,
                axes=axes,
                spin=spin,
            )
    if tracking.stations is not None:
        for site in design.stations:
            turn = _turn(prime_meridian_angle(epoch, times))
            place = turn @ site.r_mcmf
            turning = np.array([0.0, 0.0, MARS_ROTATION_RATE.value])
            away = r - place
            fixed = np.einsum("tji,ntj->nti", turn, away) @ site.enu_mcmf.T
            elevation = np.arcsin(fixed[..., 2] / np.linalg.norm(fixed, axis=-1))
            azimuth = np.arctan2(fixed[..., 0], fixed[..., 1])
            seen = elevation >= site.mask.at(azimuth)
            yield _Sight(
                kind="stations",
                tracker=tracking.stations,
                seen=seen,
                away=away,
                speed=v - np.cross(turning, place),
                on_duty=always,
                axes=turn,
                spin=np.broadcast_to(turning, (len(times), 3)),
            )
    if tracking.moons is not None:
        for name in ("phobos", "deimos"):
            row = moon_row(name, epoch, 0.5 * float(times[-1]))
            moon = states(row, np.zeros((1, 6)), times)
            away = r - moon[:, :3]
            seen = clear_of(design.figure, np.broadcast_to(moon[:, :3], r.shape), r)
            axes = np.swapaxes(_orbit_axes(moon), 1, 2)
            yield _Sight(
                kind="moons",
                tracker=tracking.moons,
                seen=seen,
                away=away,
                speed=v - moon[:, 3:],
                on_duty=always,
                axes=axes,
                spin=np.cross(moon[:, :3], moon[:, 3:])
                / (moon[:, :3] ** 2).sum(axis=1, keepdims=True),
            )


def _turn(angle: Array) -> Array:
    """Rotations from the Mars-fixed to the inertial frame, shape (t, 3, 3)."""
    turn = np.zeros((len(angle), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0], turn[:, 0, 1], turn[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    return turn


def _orbit_axes(states_: Array) -> Array:
    from compass.signal.ranges import radial_along_cross

    return radial_along_cross(states_[:, :3], states_[:, 3:])


def clear_of(figure: Figure, one: Array, two: Array) -> NDArray[np.bool_]:
    """Whether the straight line between places passes Mars, shape of the places less the last.

    With the pole stretched so that the figure is a sphere, its nearest point to the centre must
    lie outside, or not between the ends.
    """
    scale = np.array([1.0, 1.0, figure.stretch])
    a, b = one * scale, two * scale
    d = b - a
    share = np.clip(-(a * d).sum(axis=-1) / (d * d).sum(axis=-1), 0.0, 1.0)
    nearest = a + share[..., None] * d
    return np.asarray((nearest * nearest).sum(axis=-1) >= figure.equatorial_radius**2)


def _rows(
    sight: _Sight, busy: NDArray[np.bool_], at: int, step: float
) -> Iterator[tuple[Array, NDArray[np.int64], Array, Array]]:
    """Epochs, columns, values and variances of one tracker's measurements, kind by kind."""
    tracker = sight.tracker
    satellite, epoch = np.nonzero(busy)
    distance = np.linalg.norm(sight.away, axis=-1)[satellite, epoch][:, None]
    u = sight.away[satellite, epoch] / distance
    rate = sight.speed[satellite, epoch]
    columns = np.full((len(epoch), WIDTH), -1)
    columns[:, :STATES] = STATES * satellite[:, None] + np.arange(STATES)
    columns[:, 2 * STATES :] = at + np.arange(5)
    empty, axes = np.zeros((len(epoch), WIDTH)), sight.axes[epoch]
    if tracker.range is not None:
        values = empty.copy()
        values[:, :3], values[:, CLOCK] = u, float(tracker.one_way)
        values[:, 2 * STATES] = 1.0
        values[:, 2 * STATES + 2 :] = -np.einsum("mi,mij->mj", u, axes)
        yield epoch, columns, values, np.full(len(epoch), tracker.range**2)
    if tracker.doppler is not None:
        values = empty.copy()
        values[:, 3:6] = u
        across = (rate - (rate * u).sum(axis=1, keepdims=True) * u) / distance
        values[:, :3] = across
        # an error of the place turns with its axes, and the line of sight turns against it
        turned = across + np.cross(u, sight.spin[epoch])
        values[:, 2 * STATES + 2 :] = -np.einsum("mi,mij->mj", turned, axes)
        counted = tracker.doppler**2 * MINUTE / step
        yield epoch, columns, values, np.full(len(epoch), counted)
    if tracker.time is not None:
        values = empty.copy()
        values[:, CLOCK] = values[:, 2 * STATES + 1] = 1.0
        yield epoch, columns, values, np.full(len(epoch), tracker.time**2)


def _crosslinks(
    busy: NDArray[np.bool_], one: Array, two: Array, tracking: Tracking, r: Array, v: Array
) -> Iterator[tuple[Array, NDArray[np.int64], Array, Array]]:
    """As `_rows`, of pairs of satellites."""
    tracker = tracking.crosslinks
    assert tracker is not None
    away, speed = r[two] - r[one], v[two] - v[one]
    pair, epoch = np.nonzero(busy)
    distance = np.linalg.norm(away, axis=-1)[pair, epoch][:, None]
    u, rate = away[pair, epoch] / distance, speed[pair, epoch]
    columns = np.full((len(epoch), WIDTH), -1)
    columns[:, :STATES] = STATES * one[pair][:, None] + np.arange(STATES)
    columns[:, STATES : 2 * STATES] = STATES * two[pair][:, None] + np.arange(STATES)
    empty = np.zeros((len(epoch), WIDTH))
    if tracker.range is not None:
        values = empty.copy()
        values[:, :3], values[:, STATES : STATES + 3] = -u, u
        # a bias of each link is noise of all links together: they do not share it
        yield epoch, columns, values, np.full(len(epoch), tracker.range**2 + tracker.bias**2)
    if tracker.doppler is not None:
        values = empty.copy()
        across = (rate - (rate * u).sum(axis=1, keepdims=True) * u) / distance
        values[:, :3], values[:, STATES : STATES + 3] = -across, across
        values[:, 3:6], values[:, STATES + 3 : STATES + 6] = -u, u
        counted = tracker.doppler**2 * MINUTE / tracking.step
        yield epoch, columns, values, np.full(len(epoch), counted)
    if tracker.time is not None:
        values = empty.copy()
        values[:, CLOCK], values[:, STATES + CLOCK] = -1.0, 1.0
        yield epoch, columns, values, np.full(len(epoch), tracker.time**2)

"""Station-keeping: impulses that hold each satellite in a box about its slot.

The slots move as one, at the mean of the rates that satellites begin with. A satellite's place in
its slot is the angle it has turned in its orbit's plane less the slot's, averaged over a
revolution, which takes out the swing of a slightly oval orbit. It is followed turn by turn under
all forces; where the average has reached the edge and moves outwards, a tangential impulse sends
it back, as fast as it may go to turn just before the other edge under the push u'' met so far:

    u' = -+ sqrt(2 (|u| + w) |u''|),    dv = -a du' / 3 .

For a constant push that gives a burn every ``4 sqrt(w / |u''|)`` and ``a |u''| / 3`` of delta-v a
second, whatever the box; here both are outcomes. About an unstable point of the field there is no
turning before the other edge: a satellite that comes out there is sent less far by half the next
time, so that it turns before that point, and further again by and by.

Across the track the orbits' poles are compared with those of the slots, turned as one by the best
rotation; where one has come too far off, an impulse where the satellite crosses the plane that it
should be in turns its velocity into that plane: ``2 v sin(tilt / 2)``.

Of an oval orbit an impulse where the speed is v changes the mean motion by
``dn = -3 n a v dv / GM``, which of a circle is the law above. Its periapsis is left to turn.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from compass.errors import ArgumentError, found_so_far
from compass.frames import SECONDS_PER_DAY
from compass.orbits.constellation import Constellation
from compass.orbits.ellipse import elliptic
from compass.orbits.forces import ForceModel
from compass.orbits.trajectory import COARSE, Trajectory, integrate
from compass.orbits.trimming import angular_rates, kinds_of, with_axes
from compass.words import counted

#: Revolutions over which the push is fitted before the first burn, and at most later.
LEARNING, MEMORY = 8, 40

#: Places of a revolution in which a crossing of a plane is looked for.
LOOKS = 25

#: Eccentricities, and inclinations in radians, that lie no further apart count as alike.
ALIKE = 0.005

#: Smallest push that counts, rad/s^2: 1e-4 degrees a day squared. Where it is weaker a satellite
#: is sent back at the speed for this one.
WEAKEST = np.radians(1e-4) / SECONDS_PER_DAY**2


#: By how much further a satellite is sent after each time that it came back as it was to: eight
#: make up for once too far, for slots leave an unstable point behind over the years.
RECOVERY = 2.0**0.125


@dataclass(frozen=True)
class Keeping:
    """What it took to keep satellites in their slots.

    Attributes
    ----------
    duration
        Time simulated, s.
    half_width
        Of the box along the track, radians.
    delta_v
        Sum of the impulses of each satellite, m/s, shape (n,).
    burns
        Their number, shape (n,).
    worst
        Furthest average place along the track after the learning, radians, shape (n,).
    tilt
        Largest angle of each orbit's pole from that of its slot, the poles turned as one,
        radians, shape (n,).
    delta_v_across, burns_across
        Likewise of impulses across the track.
    push
        Mean acceleration along the track that was met, m/s^2, shape (n,).
    """

    duration: float
    half_width: float
    delta_v: NDArray[np.float64]
    burns: NDArray[np.int64]
    worst: NDArray[np.float64]
    tilt: NDArray[np.float64]
    push: NDArray[np.float64]
    delta_v_across: NDArray[np.float64]
    burns_across: NDArray[np.int64]


def keep_slots(
    constellation: Constellation,
    forces: ForceModel,
    duration: float,
    half_width: float,
    *,
    across: float = np.inf,
    smallest_burn: float = 0.0,
    execution_error: float = 0.0,
    navigation_error: float = 0.0,
    seed: int = 0,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> Keeping:
    """Simulate impulsive station-keeping.

    Parameters
    ----------
    constellation
        Orbits of one period, as far as J2 lets it be seen; osculating elements at the epoch.
    forces
        What acts.
    duration
        Seconds, at least thirty revolutions.
    half_width
        Of the box along the track, radians.
    across
        Tilt of an orbit's pole at which it is turned back, radians.
    smallest_burn
        Smaller ones are made as large, m/s.
    execution_error, navigation_error
        1 sigma: of an impulse, relative; of the place along the track that is seen, m. What an
        impulse really was is known afterwards.
    seed
        Of these errors.
    progress
        Wraps the list of revolutions, as tqdm does.

    Raises
    ------
    ArgumentError
        Orbits of unequal period, too short a time, or no box.
    """
    c = constellation
    if c.size == 0 or kinds_of(c).any():
        raise ArgumentError("keep: needs orbits of one period; slots move as one")
    if not half_width > 0.0:
        raise ArgumentError(
            f"box_deg = {np.degrees(half_width):g}: must be more than 0; the margin leaves no room"
        )
    period = float(2 * np.pi / c.mean_motion.mean())
    count = round(duration / period)
    if count < 30:
        least = 30.5 * period / (365.25 * SECONDS_PER_DAY)
        raise ArgumentError(
            f"years: {counted(count, 'revolution')}; give at least 30 of them, {least:.2g} years"
        )
    own = with_axes(c, c.semi_major_axis, gm=forces.field.gm)
    r, v = (a[:, 0] for a in elliptic(own, np.zeros(1)))
    poles = _poles(r, v)
    axis, oval = float(c.semi_major_axis.mean()), c.eccentricity > 0.0
    random = np.random.default_rng(seed)
    state = _Slots(c.size, axis, half_width, smallest_burn)
    theta, tilt, time = np.zeros(c.size), np.zeros(c.size), 0.0
    spent, burns = np.zeros(c.size), np.zeros(c.size, dtype=np.int64)

    def so_far() -> str:
        if not time:
            return ""
        years = time / (365.25 * SECONDS_PER_DAY)
        mean = float((state.spent + spent).mean()) / years
        return f"kept for {years:.3g} years so far, at {mean:.3g} m/s an Earth year a satellite"

    with found_so_far(so_far):
        for k in progress(list(range(count))):
            path = integrate(
                r, v, forces, time + period, start=time, epoch=c.epoch,
                satellite_names=c.satellite_names, tolerance=COARSE,
            )  # fmt: skip
            gone, mean = _turn_and_mean(path)
            mean, theta, time = theta + mean, theta + gone, time + period
            r, v = (a[:, 0] for a in path.states([time]))
            wrong = navigation_error / axis * random.standard_normal(c.size)
            done = 1.0 + execution_error * random.standard_normal(c.size)
            slots = _turned_as_one(_poles(r, v), poles)
            tilts = _angles(_poles(r, v), slots)
            tilt = np.maximum(tilt, tilts)
            for s in np.flatnonzero(tilts > across):
                r[s], v[s], burnt = _into_plane(path.only(int(s)), slots[s], float(done[s]), forces)
                spent[s] += burnt
                burns[s] += 1
            speed = np.linalg.norm(v, axis=1)
            if oval.any():
                state.lever = np.where(oval, own.gm / (own.mean_motion * axis * speed), axis)
            kicks = state.look((k + 0.5) * period, mean, mean + wrong, done)
            v = v + kicks[:, None] * v / speed[:, None]
    return Keeping(
        duration=count * period,
        half_width=half_width,
        delta_v=state.spent,
        burns=state.burns,
        worst=state.worst,
        tilt=tilt,
        push=axis / 3.0 * state.push(),
        delta_v_across=spent,
        burns_across=burns,
    )


def keep_kinds(
    constellation: Constellation,
    forces: ForceModel,
    duration: float,
    half_width: float,
    *,
    progress: Callable[[Sequence[Any]], Any] = iter,
    **upkeep: Any,
) -> Keeping:
    """Keep satellites of several kinds of orbit, each kind in places of its own.

    Of one kind are orbits of like axis (`kinds_of`), eccentricity and inclination, which field and
    flattening turn alike: their phases and planes are held to each other's, not to other kinds'.

    Parameters and errors as in `keep_slots`.
    """
    c = constellation
    shapes = np.column_stack([kinds_of(c), _runs(c.eccentricity), _runs(c.inclination)])
    kinds = np.unique(shapes, axis=0, return_inverse=True)[1].ravel()
    kept, owners = list[Keeping](), list[NDArray[np.int64]]()
    for kind in range(int(kinds.max()) + 1):
        others = np.flatnonzero(kinds != kind).tolist()
        owners.append(np.flatnonzero(kinds == kind))
        kept.append(
            keep_slots(c.without(others), forces, duration, half_width, progress=progress, **upkeep)
        )
    order = np.argsort(np.concatenate(owners))

    def joined(name: str, per_time: bool = False) -> NDArray[Any]:
        scale = [duration / one.duration if per_time else 1 for one in kept]
        parts = [getattr(one, name) * by for one, by in zip(kept, scale, strict=True)]
        return np.asarray(np.concatenate(parts)[order])

    return Keeping(
        duration=duration,
        half_width=half_width,
        delta_v=joined("delta_v", per_time=True),
        burns=joined("burns"),
        worst=joined("worst"),
        tilt=joined("tilt"),
        push=joined("push"),
        delta_v_across=joined("delta_v_across", per_time=True),
        burns_across=joined("burns_across"),
    )


def _runs(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Number of the run that each value is of: a gap wider than `ALIKE` begins another."""
    order, labels = np.argsort(values), np.zeros(values.size, dtype=np.int64)
    labels[order[1:]] = np.cumsum(np.diff(values[order]) > ALIKE)
    return labels


class _Slots:
    """Places in the slots as a controller sees them: one average a revolution."""

    def __init__(self, size: int, axis: float, half_width: float, smallest: float) -> None:
        # metres a second for a third of a radian a second of mean motion: the axis of a circle
        self.lever = np.full(size, axis)
        self.half_width, self.smallest = half_width, smallest
        self.times: list[float] = []
        self.places: list[NDArray[np.float64]] = []
        self.origin: NDArray[np.float64] | None = None
        self.rate = 0.0
        # impulses so far: their moments, and what they did to each satellite's rate
        self.history: list[tuple[float, NDArray[np.float64]]] = []
        # how far each may be sent, of the way to the other edge; on which side it burnt last
        self.reach, self.side = np.ones(size), np.zeros(size)
        self.spent, self.worst = np.zeros(size), np.zeros(size)
        self.burns = np.zeros(size, dtype=np.int64)
        self.pushes: list[NDArray[np.float64]] = []

    def look(
        self,
        time: float,
        mean: NDArray[np.float64],
        seen: NDArray[np.float64],
        done: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Take the averages of a revolution; return the impulse of each satellite, m/s.

        `seen` is what navigation makes of the averages, `done` what becomes of an impulse of 1.
        """
        self.times.append(time)
        self.places.append(seen)
        size = mean.size
        if len(self.times) < LEARNING:
            return np.zeros(size)
        if self.origin is None:
            self._begin()
        assert self.origin is not None
        place, speed, push = self._fit(seen)
        true = mean - self.origin - self.rate * time
        self.worst = np.maximum(self.worst, np.abs(true))
        self.pushes.append(push)
        side = np.sign(place)
        out = (np.abs(place) >= self.half_width) & (speed * side > 0.0)
        across, back = out & (self.side == -side), out & (self.side == side)
        self.reach = np.where(across, 0.5 * self.reach, self.reach)
        self.reach = np.where(back, np.minimum(RECOVERY * self.reach, 1.0), self.reach)
        self.side = np.where(out, side, self.side)
        way = self.reach * (np.abs(place) + self.half_width)  # up to the other edge
        wanted = -side * np.sqrt(2.0 * way * np.maximum(np.abs(push), WEAKEST))
        least = 3.0 * self.smallest / self.lever
        asked = -side * np.maximum(np.abs(wanted - speed), least)
        change = np.where(out, asked * done, 0.0)
        # the impulse comes half a revolution after the average's moment
        step = self.times[-1] - self.times[-2]
        if out.any():
            self.history.append((time + 0.5 * step, change))
        kicks = -self.lever * change / 3.0
        self.spent = self.spent + np.abs(kicks)
        self.burns = self.burns + out
        return np.asarray(kicks)

    def push(self) -> NDArray[np.float64]:
        """Mean size of the push that was met, rad/s^2."""
        return np.asarray(np.abs(self.pushes).mean(axis=0))

    def _begin(self) -> None:
        """Fix where the slots are: the first averages, moving on at the mean of the first rates."""
        t = np.array(self.times)
        rates = np.polyfit(t - t[0], np.array(self.places), 2)[1]
        self.rate = float(rates.mean())
        self.origin = self.places[0] - self.rate * t[0]

    def _fit(self, mean: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Place, speed and push of each satellite now, by a parabola through its recent past.

        What impulses have added is taken out first, so that the past is one unbroken arc.
        """
        assert self.origin is not None
        t = np.array(self.times[-MEMORY:])
        past = np.array(self.places[-MEMORY:]) - self.origin - self.rate * t[:, None]
        bend, slope, _ = np.polyfit(t - t[-1], past - self._kicks_at(t), 2)
        added = sum((change for _, change in self.history), np.zeros(mean.size))
        return past[-1], slope + added, 2.0 * bend

    def _kicks_at(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """What all impulses up to each time have added to the places, radians, (t, n)."""
        kicks = np.zeros((t.size, self.spent.size))
        for moment, change in self.history:
            kicks += np.maximum(t - moment, 0.0)[:, None] * change
        return kicks


def _turn_and_mean(path: Trajectory) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle turned over a path, and its mean over the time, radians, shape (n,) each.

    By parts: ``mean = integral of theta'(t) (T - t) / T``.
    """
    times, weights, rate = angular_rates(path)
    left = (path.stop - times) / (path.stop - path.start)
    return rate @ weights, rate @ (weights * left)


def _poles(r: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors along the angular momenta, shape (n, 3)."""
    momentum = np.cross(r, v)
    return np.asarray(momentum / np.linalg.norm(momentum, axis=1, keepdims=True))


def _turned_as_one(now: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poles as they were, turned as one by the rotation nearest to those now (Kabsch 1976)."""
    u, _, w = np.linalg.svd(before.T @ now)
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ w))])
    return np.asarray(before @ (u @ flip @ w))


def _angles(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles between unit vectors, row by row, good near zero."""
    sine = np.linalg.norm(np.cross(a, b), axis=1)
    return np.asarray(np.arctan2(sine, (a * b).sum(axis=1)))


def _into_plane(
    path: Trajectory, pole: NDArray[np.float64], done: float, forces: ForceModel
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """State at the end of a satellite's revolution if it is turned into a plane, and the impulse.

    The velocity is turned about the place where the satellite crosses the plane of that pole, by
    the share `done` of the whole angle.
    """
    times = np.linspace(path.start, path.stop, LOOKS)
    height = path.states(times)[0][0] @ pole
    k = int(np.flatnonzero(height[:-1] * height[1:] <= 0.0)[0])
    moment = float(brentq(lambda t: path.states([t])[0][0, 0] @ pole, times[k], times[k + 1]))
    r, v = (a[0, 0] for a in path.states([moment]))
    out = r / np.linalg.norm(r)
    now, wanted = (np.cross(h, out) for h in (np.cross(r, v), pole))
    now, wanted = now / np.linalg.norm(now), wanted / np.linalg.norm(wanted)
    angle = done * float(np.arctan2(np.cross(now, wanted) @ out, now @ wanted))
    turned = Rotation.from_rotvec(angle * out).apply(v)
    if moment >= path.stop:
        return r, turned, float(np.linalg.norm(turned - v))
    rest = integrate(
        r[None], turned[None], forces, path.stop, start=moment, epoch=path.epoch, tolerance=COARSE
    )
    end = tuple(a[0, 0] for a in rest.states([path.stop]))
    return end[0], end[1], float(np.linalg.norm(turned - v))

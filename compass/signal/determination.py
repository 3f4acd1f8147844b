"""How well orbits and clocks are known: a covariance study over an arc of tracking."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.bodies import SPEED_OF_LIGHT
from compass.clocks import SECONDS_PER_DAY, Clock
from compass.core.determine import MOVED, STATES, follow
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import HOUR
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion
from compass.orbits.transition import driven, gradient, transitions, turned_quadrupole
from compass.ranging import Receiver, Signal
from compass.signal.links import measurement_rows
from compass.signal.ranges import radial_along_cross
from compass.signal.unknown_forces import field_variances, pushes_along
from compass.tracking import Tracking

Array = NDArray[Any]

#: Relative error of a clock's frequency before the arc, where none is given.
UNKNOWN_FREQUENCY = 1e-10

#: Where a satellite's scale of sunlight's push stands among its numbers.
SCALE = 8

#: Bytes that one machine's memory may give to transitions and rows together.
LARGEST = 4e9


@dataclass(frozen=True)
class Determination:
    """Covariances of all satellites along an arc, and over a prediction behind it.

    Attributes
    ----------
    times
        Seconds after the epoch, shape (t,).
    covariance
        Of radial, along, cross (m) and clock (m) of each satellite, shape (t, n, 4, 4).
    arc
        Length of the tracked part, s; what follows is prediction.
    orientation
        One sigma of a common turn of all orbits at the end of the arc, rad, about each axis, (3,).
    common_time
        One sigma of the mean clock there, m.
    counts
        Measurements of each kind of tracker.
    tracking
        By whom.
    tracked
        By kind of tracker: which satellites it measures at which epoch of the arc, shape (n, t).
    """

    times: Array
    covariance: Array
    arc: float
    orientation: Array
    common_time: float
    counts: dict[str, int]
    tracking: Tracking
    tracked: dict[str, NDArray[np.bool_]]

    @property
    def sigma(self) -> Array:
        """Radial, along, cross and clock of each satellite, m, shape (t, n, 4)."""
        return np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=2, axis2=3), 0.0))

    @property
    def rms(self) -> Array:
        """Radial, along, cross and clock, root mean square over satellites, m, shape (t, 4)."""
        return np.sqrt((self.sigma**2).mean(axis=1))

    @property
    def last(self) -> int:
        """Place of the last tracked epoch."""
        return int(np.searchsorted(self.times, self.arc + 1e-6)) - 1


def clock_noise(clock: Clock | None, step: float) -> Array:
    """Covariance that a step adds to clock and clock rate, m^2, m^2/s, m^2/s^2, shape (2, 2).

    White frequency noise and a random walk of the frequency (Zucca and Tavella 2005, IEEE Trans.
    UFFC 52:289); flicker stands as the walk with the same deviation at a day.
    """
    if clock is None:
        return np.zeros((2, 2))
    walk2 = clock.walk**2 + clock.flicker**2 / SECONDS_PER_DAY
    one, two = clock.white**2, 3.0 * walk2
    h = step
    form = [[one * h + two * h**3 / 3.0, two * h**2 / 2.0], [two * h**2 / 2.0, two * h]]
    return SPEED_OF_LIGHT.value**2 * np.array(form)


def determine_orbits(
    design: Design,
    tracking: Tracking | None = None,
    *,
    motion: Motion | None = None,
    prediction: float = 0.0,
) -> Determination:
    """Covariance of all satellites' orbits and clocks, tracked over an arc from the epoch.

    Errors grow by the gradient of a point, J2 and C22 along the design's motion, by what is not
    known of sunlight's push and of the field, and by process noise. The scale of sunlight's push
    is estimated for each satellite; the field's errors, trackers' biases and places are considered:
    no measurement improves them.

    Parameters
    ----------
    design
        Its motion, stations, and its signal's clock.
    tracking
        By whom; the design's if left out.
    motion
        Instead of the design's.
    prediction
        Seconds without tracking behind the arc.

    Raises
    ------
    ArgumentError
        Nobody tracks; an arc that takes too much memory.
    """
    chosen = tracking or design.tracking
    if chosen is None:
        raise ArgumentError(
            "tracking: nobody tracks the satellites; add a table [tracking] with earth, stations, "
            "moons or crosslinks"
        )
    c, step = design.constellation, chosen.step
    tracked = round(chosen.duration / step)
    steps = tracked + int(np.ceil(prediction / step))
    _check_memory(c.size, steps, chosen)
    times = step * np.arange(steps + 1)
    halves = 0.5 * step * np.arange(2 * steps + 1)
    moved = motion or design.motion
    r_halves, v_halves = moved.states(c, halves)
    gradients = gradient(r_halves, turned_quadrupole(built_in_field(), c.epoch, halves), c.gm)
    r, v = np.ascontiguousarray(r_halves[:, ::2]), np.ascontiguousarray(v_halves[:, ::2])
    moves = np.zeros((steps, c.size, STATES, STATES))
    moves[:, :, :6, :6] = np.moveaxis(transitions(gradients, step), 1, 0)
    moves[:, :, 6, 6] = moves[:, :, 7, 7] = 1.0
    moves[:, :, 6, 7] = step
    moves[:, :, SCALE, SCALE] = 1.0
    drives = np.zeros((steps, c.size, MOVED, 0))
    field_variance = np.zeros(0)
    if chosen.radiation or chosen.gravity:
        unit = pushes_along(design, moved, halves, r_halves)
        done = np.moveaxis(driven(gradients, unit, step), 1, 0)
        moves[:, :, :MOVED, SCALE] = done[..., 0]
        if chosen.gravity:
            drives = np.ascontiguousarray(done[..., 1:])
            field_variance = field_variances(chosen.gravity)
    rows = measurement_rows(
        design, chosen, times[: tracked + 1], r[:, : tracked + 1], v[:, : tracked + 1]
    )
    clock = None if design.signal is None else design.signal.clock
    p = _prior(c.size, chosen, clock, np.concatenate([rows.considered, field_variance]))
    noise = np.zeros((STATES, STATES))
    h = step
    push = chosen.process_noise * np.array([[h**3 / 3.0, h**2 / 2.0], [h**2 / 2.0, h]])
    for axis in range(3):
        noise[np.ix_([axis, axis + 3], [axis, axis + 3])] = push
    noise[MOVED:SCALE, MOVED:SCALE] = clock_noise(clock, step)
    believed = np.zeros((0, 0))
    if chosen.considered == "blind":
        believed = p.copy()
        believed[STATES * c.size :, STATES * c.size :] = 0.0
    out = np.zeros((steps + 1, c.size, 4, 4))
    estimated = STATES * c.size
    follow(
        p, believed, moves[:tracked], drives[:tracked], noise, rows.first, rows.columns,
        rows.values, rows.variances, estimated, out[: tracked + 1],
    )  # fmt: skip
    orientation, common_time = _common(p, r[:, tracked])
    if steps > tracked:
        none = np.zeros(steps - tracked + 2, np.int64)
        follow(
            p, believed, moves[tracked:], drives[tracked:], noise, none, rows.columns[:0],
            rows.values[:0], rows.variances[:0], estimated, out[tracked:],
        )  # fmt: skip
    axes = np.zeros((steps + 1, c.size, 4, 4))
    axes[..., :3, :3] = np.moveaxis(radial_along_cross(r, v), 0, 1)
    axes[..., 3, 3] = 1.0
    return Determination(
        times=times,
        covariance=axes @ out @ np.swapaxes(axes, -1, -2),
        arc=tracked * step,
        orientation=orientation,
        common_time=common_time,
        counts=rows.counts,
        tracking=chosen,
        tracked=rows.tracked,
    )


def _prior(satellites: int, tracking: Tracking, clock: Clock | None, considered: Array) -> Array:
    """Covariance before the first measurement."""
    known = clock.frequency_sigma if clock else None
    rate = SPEED_OF_LIGHT.value * (known or UNKNOWN_FREQUENCY)
    one = [tracking.prior**2] * 3 + [tracking.prior_speed**2] * 3
    one += [tracking.prior_clock**2, rate**2, tracking.radiation**2]
    return np.diag(np.concatenate([np.tile(one, satellites), considered]))


def _common(p: Array, r: Array) -> tuple[Array, float]:
    """One sigma of the turn that fits all position errors best, (3,), and of the mean clock.

    ``d_i = w x r_i + rest``: ``w = (sum X_i'X_i)^-1 sum X_i' d_i`` with ``X_i w = w x r_i``.
    """
    n = len(r)
    cross = np.zeros((n, 3, 3))
    cross[:, 0, 1], cross[:, 0, 2] = r[:, 2], -r[:, 1]
    cross[:, 1, 0], cross[:, 1, 2] = -r[:, 2], r[:, 0]
    cross[:, 2, 0], cross[:, 2, 1] = r[:, 1], -r[:, 0]
    x = cross.reshape(3 * n, 3)
    fit = np.linalg.pinv(x)
    places = (STATES * np.arange(n)[:, None] + np.arange(3)).ravel()
    turn = np.sqrt(np.maximum(np.diag(fit @ p[np.ix_(places, places)] @ fit.T), 0.0))
    clocks = STATES * np.arange(n) + 6
    return turn, float(np.sqrt(max(p[np.ix_(clocks, clocks)].mean(), 0.0)))


def _check_memory(satellites: int, steps: int, tracking: Tracking) -> None:
    """Refuse an arc whose transitions and rows do not fit."""
    pairs = satellites * (satellites - 1) / 2 if tracking.crosslinks else 0
    needed = 8.0 * steps * (satellites * 1500 + pairs * 150)
    if needed > LARGEST:
        raise ArgumentError(
            f"tracking: {satellites} satellites over {steps} steps would take "
            f"{needed / 1e9:.3g} GB; allowed 4; take a shorter arc (days) or longer steps (step_s)"
        )


@lru_cache(maxsize=8)
def with_determined_signal(design: Design) -> Design:
    """Return a design whose signal is known: the one that tracking implies, where it leaves it so.

    Worked out once for each design that is asked for, as `compass.determine` does.

    Raises
    ------
    ArgumentError
        Nobody tracks, or nothing measures the satellites' clocks.
    """
    if design.signal is None or not design.signal.determined or design.signal.covariance:
        return design
    update = design.signal.update
    determination = determine_orbits(design, prediction=update)
    check_clocks_measured(determination.tracking)
    return replace(
        design, signal=replace(implied_signal(determination, design, update), determined=True)
    )


def check_clocks_measured(tracking: Tracking) -> None:
    """Refuse a signal for users where nothing compares clocks: their ranges would mean nothing."""
    if not tracking.measures_clocks:
        raise ArgumentError(
            "tracking: no [signal] follows, for nothing measures the clocks; add time_m to a "
            "tracker, or one_way to stations"
        )


def implied_signal(determination: Determination, design: Design, update: float) -> Signal:
    """Signal that a determination implies: covariance at the arc's end, growth behind it.

    The covariance is the mean over satellites and the last revolution of the arc, so that it does
    not depend on where on their orbits the arc ends; growth is the least-squares slope of the rms
    sigmas over the prediction. Errors that satellites share are in it and not named apart.

    Parameters
    ----------
    determination
        With a prediction behind the arc, for the growth.
    design
        Its clock, receiver and ionosphere are kept.
    update
        Seconds between uploads.
    """
    turn = 2.0 * np.pi / float(design.constellation.mean_motion.min())
    recent = (determination.times <= determination.arc + 1e-6) & (
        determination.times >= determination.arc - turn
    )
    mean = determination.covariance[recent].mean(axis=(0, 1))
    behind = determination.times >= determination.arc - 1e-6
    slope = np.zeros(3)
    if behind.sum() > 1:
        slope = np.maximum(
            np.polyfit(determination.times[behind], determination.rms[behind, :3], 1)[0], 0.0
        )
    a, b, c = slope * HOUR
    base = design.signal or Signal(receiver=Receiver(0.5, 0.5))
    symmetric = 0.5 * (mean + mean.T)
    return replace(
        base,
        ephemeris=(0.0, 0.0, 0.0),
        clock_sigma=0.0,
        determined=False,
        covariance=(tuple(tuple(float(x) for x in row) for row in symmetric),),
        # rounded as metres an hour are, which files hold: what is written reads as the same
        ephemeris_rate=(float(a) / HOUR, float(b) / HOUR, float(c) / HOUR),
        update=update,
    )

"""Entries flown by guidance: a bank angle that brings the vehicle over a target, again and again.

A numerical predictor-corrector: at every cycle the rest of the entry is flown in the world as it is
known, by the same rates as everything else here, and the one unknown, the size of the bank, is
found for which the distance flown is that to the target (survey: D'Souza and Sarigul-Klijn 2014,
Progress in Aerospace Sciences 68:64). Its side changes when the heading is off the target by more
than a dead band (Tu, Munir, Mease and Bayard 2000, J. Guidance 23:620). Before the air is felt a
bank is held; at low speed the vehicle only turns its heading to the target. The prediction flies
reversals and that last turn too, or it would be kilometres off.

What guidance knows of its state is what a filter tells it that flies along, hears what is measured
of the true state, and is moved by the bank that was commanded: errors of the filter turn the
vehicle, and so change what it measures next. Drag alone it feels as it is. Deployment, too, is when
the filter believes it to be.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.dop853 import WATCH_RADIUS, WATCH_SPEED, watched
from compass.core.entry.filter import Problem
from compass.core.entry.flow import advance, rk4_step
from compass.core.entry.kinds import ROOTED
from compass.core.entry.measure import AIR, added, ideal_values
from compass.core.entry.measure import LIFT as OF_LIFT
from compass.core.entry.measure import PLACES as BLOCKS
from compass.core.entry.predict import move
from compass.core.entry.rates import DRAG, LIFT, log_density, through_air
from compass.core.entry.root import root_of, square_of
from compass.core.entry.runs import normalised_square
from compass.core.entry.update import update
from compass.core.jit import kernel

Array = NDArray[np.float64]


class Until(NamedTuple):
    """When a flight ends: `seconds` at the latest, flown in steps of `longest` seconds at most.

    Or when what is watched falls to a level (see `compass.core.entry.dop853.watched`), or the
    distance from the centre below `ground`, m.
    """

    seconds: float
    longest: float
    watch: int
    level: float
    ground: float


class Carried(NamedTuple):
    """The filter that a guided lander carries, see `compass.core.entry.filter.filter_run`.

    Its problem is that of the planned flight. Without epochs there is none, and guidance knows the
    true state.
    """

    problem: Problem
    covariance: Array
    iterations: int
    method: int


#: Places in ``g``: unit vector to the target; least and most bank; its rate; drag from which on
#: distance is controlled, m/s^2; bank before; dead band of the heading; speed below which the
#: heading alone is; s a cycle. Radians.
TARGET, LEAST, MOST, RATE, FELT, BEFORE, BAND, ALIGN, CYCLE, PLACES = 0, 3, 4, 5, 6, 7, 8, 9, 10, 11

#: Longest step of a prediction, s; most trials of a bank a cycle, and the miss that is near
#: enough, rad (60 m on the ground).
STRIDE, TRIALS, NEAR = 2.0, 7, 2e-5

#: Bank a radian of heading in the last turn, and the share of a new ratio of drag that is believed.
TURN, BELIEF = 20.0, 0.2


@kernel
def drag_of(x, thicker, p):
    """``rho B V^2 / 2``, V through the air, m/s^2."""
    w = through_air(x, p)
    height, _ = log_density(math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), p)
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    return 0.5 * math.exp(height + thicker) * p[DRAG] * square


@kernel
def heading_error(x, g):
    """Angle from the direction of flight to that of the target, clockwise, radians.

    Both seen from above: their parts across the vertical.
    """
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    ux, uy, uz = x[0] / r, x[1] / r, x[2] / r
    climb = ux * x[3] + uy * x[4] + uz * x[5]
    ax, ay, az = x[3] - climb * ux, x[4] - climb * uy, x[5] - climb * uz
    bx, by, bz = g[0], g[1], g[2]
    level = ax * bx + ay * by + az * bz
    side = (ay * bz - az * by) * ux + (az * bx - ax * bz) * uy + (ax * by - ay * bx) * uz
    return math.atan2(-side, level)


@kernel
def beyond(x, end, g):
    """How far a place is past the target along the way there from `x`, rad; short is negative."""
    u, w, n = np.empty(3), np.empty(3), np.empty(3)
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    s = math.sqrt(end[0] * end[0] + end[1] * end[1] + end[2] * end[2])
    for i in range(3):
        u[i], w[i] = x[i] / r, end[i] / s
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        n[i] = u[j] * g[k] - u[k] * g[j]
    to_target = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    flown, along = 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        flown += (u[j] * w[k] - u[k] * w[j]) * n[i] / max(to_target, 1e-12)
        along += u[i] * w[i]
    way = math.atan2(to_target, u[0] * g[0] + u[1] * g[1] + u[2] * g[2])
    return math.atan2(flown, along) - way


@kernel
def sided(x, size, side, g):
    """Bank of a size and a side (1 or -1), or that of the last turn, and the side from now on."""
    off = heading_error(x, g)
    if side * off < -g[BAND]:
        side = -side
    if watched(x, WATCH_SPEED, g) < g[ALIGN]:
        return max(-g[MOST], min(g[MOST], TURN * off)), side
    return side * size, side


@kernel
def turned(bank, wish, most):
    """Bank after a turn towards `wish` of at most `most` radians."""
    return bank + max(-most, min(most, wish - bank))


@kernel
def predicted(x, thicker, lift, p, g, bank, size, side, seconds, until, end):
    """Fly on with a bank of one size until the event; write where to, and return `beyond`."""
    here, watch, level = x.copy(), until.watch, until.level
    for _ in range(int(seconds / STRIDE) + 1):
        wish, side = sided(here, size, side, g)
        after = turned(bank, wish, g[RATE] * STRIDE)
        angle = 0.5 * (bank + after)
        bank = after
        rk4_step(here, thicker, lift, p, math.cos(angle), math.sin(angle), STRIDE, end)
        before, now = watched(here, watch, p) - level, watched(end, watch, p) - level
        if now <= 0.0 or not watched(end, WATCH_RADIUS, p) > until.ground:
            share = before / (before - now) if now < before else 1.0
            for i in range(6):
                end[i] = here[i] + min(1.0, max(0.0, share)) * (end[i] - here[i])
            break
        here[:] = end
    return beyond(x, end, g)


@kernel
def found_bank(x, thicker, lift, p, g, bank, side, seconds, until):
    """Size of the bank that flies as far as the target: regula falsi (Illinois) on `predicted`.

    More bank flies less far; where no bank in the limits flies so far, or so short, the limit. And
    how far past the target that comes, rad: short is negative, 0 where the target is in reach.
    """
    end = np.empty(6)
    low, high = g[LEAST], g[MOST]
    far = predicted(x, thicker, lift, p, g, bank, low, side, seconds, until, end)
    if far <= 0.0:
        return low, far
    near = predicted(x, thicker, lift, p, g, bank, high, side, seconds, until, end)
    if near >= 0.0:
        return high, near
    middle = low
    for _ in range(TRIALS):
        middle = low + far / (far - near) * (high - low)
        off = predicted(x, thicker, lift, p, g, bank, middle, side, seconds, until, end)
        if abs(off) < NEAR:
            break
        if off > 0.0:
            low, far, near = middle, off, 0.5 * near
        else:
            high, near, far = middle, off, 0.5 * far
    return middle, 0.0


@kernel
def crossing(x, thicker, lift, p, angle, step, until, out):
    """Part of a step after which the watched quantity is at the level, by bisection."""
    low, high, c, s = 0.0, step, math.cos(angle), math.sin(angle)
    for _ in range(50):
        middle = 0.5 * (low + high)
        rk4_step(x, thicker, lift, p, c, s, middle, out)
        if watched(out, until.watch, p) > until.level:
            low = middle
        else:
            high = middle
    rk4_step(x, thicker, lift, p, c, s, high, out)
    return high


@kernel
def hear(x, thicker, lift, p, known, angle, carried, k, draws, state, covariance, told):
    """Let the filter hear what is measured of the true state at epoch k, with a bank held there.

    `told` (7,) gets the error of its position and velocity, and that error squared, normalised.
    """
    problem = carried.problem
    z = np.empty((1, problem.sources.shape[1], problem.kinds.size))
    true, blocks, bank = np.empty((1, 8)), np.full(BLOCKS, -1), np.zeros((1, 2))
    true[0, :6], true[0, 6], true[0, 7] = x, thicker, lift - p[LIFT]
    blocks[AIR], blocks[OF_LIFT], bank[0, 1] = 6, 7, angle
    ideal_values(
        true, problem.sources[k : k + 1], problem.kinds, blocks, p, bank, np.zeros(1), z
    )  # fmt: skip
    for b in range(z.shape[1]):
        for c in range(z.shape[2]):
            z[0, b, c] += math.sqrt(problem.variances[k, b, c]) * draws[b, c]
    held = Problem(
        known, bank, problem.times, problem.longest, problem.noise, problem.walk, problem.fade,
        problem.sources, problem.variances, problem.kinds, problem.places,
    )  # fmt: skip
    update(state, covariance, state, held, k, z[0], carried.iterations, carried.method)
    for i in range(6):
        told[i] = state[i] - x[i]
    whole = covariance
    if carried.method == ROOTED:
        whole = np.empty(covariance.shape)
        square_of(covariance, whole)
    told[6] = normalised_square(whole[:6, :6], told[:6])


@kernel
def follow(carried, k, time, stop, known, angle, longest, state, covariance):
    """Move the filter by the bank that is flown; at epoch k with what noise has gathered by then.

    A filter that looks back moves on as a plain one here.
    """
    problem = carried.problem
    noise, walk = np.zeros((2, problem.noise.shape[1], 6)), np.zeros((2, state.size))
    fade, bank = np.ones(2), np.empty((1, 2))
    if k < problem.times.size and stop == problem.times[k]:
        noise[1], walk[1], fade[1] = problem.noise[k], problem.walk[k], problem.fade[k]
    bank[0, 0], bank[0, 1] = time, angle
    step = Problem(
        known, bank, np.array([time, stop]), longest, noise, walk, fade, problem.sources,
        problem.variances, problem.kinds, problem.places,
    )  # fmt: skip
    move(state, covariance, state, step, 1, carried.method, np.empty(covariance.shape))


@kernel
def guided_flight(
    start, thicker, lift, p, known, g, until, carried, first, draws, banks, end, told
):  # fmt: skip
    """Fly one guided entry to an event.

    Parameters
    ----------
    start
        State, (6,).
    thicker, lift, p
        The world as it is; see `compass.core.entry.rates.acceleration`.
    known
        The world as it is known to the guidance, which corrects its density by the drag felt.
    g, until
        See `TARGET` and `Until`.
    carried, first, draws
        The filter, its first estimate (s,), and normal draws of its noise, (t, n, c); `first` has
        no element if there is none.
    banks
        Output, (k, 2): times and the bank that holds from each on, a row where it changes, as far
        as there is room.
    end
        Output, (6,): state at the event.
    told
        Output, (8,): error of what guidance knew, and its normalised square, when it last heard;
        and what `found_bank` told last of how far the target is beyond reach, rad.

    Returns
    -------
    time, rows
        Of the event, nan if it does not come; how many rows of `banks` were written.
    """
    x, seen, time, rows, side = start.copy(), start.copy(), 0.0, 0, 1.0
    state, covariance, k = first.copy(), carried.covariance.copy(), 0
    heard, places = carried.problem.times, carried.problem.places
    blind = heard.size == 0
    if carried.method == ROOTED:
        root_of(carried.covariance, covariance)
    bank, ratio, decision = g[BEFORE], 0.0, 0.0
    step = g[CYCLE] / max(1, math.ceil(g[CYCLE] / until.longest - 1e-9))
    told[:] = 0.0
    if not blind:
        seen[:] = state[:6]
    if heading_error(seen, g) < 0.0:
        side, bank = -1.0, -bank
    size, wish = g[BEFORE], bank
    while time < until.seconds - 1e-9:
        if k < heard.size and time >= heard[k]:
            hear(x, thicker, lift, p, known, bank, carried, k, draws[k], state, covariance, told)
            seen[:] = state[:6]
            k += 1
        if time >= decision - 1e-9:
            decision += g[CYCLE]
            felt = drag_of(x, thicker, p)
            if felt > g[FELT]:
                ratio += BELIEF * (math.log(felt / drag_of(seen, 0.0, known)) - ratio)
                if watched(seen, WATCH_SPEED, known) > g[ALIGN]:
                    lift_known = known[LIFT] + added(state, places[OF_LIFT])
                    size, told[7] = found_bank(
                        seen, ratio, lift_known, known, g, bank, side, until.seconds - time, until
                    )
                wish, side = sided(seen, size, side, g)
            else:
                wish = side * g[BEFORE]
        stop = min(decision, time + step)
        if k < heard.size:
            stop = min(stop, heard[k])
        after = turned(bank, wish, g[RATE] * (stop - time))
        angle = 0.5 * (bank + after)
        bank = after
        if rows < banks.shape[0] and (rows == 0 or banks[rows - 1, 1] != angle):
            banks[rows, 0], banks[rows, 1] = time, angle
            rows += 1
        rk4_step(x, thicker, lift, p, math.cos(angle), math.sin(angle), stop - time, end)
        if blind:
            if watched(end, until.watch, p) <= until.level:
                return time + crossing(x, thicker, lift, p, angle, stop - time, until, end), rows
            seen[:] = end
        else:
            air, steeper = added(state, places[AIR]), added(state, places[OF_LIFT])
            follow(carried, k, time, stop, known, angle, until.longest, state, covariance)
            if watched(state, until.watch, known) <= until.level:
                part = crossing(
                    seen, air, known[LIFT] + steeper, known, angle, stop - time, until, state[:6]
                )
                rk4_step(x, thicker, lift, p, math.cos(angle), math.sin(angle), part, end)
                return time + part, rows
            seen[:] = state[:6]
        if not watched(end, WATCH_RADIUS, p) > until.ground:
            return np.nan, rows
        x[:] = end
        time = stop
    return np.nan, rows


@kernel
def guided_banks(starts, worlds, targets, p, known, g, until, carried, banks, rows, ends, beyond):
    """Write the bank that each of many entries flies to a target of its own.

    Parameters
    ----------
    starts, worlds, p, known, g, until, carried
        As in `dispersed_flights`; nothing is carried, guidance knows the true state.
    targets
        Unit vectors, (m, 3), in place of that of `g`.
    banks, rows
        Outputs: `banks` of `guided_flight`, (m, k, 2), and how many rows of each are written, (m,).
    ends, beyond
        Outputs: states at the event, (m, 6), and how far targets are beyond reach, rad, (m,).
    """
    own, told = g.copy(), np.empty(8)
    nothing, unheard = np.empty(0), np.empty((0, 0, 0))
    for m in range(starts.shape[0]):
        own[TARGET : TARGET + 3] = targets[m]
        _, rows[m] = guided_flight(
            starts[m], worlds[m, 0], p[LIFT] + worlds[m, 1], p, known, own, until, carried, nothing,
            unheard, banks[m], ends[m], told,
        )  # fmt: skip
        beyond[m] = told[7]


@kernel
def plain_flight(start, thicker, lift, p, bank, until, end):
    """Fly one entry by a schedule of bank angles to an event; its time, nan if it does not come."""
    x, time, longest = start.copy(), 0.0, until.longest
    while time < until.seconds - 1e-9:
        step = min(longest, until.seconds - time)
        advance(x, thicker, lift, p, bank, time, time + step, longest, end)
        if watched(end, until.watch, p) <= until.level:
            low, high = 0.0, step
            for _ in range(50):
                middle = 0.5 * (low + high)
                advance(x, thicker, lift, p, bank, time, time + middle, longest, end)
                if watched(end, until.watch, p) > until.level:
                    low = middle
                else:
                    high = middle
            return time + high
        if not watched(end, WATCH_RADIUS, p) > until.ground:
            return np.nan
        x[:] = end
        time += step
    return np.nan


@kernel
def dispersed_flights(
    starts, worlds, p, known, g, bank, until, carried, firsts, draws, times, ends, told
):  # fmt: skip
    """Fly many entries, guided if `g` (see `TARGET`) is not empty, else by `bank`.

    Parameters
    ----------
    starts
        States, (m, 6).
    worlds
        What is added to the logarithm of the density and to L/D of each, (m, 2).
    p, known, g, bank, until, carried, firsts, draws
        As in `guided_flight` and `plain_flight`, `firsts` (m, s) and `draws` (m, t, n, c).
    times, ends, told
        Outputs: of the event, (m,), nan where it does not come, the state there, (m, 6), and of
        guided ones what `guided_flight` tells, (m, 8).
    """
    unwritten = np.empty((0, 2))
    for m in range(starts.shape[0]):
        thicker, lift = worlds[m, 0], p[LIFT] + worlds[m, 1]
        if g.size > 0:
            times[m], _ = guided_flight(
                starts[m], thicker, lift, p, known, g, until, carried, firsts[m], draws[m],
                unwritten, ends[m], told[m],
            )  # fmt: skip
        else:
            times[m] = plain_flight(starts[m], thicker, lift, p, bank, until, ends[m])

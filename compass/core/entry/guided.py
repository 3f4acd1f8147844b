"""Entries flown by guidance, with a filter that guides them or knowing the true state.

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
from compass.core.entry.guide import (
    ALIGN,
    BEFORE,
    BELIEF,
    CYCLE,
    FELT,
    RATE,
    TARGET,
    drag_of,
    found_bank,
    heading_error,
    sided,
    turned,
)
from compass.core.entry.kinds import ROOTED
from compass.core.entry.measure import AIR, added, ideal_values
from compass.core.entry.measure import LIFT as OF_LIFT
from compass.core.entry.measure import PLACES as BLOCKS
from compass.core.entry.predict import move
from compass.core.entry.rates import LIFT
from compass.core.entry.root import root_of, square_of
from compass.core.entry.runs import normalised_square
from compass.core.entry.update import update
from compass.core.jit import kernel

Array = NDArray[np.float64]


class Carried(NamedTuple):
    """The filter that a guided lander carries, see `compass.core.entry.filter.filter_run`.

    Its problem is that of the planned flight. Without epochs there is none, and guidance knows the
    true state.
    """

    problem: Problem
    covariance: Array
    iterations: int
    method: int


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
        See `compass.core.entry.guide.TARGET` and `Until`.
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
    """Fly many entries, guided if `g` is not empty, else by `bank`.

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

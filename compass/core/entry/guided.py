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
from compass.core.entry.flow import advance
from compass.core.entry.groups import Problem, in_world
from compass.core.entry.guide import (
    ALIGN,
    BEFORE,
    BELIEF,
    CYCLE,
    FELT,
    RATE,
    drag_of,
    found_bank,
    heading_error,
    sided,
    turned,
)
from compass.core.entry.kinds import ROOTED
from compass.core.entry.measure import AIR, PLACES, added, ideal_values, world_of
from compass.core.entry.measure import LIFT as OF_LIFT
from compass.core.entry.predict import move
from compass.core.entry.rates import LIFT, World
from compass.core.entry.root import root_of, square_of
from compass.core.entry.runs import normalised_square
from compass.core.entry.update import update
from compass.core.jit import kernel

Array = NDArray[np.float64]


class Carried(NamedTuple):
    """The filter that guided landers carry, see `compass.core.entry.filter.filter_run`.

    Its problem is that of the planned flight. Without epochs there is none, and guidance knows the
    true state. `firsts` (m, s) are each lander's first estimate, `draws` (m, t, n, c) normal
    draws of its noise.
    """

    problem: Problem
    covariance: Array
    iterations: int
    method: int
    firsts: Array
    draws: Array


class Flown(NamedTuple):
    """What became of m entries.

    `times` (m,) of the event, nan where it does not come, and `ends` (m, 6), the state there.
    `banks` (m, k, 2): times and the bank that holds from each on, a row where it changes, as far as
    there is room; `rows` (m,): how many are written. `told` (m, 8): error of what guidance knew,
    and its normalised square, when it last heard; and what `found_bank` told last of how far the
    target is beyond reach, rad.
    """

    times: Array
    ends: Array
    banks: Array
    rows: NDArray[np.int64]
    told: Array


@kernel
def crossing(x, world, bank, start, stop, until, out):
    """Time between two at which what is watched comes to the level, by bisection; `out` there."""
    low, high = start, stop
    for _ in range(50):
        middle = 0.5 * (low + high)
        advance(x, world, bank, start, middle, until.longest, out)
        if watched(out, until.watch, world.p) > until.level:
            low = middle
        else:
            high = middle
    advance(x, world, bank, start, high, until.longest, out)
    return high


@kernel
def hear(x, world, known, bank, carried, k, draws, state, covariance, told):
    """Let the filter hear what is measured of the true state at epoch k, with a bank held there.

    `told` (7,) gets the error of its position and velocity, and that error squared, normalised.
    """
    problem = carried.problem
    z = np.empty((1, problem.sources.shape[1], problem.kinds.size))
    true, blocks = np.empty((1, 8)), np.full(PLACES, -1)
    true[0, :6], true[0, 6], true[0, 7] = x, world.thicker, world.lift - world.p[LIFT]
    blocks[AIR], blocks[OF_LIFT] = 6, 7
    ideal_values(
        true, problem.sources[k : k + 1], problem.kinds, blocks, world.p, bank, problem.times[k:], z
    )  # fmt: skip
    variances = problem.variances[k]
    for b in range(z.shape[1]):
        for c in range(z.shape[2]):
            z[0, b, c] += math.sqrt(variances[b, c]) * draws[b, c]
    held = in_world(problem, known, bank)
    update(
        state, covariance, state, held, k, z[0], variances, carried.iterations, carried.method
    )  # fmt: skip
    for i in range(6):
        told[i] = state[i] - x[i]
    whole = covariance
    if carried.method == ROOTED:
        whole = np.empty(covariance.shape)
        square_of(covariance, whole)
    told[6] = normalised_square(whole[:6, :6], told[:6])


@kernel
def follow(carried, k, time, stop, known, bank, longest, state, covariance):
    """Move the filter by the bank that is flown; at epoch k with what noise has gathered by then.

    A filter that looks back moves on as a plain one here.
    """
    problem = carried.problem
    noise, walk = np.zeros((2, problem.noise.shape[1], 6)), np.zeros((2, state.size))
    fade = np.ones(2)
    if k < problem.times.size and stop == problem.times[k]:
        noise[1], walk[1], fade[1] = problem.noise[k], problem.walk[k], problem.fade[k]
    step = Problem(
        known, bank, np.array([time, stop]), longest, noise, walk, fade, problem.sources,
        problem.variances, problem.kinds, problem.places,
    )  # fmt: skip
    move(state, covariance, state, step, 1, carried.method, np.empty(covariance.shape))


@kernel
def guided_flight(start, world, known, g, until, carried, m, flown):
    """Fly one guided entry to an event.

    Parameters
    ----------
    start
        State, (6,).
    world
        As it is; see `compass.core.entry.rates.World`.
    known
        Parameters of it as they are known to the guidance, which corrects its density by the drag
        felt.
    g, until
        See `compass.core.entry.guide.TARGET` and `Until`.
    carried
        Its filter.
    m, flown
        Which entry, and where to write what becomes of it: a `Flown`.
    """
    x, seen, time, rows, side = start.copy(), start.copy(), 0.0, 0, 1.0
    banks, end, told = flown.banks[m], flown.ends[m], flown.told[m]
    state, covariance, k = carried.firsts[m].copy(), carried.covariance.copy(), 0
    heard, places = carried.problem.times, carried.problem.places
    blind = heard.size == 0
    if carried.method == ROOTED:
        root_of(carried.covariance, covariance)
    bank, ratio, decision = g[BEFORE], 0.0, 0.0
    step = g[CYCLE] / max(1, math.ceil(g[CYCLE] / until.longest - 1e-9))
    told[:] = 0.0
    flown.times[m] = np.nan
    if not blind:
        seen[:] = state[:6]
    if heading_error(seen, g) < 0.0:
        side, bank = -1.0, -bank
    size, wish = g[BEFORE], bank
    while time < until.seconds - 1e-9:
        held = np.array([[time, bank]])
        if k < heard.size and time >= heard[k]:
            hear(
                x, world, known, held, carried, k, carried.draws[m, k], state, covariance, told
            )  # fmt: skip
            seen[:] = state[:6]
            k += 1
        if time >= decision - 1e-9:
            decision += g[CYCLE]
            felt = drag_of(x, world)
            if felt > g[FELT]:
                ratio += BELIEF * (math.log(felt / drag_of(seen, World(known, 0.0, 0.0))) - ratio)
                if watched(seen, WATCH_SPEED, known) > g[ALIGN]:
                    believed = World(known, ratio, known[LIFT] + added(state, places[OF_LIFT]))
                    size, told[7] = found_bank(
                        seen, believed, g, bank, side, until.seconds - time, until
                    )
                wish, side = sided(seen, size, side, g)
            else:
                wish = side * g[BEFORE]
        stop = min(decision, time + step)
        if k < heard.size:
            stop = min(stop, heard[k])
        after = turned(bank, wish, g[RATE] * (stop - time))
        held[0, 1] = 0.5 * (bank + after)
        bank = after
        if rows < banks.shape[0] and (rows == 0 or banks[rows - 1, 1] != held[0, 1]):
            banks[rows] = held[0]
            rows += 1
            flown.rows[m] = rows
        advance(x, world, held, time, stop, until.longest, end)
        if blind:
            if watched(end, until.watch, world.p) <= until.level:
                flown.times[m] = crossing(x, world, held, time, stop, until, end)
                return
            seen[:] = end
        else:
            believed = world_of(known, state, places)
            follow(carried, k, time, stop, known, held, until.longest, state, covariance)
            if watched(state, until.watch, known) <= until.level:
                event = crossing(seen, believed, held, time, stop, until, state[:6])
                advance(x, world, held, time, event, until.longest, end)
                flown.times[m] = event
                return
            seen[:] = state[:6]
        if not watched(end, WATCH_RADIUS, world.p) > until.ground:
            return
        x[:] = end
        time = stop


@kernel
def plain_flight(start, world, bank, until, m, flown):
    """Fly one entry by a schedule of bank angles to an event."""
    x, time, end = start.copy(), 0.0, flown.ends[m]
    flown.times[m] = np.nan
    while time < until.seconds - 1e-9:
        stop = time + min(until.longest, until.seconds - time)
        advance(x, world, bank, time, stop, until.longest, end)
        if watched(end, until.watch, world.p) <= until.level:
            flown.times[m] = crossing(x, world, bank, time, stop, until, end)
            return
        if not watched(end, WATCH_RADIUS, world.p) > until.ground:
            return
        x[:] = end
        time = stop


@kernel
def dispersed_flights(starts, worlds, p, known, g, bank, until, carried, flown):
    """Fly many entries, guided if `g` has columns, else by `bank`.

    Parameters
    ----------
    starts
        States, (m, 6).
    worlds
        What is added to the logarithm of the density and to L/D of each, (m, 2).
    p, known, bank, until, carried, flown
        As in `guided_flight` and `plain_flight`.
    g
        Of each entry, (m, k); see `compass.core.entry.guide.TARGET`.
    """
    for m in range(starts.shape[0]):
        world = World(p, worlds[m, 0], p[LIFT] + worlds[m, 1])
        if g.shape[1] > 0:
            guided_flight(starts[m], world, known, g[m], until, carried, m, flown)
        else:
            plain_flight(starts[m], world, bank, until, m, flown)

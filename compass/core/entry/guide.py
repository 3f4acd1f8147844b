"""Entries flown by guidance: a bank angle that brings the vehicle over a target, again and again.

A numerical predictor-corrector: at every cycle the rest of the entry is flown in the world as it is
known, by the same rates as everything else here, and the one unknown, the size of the bank, is
found for which the distance flown is that to the target (survey: D'Souza and Sarigul-Klijn 2014,
Progress in Aerospace Sciences 68:64). Its side changes when the heading is off the target by more
than a dead band (Tu, Munir, Mease and Bayard 2000, J. Guidance 23:620). Before the air is felt a
bank is held; at low speed the vehicle only turns its heading to the target. The prediction flies
reversals and that last turn too, or it would be kilometres off.
"""

import math

import numpy as np

from compass.core.entry.dop853 import WATCH_RADIUS, WATCH_SPEED, watched
from compass.core.entry.flow import advance, rk4_step
from compass.core.entry.rates import DRAG, LIFT, log_density, through_air
from compass.core.jit import kernel

#: Places in ``g``: unit vector to the target; least and most bank; its rate; drag from which on
#: distance is controlled, m/s^2; bank before; dead band of the heading; speed below which the
#: heading alone is; s a cycle. Radians.
TARGET, LEAST, MOST, RATE, FELT, BEFORE, BAND, ALIGN, CYCLE, PLACES = 0, 3, 4, 5, 6, 7, 8, 9, 10, 11

#: Longest step of a prediction, s; most trials of a bank a cycle, and the miss that is near
#: enough, rad (60 m on the ground).
STRIDE, TRIALS, NEAR = 2.0, 7, 2e-5

#: Bank a radian of heading in the last turn, and the share of a new ratio of drag that is believed.
TURN, BELIEF = 3.0, 0.2


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
def predicted(x, thicker, lift, p, g, bank, size, side, seconds, watch, level, ground, end):
    """Fly on with a bank of one size until the event; write where to, and return `beyond`."""
    here = x.copy()
    for _ in range(int(seconds / STRIDE) + 1):
        wish, side = sided(here, size, side, g)
        after = turned(bank, wish, g[RATE] * STRIDE)
        angle = 0.5 * (bank + after)
        bank = after
        rk4_step(here, thicker, lift, p, math.cos(angle), math.sin(angle), STRIDE, end)
        before, now = watched(here, watch, p) - level, watched(end, watch, p) - level
        if now <= 0.0 or not watched(end, WATCH_RADIUS, p) > ground:
            share = before / (before - now) if now < before else 1.0
            for i in range(6):
                end[i] = here[i] + min(1.0, max(0.0, share)) * (end[i] - here[i])
            break
        here[:] = end
    return beyond(x, end, g)


@kernel
def found_bank(x, thicker, lift, p, g, bank, side, seconds, watch, level, ground):
    """Size of the bank that flies as far as the target: regula falsi (Illinois) on `predicted`.

    More bank flies less far; where no bank in the limits flies so far, or so short, the limit.
    """
    end = np.empty(6)
    low, high = g[LEAST], g[MOST]
    far = predicted(x, thicker, lift, p, g, bank, low, side, seconds, watch, level, ground, end)
    if far <= 0.0:
        return low
    near = predicted(x, thicker, lift, p, g, bank, high, side, seconds, watch, level, ground, end)
    if near >= 0.0:
        return high
    middle = low
    for _ in range(TRIALS):
        middle = low + far / (far - near) * (high - low)
        off = predicted(
            x, thicker, lift, p, g, bank, middle, side, seconds, watch, level, ground, end
        )
        if abs(off) < NEAR:
            break
        if off > 0.0:
            low, far, near = middle, off, 0.5 * near
        else:
            high, near, far = middle, off, 0.5 * far
    return middle


@kernel
def crossing(x, thicker, lift, p, angle, step, watch, level, out):
    """Part of a step after which the watched quantity is at the level, by bisection."""
    low, high, c, s = 0.0, step, math.cos(angle), math.sin(angle)
    for _ in range(50):
        middle = 0.5 * (low + high)
        rk4_step(x, thicker, lift, p, c, s, middle, out)
        if watched(out, watch, p) > level:
            low = middle
        else:
            high = middle
    rk4_step(x, thicker, lift, p, c, s, high, out)
    return high


@kernel
def guided_flight(
    start, thicker, lift, p, known, g, seconds, longest, watch, level, ground, banks, end
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
    g
        See `TARGET`.
    seconds, longest
        When the flight ends at the latest, and its longest step, s.
    watch, level, ground
        The event, see `compass.core.entry.dop853.watched`, and the radius of the ground, m.
    banks
        Output, (k, 2): times and the bank that holds from each on.
    end
        Output, (6,): state at the event.

    Returns
    -------
    time, rows
        Of the event, nan if it does not come; how many rows of `banks` are written.
    """
    x, time, rows, side = start.copy(), 0.0, 0, 1.0
    bank, ratio = g[BEFORE], 0.0
    steps = max(1, math.ceil(g[CYCLE] / longest - 1e-9))
    step = g[CYCLE] / steps
    if heading_error(x, g) < 0.0:
        side, bank = -1.0, -bank
    size = g[BEFORE]
    while time < seconds - 1e-9:
        felt = drag_of(x, thicker, p)
        if felt > g[FELT]:
            seen = math.log(felt / drag_of(x, 0.0, known))
            ratio += BELIEF * (seen - ratio)
            if watched(x, WATCH_SPEED, p) > g[ALIGN]:
                size = found_bank(
                    x, ratio, known[LIFT], known, g, bank, side, seconds - time, watch, level,
                    ground,
                )  # fmt: skip
            wish, side = sided(x, size, side, g)
        else:
            wish = side * g[BEFORE]
        for _ in range(steps):
            after = turned(bank, wish, g[RATE] * step)
            angle = 0.5 * (bank + after)
            bank = after
            banks[rows, 0], banks[rows, 1] = time, angle
            rows += 1
            rk4_step(x, thicker, lift, p, math.cos(angle), math.sin(angle), step, end)
            if watched(end, watch, p) <= level:
                return time + crossing(x, thicker, lift, p, angle, step, watch, level, end), rows
            if not watched(end, WATCH_RADIUS, p) > ground:
                return np.nan, rows
            x[:] = end
            time += step
    return np.nan, rows


@kernel
def plain_flight(
    start, thicker, lift, p, bank, seconds, longest, watch, level, ground, end
):  # fmt: skip
    """Fly one entry by a schedule of bank angles to an event; its time, nan if it does not come."""
    x, time = start.copy(), 0.0
    while time < seconds - 1e-9:
        step = min(longest, seconds - time)
        advance(x, thicker, lift, p, bank, time, time + step, longest, end)
        if watched(end, watch, p) <= level:
            low, high = 0.0, step
            for _ in range(50):
                middle = 0.5 * (low + high)
                advance(x, thicker, lift, p, bank, time, time + middle, longest, end)
                if watched(end, watch, p) > level:
                    low = middle
                else:
                    high = middle
            return time + high
        if not watched(end, WATCH_RADIUS, p) > ground:
            return np.nan
        x[:] = end
        time += step
    return np.nan


@kernel
def dispersed_flights(
    starts, worlds, p, known, g, bank, seconds, longest, watch, level, ground, times, ends
):  # fmt: skip
    """Fly many entries, guided if `g` (see `TARGET`) is not empty, else by `bank`.

    Parameters
    ----------
    starts
        States, (m, 6).
    worlds
        What is added to the logarithm of the density and to L/D of each, (m, 2).
    p, known, g, bank, seconds, longest, watch, level, ground
        As in `guided_flight` and `plain_flight`.
    times, ends
        Outputs: of the event, (m,), nan where it does not come, and the state there, (m, 6).
    """
    rows = int(seconds / longest) + int(seconds) + 4
    banks = np.empty((rows, 2))
    for m in range(starts.shape[0]):
        thicker, lift = worlds[m, 0], p[LIFT] + worlds[m, 1]
        if g.size > 0:
            times[m], _ = guided_flight(
                starts[m], thicker, lift, p, known, g, seconds, longest, watch, level, ground,
                banks, ends[m],
            )  # fmt: skip
        else:
            times[m] = plain_flight(
                starts[m], thicker, lift, p, bank, seconds, longest, watch, level, ground, ends[m]
            )

"""The bank angle that brings an entering vehicle over a target, found again and again.

A numerical predictor-corrector: at every cycle the rest of the entry is flown in the world as it is
known, by the same rates as everything else here, and the one unknown, the size of the bank, is
found for which the distance flown is that to the target (survey: D'Souza and Sarigul-Klijn 2014,
Progress in Aerospace Sciences 68:64). Its side changes when the heading is off the target by more
than a dead band (Tu, Munir, Mease and Bayard 2000, J. Guidance 23:620). Before the air is felt a
bank is held; at low speed the vehicle only turns its heading to the target. The prediction flies
reversals and that last turn too, or it would be kilometres off.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.dop853 import WATCH_RADIUS, WATCH_SPEED, watched
from compass.core.entry.flow import rk4_step
from compass.core.entry.rates import DRAG, log_density, through_air
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
def drag_of(x, world):
    """``rho B V^2 / 2``, V through the air, m/s^2."""
    p, thicker, _ = world
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
def predicted(x, world, g, bank, size, side, seconds, until, end):
    """Fly on with a bank of one size until the event; write where to, and return `beyond`."""
    here, p, watch, level = x.copy(), world.p, until.watch, until.level
    for _ in range(int(seconds / STRIDE) + 1):
        wish, side = sided(here, size, side, g)
        after = turned(bank, wish, g[RATE] * STRIDE)
        angle = 0.5 * (bank + after)
        bank = after
        rk4_step(here, world, math.cos(angle), math.sin(angle), STRIDE, end)
        before, now = watched(here, watch, p) - level, watched(end, watch, p) - level
        if now <= 0.0 or not watched(end, WATCH_RADIUS, p) > until.ground:
            share = before / (before - now) if now < before else 1.0
            for i in range(6):
                end[i] = here[i] + min(1.0, max(0.0, share)) * (end[i] - here[i])
            break
        here[:] = end
    return beyond(x, end, g)


@kernel
def found_bank(x, world, g, bank, side, seconds, until):
    """Size of the bank that flies as far as the target: regula falsi (Illinois) on `predicted`.

    More bank flies less far; where no bank in the limits flies so far, or so short, the limit. And
    how far past the target that comes, rad: short is negative, 0 where the target is in reach.
    """
    end = np.empty(6)
    low, high = g[LEAST], g[MOST]
    far = predicted(x, world, g, bank, low, side, seconds, until, end)
    if far <= 0.0:
        return low, far
    near = predicted(x, world, g, bank, high, side, seconds, until, end)
    if near >= 0.0:
        return high, near
    middle = low
    for _ in range(TRIALS):
        middle = low + far / (far - near) * (high - low)
        off = predicted(x, world, g, bank, middle, side, seconds, until, end)
        if abs(off) < NEAR:
            break
        if off > 0.0:
            low, far, near = middle, off, 0.5 * near
        else:
            high, near, far = middle, off, 0.5 * far
    return middle, 0.0

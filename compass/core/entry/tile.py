"""Epochs of an entry worked through in tiles: satellites of a pattern as a lander sees them.

The satellites of a pattern share radius and phase x, and all turn against the Mars-fixed axes by
the same angle W. With ``P cos x + Q sin x`` in inertial axes, each is in Mars-fixed ones at

    (P1 a + Q1 b + P2 c + Q2 d,  P2 a + Q2 b - P1 c - Q1 d,  P3 e + Q3 f)

where ``a, b, c, d, e, f = cos W cos x, cos W sin x, sin W cos x, sin W sin x, cos x, sin x`` times
the radius are the same for all of them. So a satellite at an epoch costs some products and no
interpolation.

All that a tile needs lies in one flat array, part after part, a constant distance apart: so the
compiler knows that the parts do not overlap, and works on several epochs at once; and the tile
stays in the first caches.
"""

import math

from compass.core.jit import fast_kernel, inline_kernel, kernel

TILE = 128
A, B, C, D, E, F, PX, PY, PZ = (k * TILE for k in range(9))  # functions of time, the lander
TO_RATES = 9 * TILE  # from each of these to its rate
LIMIT, WEIGHT, WORK, COUNT = 18 * TILE, 19 * TILE, 20 * TILE, 26 * TILE
# blocks of M (`compass.core.entry.patterns`): position with itself, velocity with itself, both
PP, VV, PV, KNOWN = 27 * TILE, 33 * TILE, 39 * TILE, 48 * TILE
# of one satellite: what its measurements weigh, direction to the lander, one over the distance,
# row of its rate on position, and what its errors do to a range and to a rate, times the weight
SEEN, LINE, NEAR, BESIDE = 48 * TILE, 49 * TILE, 52 * TILE, 53 * TILE
TO_RANGE, TO_RATE = 56 * TILE, 60 * TILE
# sums over satellites of weighted rows, by which clocks are told: of ranges on position, of rates
# on position and on velocity, then the weights of both; what time it is, s since the entry began
RANGES, BESIDES, RATES, WEIGHTS, SECONDS = (k * TILE for k in (64, 67, 70, 73, 75))
COS, SIN, END = 76 * TILE, 77 * TILE, 78 * TILE  # of the angle W


@kernel
def tabulate(step, out):
    """Cosines and sines of 0, 1, 2 ... steps, shape (2, t)."""
    for t in range(out.shape[1]):
        out[0, t], out[1, t] = math.cos(step * t), math.sin(step * t)


@fast_kernel
def set_limits(tile, radius, sin_mask, cos_mask):
    """Square, with its sign, of distance from the centre times sine of the lowest elevation seen.

    See `compass.core.entry.information.horizon`; squares save a root a satellite.
    """
    for t in range(TILE):
        x, y, z = tile[PX + t], tile[PY + t], tile[PZ + t]
        squared = x * x + y * y + z * z
        near = min(radius * radius, squared)
        low = sin_mask * math.sqrt(near) - cos_mask * math.sqrt(squared - near)
        tile[LIMIT + t] = low * abs(low)


@fast_kernel
def set_basis(tile, clock, turn, phase, angle, radius, motion, omega):
    """Functions of time whose sums are the satellites' positions, then those of velocities."""
    ca, sa = math.cos(angle), math.sin(angle)
    cp, sp = radius * math.cos(phase), radius * math.sin(phase)
    for t in range(TILE):
        e, f = cp * clock[0, t] - sp * clock[1, t], sp * clock[0, t] + cp * clock[1, t]
        c, s = ca * turn[0, t] - sa * turn[1, t], sa * turn[0, t] + ca * turn[1, t]
        ce, cf, se, sf = c * e, c * f, s * e, s * f
        tile[A + t], tile[B + t], tile[C + t] = ce, cf, se
        tile[D + t], tile[E + t], tile[F + t] = sf, e, f
        tile[COS + t], tile[SIN + t] = c, s
        at = TO_RATES + t
        tile[A + at], tile[B + at] = -omega * se - motion * cf, motion * ce - omega * sf
        tile[C + at], tile[D + at] = omega * ce - motion * sf, omega * cf + motion * se
        tile[E + at], tile[F + at] = -motion * f, motion * e


@inline_kernel
def difference(tile, t, p1, p2, p3, q1, q2, q3):
    """Lander less satellite at an epoch: positions, or velocities with t `TO_RATES` more."""
    x = tile[PX + t] - p1 * tile[A + t] - q1 * tile[B + t] - p2 * tile[C + t] - q2 * tile[D + t]
    y = tile[PY + t] - p2 * tile[A + t] - q2 * tile[B + t] + p1 * tile[C + t] + q1 * tile[D + t]
    z = tile[PZ + t] - p3 * tile[E + t] - q3 * tile[F + t]
    return x, y, z


@inline_kernel
def in_view(tile, t, x, y, z, squared):
    """1 if a satellite stands above the lowest elevation in view, else 0."""
    up = -(x * tile[PX + t] + y * tile[PY + t] + z * tile[PZ + t])
    return 1.0 if up * abs(up) >= tile[LIMIT + t] * squared else 0.0

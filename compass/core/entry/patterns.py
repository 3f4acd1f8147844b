"""Many patterns judged in one call: what their satellites tell landers, entry by entry.

The satellites of a pattern share radius and phase x, and all turn against the Mars-fixed axes by
the same angle W. With ``P cos x + Q sin x`` in inertial axes, each is in Mars-fixed ones at

    (P1 a + Q1 b + P2 c + Q2 d,  P2 a + Q2 b - P1 c - Q1 d,  P3 e + Q3 f)

where ``a, b, c, d, e, f = cos W cos x, cos W sin x, sin W cos x, sin W sin x, cos x, sin x`` times
the radius are the same for all of them. So a satellite at an epoch costs some products and no
interpolation. What all satellites together tell at an epoch about Cartesian position and velocity
is the matrix ``M = sum w c c^T`` over their rows of the measurement matrix; the gains G of
`compass.core.entry.many.fly_many` carry it over to u but once: ``F = sum over epochs of G^T M G``.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.many import bound
from compass.core.jit import fast_kernel, inline_kernel, kernel
from compass.core.screen import circles, pattern_angles
from compass.core.smallmatrix import cholesky

EPS = np.finfo(np.float64).eps

# Epochs are worked through in tiles. All that a tile needs lies in one flat array, part after
# part, a constant distance apart: so the compiler knows that the parts do not overlap, and works
# on several epochs at once; and the tile stays in the first-level cache.
TILE = 128
A, B, C, D, E, F, PX, PY, PZ = (k * TILE for k in range(9))  # functions of time, the lander
TO_RATES = 9 * TILE  # from each of these to its rate
LIMIT, WEIGHT, WORK, COUNT = 18 * TILE, 19 * TILE, 20 * TILE, 26 * TILE
# blocks of M: position with itself, velocity with itself, position with velocity
PP, VV, PV, END = 27 * TILE, 33 * TILE, 39 * TILE, 48 * TILE
PARTS_OF_M = PP + TILE * np.array(
    [
        [0, 1, 2, 12, 13, 14],
        [1, 3, 4, 15, 16, 17],
        [2, 4, 5, 18, 19, 20],
        [12, 15, 18, 6, 7, 8],
        [13, 16, 19, 7, 9, 10],
        [14, 17, 20, 8, 10, 11],
    ]
)


class Entries(NamedTuple):
    """Entries as `compass.core.entry.many.fly_many` flies them, and when they measure.

    Shapes (m, t, 6), (m, t, 6, d), (m,); the weights (m, t) are those of
    `compass.core.entry.many.information`.
    """

    paths: NDArray[np.float64]
    gains: NDArray[np.float64]
    stops: NDArray[np.int64]
    weights: NDArray[np.float64]


class Limb(NamedTuple):
    """Sphere that blocks the view, m, and the mask over its limb for each pattern, (c,)."""

    sphere_radius: float
    sin_mask: NDArray[np.float64]
    cos_mask: NDArray[np.float64]


@kernel
def judge_patterns(
    patterns, radius, motion, begins, angles, entries, variances, omega, dt, limb, sigma, blind,
    counts,
):  # fmt: skip
    """Bounds, observability and satellites in view of c patterns in m entries.

    Parameters
    ----------
    patterns, radius, motion
        c `compass.core.patterns.Patterns`, the radius of their orbits (m) and their mean motion
        (rad/s), shape (c,).
    begins, angles
        When each entry begins, seconds after the patterns' epoch, and the rotation angle then,
        radians, shape (c, m).
    entries
        m `Entries`.
    variances, omega, dt
        As in `compass.core.entry.many.information`.
    limb
        What blocks the view.
    sigma
        Takes the posterior sigma of position (m) and velocity (m/s) at the end, (c, m, 2).
    blind
        Takes whether a direction of u remains unobserved, (c, m).
    counts
        Takes how often 0, 1, ... are in view, over all entries and epochs, (c, most + 1).
    """
    star, satellites, planes, phasing, inclination = patterns
    paths, gains, stops, weights = entries
    sphere_radius, sin_mask, cos_mask = limb
    size, d = satellites.size, gains.shape[3]
    rated = not math.isnan(variances[1])
    axes = np.empty((size, satellites.max(), 2, 3))
    span = (stops.max() // TILE + 1) * TILE
    clock, turn = np.empty((size, 2, span)), np.empty((2, span))
    for c in range(size):
        n = satellites[c]
        raan, u = pattern_angles(star[c], n, planes[c], phasing[c])
        circles(raan, u, inclination[c], axes[c, :n, 0], axes[c, :n, 1])
        _tabulate(motion[c] * dt, clock[c])
    _tabulate(omega * dt, turn)
    rows = 6 if rated else 3  # of M and G: ranges tell nothing about velocity
    tile, gain = np.empty(END), np.empty((d, rows * TILE))
    packed, low, y = np.empty((size, d * (d + 1) // 2)), np.empty((d, d)), np.empty(d)
    counts[:] = 0
    for m in range(stops.size):
        packed[:] = 0.0
        for first in range(0, stops[m] + 1, TILE):
            width = min(TILE, stops[m] + 1 - first)
            for t in range(TILE):
                # past the end the last epoch again, without weight
                at = min(first + t, stops[m])
                tile[WEIGHT + t] = weights[m, at] if t < width else 0.0
                for i in range(rows):
                    tile[PX + i % 3 * TILE + i // 3 * TO_RATES + t] = paths[m, at, i]
                    for j in range(d):
                        gain[j, i * TILE + t] = gains[m, at, i, j]
            for c in range(size):
                _set_limits(tile, sphere_radius, sin_mask[c], cos_mask[c])
                _set_basis(
                    tile, clock[c, :, first:], turn[:, first:], motion[c] * begins[c, m],
                    angles[c, m], radius[c], motion[c], omega,
                )  # fmt: skip
                tile[COUNT : END if rated else VV] = 0.0
                for s in range(satellites[c]):
                    p, q = axes[c, s]
                    _add_range(tile, p, q, variances[0])
                    if rated:
                        _add_rate(tile, p, q, variances[1])
                for t in range(width):
                    counts[c, int(tile[COUNT + t])] += 1
                _inform(tile, gain, packed[c])
        for c in range(size):
            blind[c, m] = _is_blind(packed[c], stops.max() + 1, low)
            k = -1
            for a in range(d):
                k += a + 1
                packed[c, k] += 1.0
            bound(packed[c], gains[m, stops[m]], low, y, sigma[c, m])


@kernel
def _tabulate(step, out):
    """Cosines and sines of 0, 1, 2 ... steps, shape (2, t)."""
    for t in range(out.shape[1]):
        out[0, t], out[1, t] = math.cos(step * t), math.sin(step * t)


@fast_kernel
def _set_limits(tile, radius, sin_mask, cos_mask):
    """Square, with its sign, of distance from the centre times sine of the lowest elevation seen.

    See `compass.core.entry.many.horizon`; squares save a root a satellite.
    """
    for t in range(TILE):
        x, y, z = tile[PX + t], tile[PY + t], tile[PZ + t]
        squared = x * x + y * y + z * z
        near = min(radius * radius, squared)
        low = sin_mask * math.sqrt(near) - cos_mask * math.sqrt(squared - near)
        tile[LIMIT + t] = low * abs(low)


@fast_kernel
def _set_basis(tile, clock, turn, phase, angle, radius, motion, omega):
    """Functions of time whose sums are the satellites' positions, then those of velocities."""
    ca, sa = math.cos(angle), math.sin(angle)
    cp, sp = radius * math.cos(phase), radius * math.sin(phase)
    for t in range(TILE):
        e, f = cp * clock[0, t] - sp * clock[1, t], sp * clock[0, t] + cp * clock[1, t]
        c, s = ca * turn[0, t] - sa * turn[1, t], sa * turn[0, t] + ca * turn[1, t]
        ce, cf, se, sf = c * e, c * f, s * e, s * f
        tile[A + t], tile[B + t], tile[C + t] = ce, cf, se
        tile[D + t], tile[E + t], tile[F + t] = sf, e, f
        at = TO_RATES + t
        tile[A + at], tile[B + at] = -omega * se - motion * cf, motion * ce - omega * sf
        tile[C + at], tile[D + at] = omega * ce - motion * sf, omega * cf + motion * se
        tile[E + at], tile[F + at] = -motion * f, motion * e


@inline_kernel
def _difference(tile, t, p1, p2, p3, q1, q2, q3):
    """Lander less satellite at an epoch: positions, or velocities with t `TO_RATES` more."""
    x = tile[PX + t] - p1 * tile[A + t] - q1 * tile[B + t] - p2 * tile[C + t] - q2 * tile[D + t]
    y = tile[PY + t] - p2 * tile[A + t] - q2 * tile[B + t] + p1 * tile[C + t] + q1 * tile[D + t]
    z = tile[PZ + t] - p3 * tile[E + t] - q3 * tile[F + t]
    return x, y, z


@inline_kernel
def _in_view(tile, t, x, y, z, squared):
    """1 if a satellite stands above the lowest elevation in view, else 0."""
    up = -(x * tile[PX + t] + y * tile[PY + t] + z * tile[PZ + t])
    return 1.0 if up * abs(up) >= tile[LIMIT + t] * squared else 0.0


@inline_kernel
def _add_square(tile, at, w, x, y, z):
    """Add ``w (x, y, z)^T (x, y, z)`` to a symmetric block of M."""
    wx, wy = w * x, w * y
    tile[at] += wx * x
    tile[TILE + at] += wx * y
    tile[2 * TILE + at] += wx * z
    tile[3 * TILE + at] += wy * y
    tile[4 * TILE + at] += wy * z
    tile[5 * TILE + at] += w * z * z


@fast_kernel
def _add_range(tile, p, q, variance):
    """Count a satellite, and add its ranges to M, at every epoch of a tile."""
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    scale = 0.0 if math.isnan(variance) else 1.0 / variance
    for t in range(TILE):
        x, y, z = _difference(tile, t, p1, p2, p3, q1, q2, q3)
        squared = x * x + y * y + z * z
        seen = _in_view(tile, t, x, y, z, squared)
        tile[COUNT + t] += seen
        _add_square(tile, PP + t, seen * scale * tile[WEIGHT + t] / squared, x, y, z)


@fast_kernel
def _add_rate(tile, p, q, variance):
    """Add a satellite's range rates to M at every epoch of a tile.

    ``R' = n . dv``: its row is ``c = (dv - R' n)/R`` on position, n on velocity.
    """
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    for t in range(TILE):
        x, y, z = _difference(tile, t, p1, p2, p3, q1, q2, q3)
        squared = x * x + y * y + z * z
        w = _in_view(tile, t, x, y, z, squared) * tile[WEIGHT + t] / variance
        near = 1.0 / math.sqrt(squared)
        x, y, z = x * near, y * near, z * near
        cx, cy, cz = _difference(tile, TO_RATES + t, p1, p2, p3, q1, q2, q3)
        rate = cx * x + cy * y + cz * z
        cx, cy, cz = (cx - rate * x) * near, (cy - rate * y) * near, (cz - rate * z) * near
        _add_square(tile, PP + t, w, cx, cy, cz)
        _add_square(tile, VV + t, w, x, y, z)
        x, y, z = w * x, w * y, w * z
        tile[PV + t] += cx * x
        tile[PV + TILE + t] += cx * y
        tile[PV + 2 * TILE + t] += cx * z
        tile[PV + 3 * TILE + t] += cy * x
        tile[PV + 4 * TILE + t] += cy * y
        tile[PV + 5 * TILE + t] += cy * z
        tile[PV + 6 * TILE + t] += cz * x
        tile[PV + 7 * TILE + t] += cz * y
        tile[PV + 8 * TILE + t] += cz * z


@fast_kernel
def _inform(tile, gain, packed):
    """Add ``G^T M G`` of every epoch of a tile to the packed information on u."""
    size, length = gain.shape
    work = tile[WORK : WORK + length]
    for b in range(size):
        work[:] = 0.0
        for i in range(length // TILE):
            row = work[i * TILE :]
            for j in range(length // TILE):
                part, on = tile[PARTS_OF_M[i, j] :], gain[b, j * TILE :]
                for t in range(TILE):
                    row[t] += part[t] * on[t]
        for a in range(b, size):
            total = 0.0
            for k in range(length):
                total += work[k] * gain[a, k]
            packed[a * (a + 1) // 2 + b] += total


@kernel
def _is_blind(packed, terms, low):
    """Whether the least eigenvalue cannot be told from 0.

    A sum of `terms` positive semi-definite matrices is off by at most ``terms eps`` times its
    trace, the eigenvalues by about ``d eps`` of it more. All are above that floor exactly if the
    matrix less the floor has a Cholesky factor.
    """
    d = low.shape[0]
    trace, k = 0.0, 0
    for a in range(d):
        for b in range(a + 1):
            low[a, b] = packed[k]
            k += 1
        trace += low[a, a]
    for a in range(d):
        low[a, a] -= (terms + d) * EPS * trace
    return not cholesky(low, low)

"""Many patterns judged in one call: what their satellites tell landers, entry by entry.

What all satellites together tell at an epoch about Cartesian position and velocity is the matrix
``M = sum w c c^T`` over their rows of the measurement matrix; the gains G of
`compass.core.entry.many.fly_many` carry it over to u but once: ``F = sum over epochs of G^T M G``.
Clocks and satellites' own errors, where they are not known, are
`compass.core.entry.pattern_unknowns`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.many import WAYS, bound
from compass.core.entry.pattern_unknowns import add_clock, add_satellite, take_satellite_out
from compass.core.entry.tile import (
    COUNT,
    END,
    KNOWN,
    PP,
    PV,
    PX,
    RANGES,
    SECONDS,
    TILE,
    TO_RATES,
    VV,
    WEIGHT,
    WORK,
    difference,
    in_view,
    set_basis,
    set_limits,
    tabulate,
)
from compass.core.jit import fast_kernel, inline_kernel, kernel
from compass.core.screen import circles, pattern_angles
from compass.core.smallmatrix import cholesky

EPS = np.finfo(np.float64).eps

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
    `compass.core.entry.information.information`.
    """

    paths: NDArray[np.float64]
    gains: NDArray[np.float64]
    stops: NDArray[np.int64]
    weights: NDArray[np.float64]


@kernel
def judge_patterns(
    patterns, radius, motion, begins, angles, entries, variances, omega, dt, limb, unknown, sigma,
    blind, counts,
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
        As in `compass.core.entry.information.information`.
    limb
        What blocks the view.
    unknown
        What is `compass.core.entry.pattern_unknowns.NotKnown`.
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
    own_clock, roots, turns = unknown
    size, motions, most = satellites.size, gains.shape[3], satellites.max()
    d = motions + own_clock.size
    doubted, erring = d > motions or roots.shape[3] > 0, roots.shape[3] > 0
    rated = not math.isnan(variances[1])
    axes = np.empty((size, most, 2, 3))
    span = (stops.max() // TILE + 1) * TILE
    clock, turn = np.empty((size, 2, span)), np.empty((2, span))
    for c in range(size):
        n = satellites[c]
        raan, u = pattern_angles(star[c], n, planes[c], phasing[c])
        circles(raan, u, inclination[c], axes[c, :n, 0], axes[c, :n, 1])
        tabulate(motion[c] * dt, clock[c])
    tabulate(omega * dt, turn)
    rows = 6 if rated else 3  # of M and G: ranges tell nothing about velocity
    tile, gain, end = np.zeros(END), np.empty((motions, rows * TILE)), np.zeros((6, d))
    packed, low, y = np.empty((size, d * (d + 1) // 2)), np.empty((d, d)), np.empty(d)
    # by satellite: what it tells about u and its own errors, and about these alone
    told, own = np.empty((size, most, d, WAYS)), np.empty((size, most, WAYS, WAYS))
    counts[:] = 0
    for m in range(stops.size):
        packed[:], told[:], own[:] = 0.0, 0.0, 0.0
        for first in range(0, stops[m] + 1, TILE):
            width = min(TILE, stops[m] + 1 - first)
            for t in range(TILE):
                # past the end the last epoch again, without weight
                at = min(first + t, stops[m])
                tile[WEIGHT + t] = weights[m, at] if t < width else 0.0
                tile[SECONDS + t] = at * dt
                for i in range(rows):
                    tile[PX + i % 3 * TILE + i // 3 * TO_RATES + t] = paths[m, at, i]
                    for j in range(motions):
                        gain[j, i * TILE + t] = gains[m, at, i, j]
            for c in range(size):
                set_limits(tile, sphere_radius, sin_mask[c], cos_mask[c])
                set_basis(
                    tile, clock[c, :, first:], turn[:, first:], motion[c] * begins[c, m],
                    angles[c, m], radius[c], motion[c], omega,
                )  # fmt: skip
                tile[COUNT : KNOWN if rated else VV] = 0.0
                tile[RANGES:SECONDS] = 0.0
                for s in range(satellites[c]):
                    p, q = axes[c, s]
                    _add_range(tile, p, q, variances[0])
                    if rated:
                        _add_rate(tile, p, q, variances[1])
                    if doubted:
                        add_satellite(
                            tile, p, q, motion[c], omega, variances, gain, own_clock, told[c, s],
                            own[c, s],
                        )  # fmt: skip
                for t in range(width):
                    counts[c, int(tile[COUNT + t])] += 1
                _inform(tile, gain, packed[c])
                if d > motions:
                    add_clock(tile, gain, own_clock, packed[c])
        end[:, : motions - turns] = gains[m, stops[m], :, : motions - turns]
        for c in range(size):
            for s in range(satellites[c] if erring else 0):
                take_satellite_out(told[c, s], own[c, s], roots[c, s], packed[c])
            blind[c, m] = _is_blind(packed[c], stops.max() + 1, motions, turns, low)
            k = -1
            for a in range(d):
                k += a + 1
                packed[c, k] += 1.0
            bound(packed[c], end, low, y, sigma[c, m])


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
        x, y, z = difference(tile, t, p1, p2, p3, q1, q2, q3)
        squared = x * x + y * y + z * z
        seen = in_view(tile, t, x, y, z, squared)
        tile[COUNT + t] += seen
        _add_square(tile, PP + t, seen * scale * tile[WEIGHT + t] / squared, x, y, z)


@fast_kernel
def _add_rate(tile, p, q, variance):
    """Add a satellite's range rates to M at every epoch of a tile.

    ``R' = n . dv``: its row is ``c = (dv - R' n)/R`` on position, n on velocity.
    """
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    for t in range(TILE):
        x, y, z = difference(tile, t, p1, p2, p3, q1, q2, q3)
        squared = x * x + y * y + z * z
        w = in_view(tile, t, x, y, z, squared) * tile[WEIGHT + t] / variance
        near = 1.0 / math.sqrt(squared)
        x, y, z = x * near, y * near, z * near
        cx, cy, cz = difference(tile, TO_RATES + t, p1, p2, p3, q1, q2, q3)
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
def _is_blind(packed, terms, stop, turns, low):
    """Whether the least eigenvalue cannot be told from 0, but for `turns` of it before `stop`.

    A sum of `terms` positive semi-definite matrices is off by at most ``terms eps`` times its
    trace, the eigenvalues by about ``d eps`` of it more. All are above that floor exactly if the
    matrix less the floor has a Cholesky factor.
    """
    d = low.shape[0] - turns
    part, trace = low[:d, :d], 0.0
    for a in range(d):
        at = a if a < stop - turns else a + turns
        for b in range(a + 1):
            part[a, b] = packed[at * (at + 1) // 2 + (b if b < stop - turns else b + turns)]
        trace += part[a, a]
    for a in range(d):
        part[a, a] -= (terms + d) * EPS * trace
    return not cholesky(part, part)

"""What a lander does not know of clocks and satellites, in judging many patterns at once.

As `compass.core.entry.information.information` counts it, but an epoch beside the other: what a
satellite tells about u and about its own errors is gathered in `WAYS`, radial, along, cross, and
clock with the bias of its ranges, and whitened once at the entry's end; ``F_ue (I + F_ee)^-1
F_eu`` is then taken from what all tell. The receiver's clock and drift are two more components of
u, whose rows are sums over the satellites at each epoch.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.many import WAYS, take_out
from compass.core.entry.tile import (
    BESIDE,
    BESIDES,
    COS,
    LINE,
    NEAR,
    RANGES,
    RATES,
    SECONDS,
    SEEN,
    SIN,
    TILE,
    TO_RANGE,
    TO_RATE,
    TO_RATES,
    WEIGHT,
    WEIGHTS,
    A,
    B,
    C,
    D,
    E,
    F,
    difference,
    in_view,
)
from compass.core.jit import fast_kernel, inline_kernel, kernel
from compass.core.smallmatrix import matmul


class NotKnown(NamedTuple):
    """Sigmas of the receiver's clock and drift, and roots of the satellites' errors.

    Shapes (2,), or (0,) for a clock that agrees; (c, n, WAYS, WAYS), or (c, n, WAYS, 0) for
    satellites that are known. `turns`: how many of the last columns of the entries' gains are what
    turns of the satellites' frame do to measurements, and not to the lander.
    """

    clock: NDArray[np.float64]
    roots: NDArray[np.float64]
    turns: int


@fast_kernel
def add_satellite(tile, p, q, motion, omega, variances, gain, clock, told, erring):
    """Add what a satellite tells in a tile about u and its errors, and its rows to the clocks'.

    Parameters
    ----------
    tile
        With its basis, limits and weights.
    p, q, motion, omega
        Axes of its circle, (3,), its rate and that of Mars, rad/s.
    variances
        Of ranges (m^2) and range rates (m^2/s^2), (2,); nan for what is not measured.
    gain
        G of the tile, (d, rows TILE).
    clock
        Of `NotKnown`.
    told, erring
        Take ``sum w h^T s``, (d + clock, WAYS), and ``sum w s^T s``, (WAYS, WAYS).
    """
    if not _see(tile, p, q):
        return
    ways, seconds = WAYS if clock.size else 0, tile[SECONDS:]
    bias, drift = gain.shape[0], gain.shape[0] + 1
    if not math.isnan(variances[0]):
        _add_ranges(tile, p, q, 1.0 / variances[0], erring)
        _add_told(tile, gain, told, TO_RANGE, LINE, 0)
        for k in range(ways):
            total, moment = _sums(tile[TO_RANGE + k * TILE :], seconds)
            told[bias, k] += clock[0] * total
            told[drift, k] += clock[1] * moment
    if not math.isnan(variances[1]):
        _add_rates(tile, p, q, motion, omega, 1.0 / variances[1], erring)
        _add_told(tile, gain, told, TO_RATE, BESIDE, 0)
        _add_told(tile, gain, told, TO_RATE, LINE, 3 * TILE)
        for k in range(ways):
            total, _ = _sums(tile[TO_RATE + k * TILE :], seconds)
            told[drift, k] += clock[1] * total


@fast_kernel
def _see(tile, p, q):
    """Set directions to a satellite and what its measurements weigh; whether any does."""
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    total = 0.0
    for t in range(TILE):
        x, y, z = difference(tile, t, p1, p2, p3, q1, q2, q3)
        squared = x * x + y * y + z * z
        weight = in_view(tile, t, x, y, z, squared) * tile[WEIGHT + t]
        near = 1.0 / math.sqrt(squared)
        x, y, z = x * near, y * near, z * near
        tile[SEEN + t], tile[NEAR + t] = weight, near
        tile[LINE + t], tile[LINE + TILE + t], tile[LINE + 2 * TILE + t] = x, y, z
        total += weight
    return total > 0.0


@inline_kernel
def _along_axes(tile, t, p1, p2, p3, q1, q2, q3, scale, x, y, z):
    """Components of a vector along a satellite's radial, along and cross directions.

    The second is the derivative of the first in the phase, over the radius, 1/`scale`.
    """
    a, b, c, d, e, f = (
        tile[A + t], tile[B + t], tile[C + t], tile[D + t], tile[E + t], tile[F + t]
    )  # fmt: skip
    radial = x * (p1 * a + q1 * b + p2 * c + q2 * d)
    radial += y * (p2 * a + q2 * b - p1 * c - q1 * d) + z * (p3 * e + q3 * f)
    along = x * (q1 * a - p1 * b + q2 * c - p2 * d)
    along += y * (q2 * a - p2 * b - q1 * c + p1 * d) + z * (q3 * e - p3 * f)
    n1, n2, n3 = p2 * q3 - p3 * q2, p3 * q1 - p1 * q3, p1 * q2 - p2 * q1
    cross = x * (n1 * tile[COS + t] + n2 * tile[SIN + t])
    cross += y * (n2 * tile[COS + t] - n1 * tile[SIN + t]) + z * n3
    return scale * radial, scale * along, cross


@fast_kernel
def _add_ranges(tile, p, q, worth, erring):
    """What a satellite's errors do to its range, times the weight, and its rows for clocks."""
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    scale = 1.0 / math.hypot(tile[E], tile[F])
    rr = ra = rc = aa = ac = cc = r = a = c = one = 0.0
    for t in range(TILE):
        w = worth * tile[SEEN + t]
        x, y, z = tile[LINE + t], tile[LINE + TILE + t], tile[LINE + 2 * TILE + t]
        tile[RANGES + t] += w * x
        tile[RANGES + TILE + t] += w * y
        tile[RANGES + 2 * TILE + t] += w * z
        tile[WEIGHTS + t] += w
        radial, along, cross = _along_axes(tile, t, p1, p2, p3, q1, q2, q3, scale, x, y, z)
        wr, wa, wc = -w * radial, -w * along, -w * cross
        tile[TO_RANGE + t], tile[TO_RANGE + TILE + t] = wr, wa
        tile[TO_RANGE + 2 * TILE + t], tile[TO_RANGE + 3 * TILE + t] = wc, w
        rr, ra, rc = rr - wr * radial, ra - wr * along, rc - wr * cross
        aa, ac, cc = aa - wa * along, ac - wa * cross, cc - wc * cross
        r, a, c, one = r + wr, a + wa, c + wc, one + w
    _add_symmetric(erring, rr, ra, rc, aa, ac, cc)
    last = WAYS - 1
    for k, value in enumerate((r, a, c)):
        erring[last, k] += value
        erring[k, last] += value
    erring[last, last] += one


@fast_kernel
def _add_rates(tile, p, q, motion, omega, worth, erring):
    """What a satellite's errors do to its rate, times the weight, and its rows for clocks.

    ``R' = n . dv``: its row is ``c = (dv - R' n)/R`` on position, n on velocity. An error stays in
    the satellite's directions, which turn by ``motion N - omega z``: on it the row is the
    components of ``-(c + n x (motion N - omega z))``, of which motion N turns but the first two.
    """
    p1, p2, p3, q1, q2, q3 = p[0], p[1], p[2], q[0], q[1], q[2]
    scale = 1.0 / math.hypot(tile[E], tile[F])
    rr = ra = rc = aa = ac = cc = 0.0
    for t in range(TILE):
        w, near = worth * tile[SEEN + t], tile[NEAR + t]
        x, y, z = tile[LINE + t], tile[LINE + TILE + t], tile[LINE + 2 * TILE + t]
        cx, cy, cz = difference(tile, TO_RATES + t, p1, p2, p3, q1, q2, q3)
        rate = cx * x + cy * y + cz * z
        cx, cy, cz = (cx - rate * x) * near, (cy - rate * y) * near, (cz - rate * z) * near
        tile[BESIDE + t], tile[BESIDE + TILE + t], tile[BESIDE + 2 * TILE + t] = cx, cy, cz
        tile[BESIDES + t] += w * cx
        tile[BESIDES + TILE + t] += w * cy
        tile[BESIDES + 2 * TILE + t] += w * cz
        tile[RATES + t] += w * x
        tile[RATES + TILE + t] += w * y
        tile[RATES + 2 * TILE + t] += w * z
        tile[WEIGHTS + TILE + t] += w
        lr, la, _ = _along_axes(tile, t, p1, p2, p3, q1, q2, q3, scale, x, y, z)
        radial, along, cross = _along_axes(
            tile, t, p1, p2, p3, q1, q2, q3, scale, cx - omega * y, cy + omega * x, cz
        )
        radial, along = radial + motion * la, along - motion * lr
        wr, wa, wc = -w * radial, -w * along, -w * cross
        tile[TO_RATE + t], tile[TO_RATE + TILE + t], tile[TO_RATE + 2 * TILE + t] = wr, wa, wc
        rr, ra, rc = rr - wr * radial, ra - wr * along, rc - wr * cross
        aa, ac, cc = aa - wa * along, ac - wa * cross, cc - wc * cross
    _add_symmetric(erring, rr, ra, rc, aa, ac, cc)


@inline_kernel
def _add_symmetric(out, xx, xy, xz, yy, yz, zz):
    """Add to the first three rows and columns of a symmetric matrix."""
    out[0, 0] += xx
    out[1, 1] += yy
    out[2, 2] += zz
    for i, j, value in ((0, 1, xy), (0, 2, xz), (1, 2, yz)):
        out[i, j] += value
        out[j, i] += value


@fast_kernel
def _add_told(tile, gain, told, errors, row, first):
    """Add ``sum h^T s`` of a tile, h a row's three components times the parts of G from `first`."""
    x, y, z = tile[row:], tile[row + TILE :], tile[row + 2 * TILE :]
    radials, alongs = tile[errors:], tile[errors + TILE :]
    crosses, clocks = tile[errors + 2 * TILE :], tile[errors + 3 * TILE :]
    for b in range(gain.shape[0]):
        gx, gy, gz = gain[b, first:], gain[b, first + TILE :], gain[b, first + 2 * TILE :]
        radial = along = cross = clock = 0.0
        for t in range(TILE):
            h = x[t] * gx[t] + y[t] * gy[t] + z[t] * gz[t]
            radial += h * radials[t]
            along += h * alongs[t]
            cross += h * crosses[t]
            clock += h * clocks[t]
        told[b, 0] += radial
        told[b, 1] += along
        told[b, 2] += cross
        told[b, 3] += clock


@fast_kernel
def _sums(part, seconds):
    """Sum of a part over a tile, and of it times the time."""
    total = moment = 0.0
    for t in range(TILE):
        total += part[t]
        moment += part[t] * seconds[t]
    return total, moment


@fast_kernel
def add_clock(tile, gain, clock, packed):
    """Add what all satellites tell in a tile about the receiver's clock and drift.

    Parameters
    ----------
    tile, gain, clock
        As in `add_satellite`, which has summed the rows.
    packed
        Takes the last two rows of the information, packed.
    """
    d, rated = gain.shape[0], gain.shape[1] > 3 * TILE
    bias, drift = d * (d + 1) // 2, (d + 1) * (d + 2) // 2
    seconds, ranging, rating = tile[SECONDS:], tile[WEIGHTS:], tile[WEIGHTS + TILE :]
    for b in range(d):
        at_once = later = 0.0
        for i in range(3):
            row, on = tile[RANGES + i * TILE :], gain[b, i * TILE :]
            for t in range(TILE):
                told = row[t] * on[t]
                at_once += told
                later += told * seconds[t]
        if rated:
            for i in range(6):  # `BESIDES`, then `RATES`: on position, then on velocity
                row, on = tile[BESIDES + i * TILE :], gain[b, i * TILE :]
                for t in range(TILE):
                    later += row[t] * on[t]
        packed[bias + b] += clock[0] * at_once
        packed[drift + b] += clock[1] * later
    ranges = moments = squares = rates = 0.0
    for t in range(TILE):
        ranges += ranging[t]
        moments += ranging[t] * seconds[t]
        squares += ranging[t] * seconds[t] * seconds[t]
        rates += rating[t]
    packed[bias + d] += clock[0] * clock[0] * ranges
    packed[drift + d] += clock[0] * clock[1] * moments
    packed[drift + d + 1] += clock[1] * clock[1] * (squares + rates)


@kernel
def take_satellite_out(told, erring, root, packed):
    """Take from packed information what a satellite's own errors cost, in place.

    They are whitened by `root`; `told` and `erring` are sums of `add_satellite`.
    """
    cross, half, own = np.empty(told.shape), np.empty((WAYS, WAYS)), np.empty((WAYS, WAYS))
    matmul(told, root, cross)
    matmul(erring, root, half)
    matmul(root.T, half, own)
    take_out(cross, own, packed)

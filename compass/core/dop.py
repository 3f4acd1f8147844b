"""Dilution of precision from the unit vectors of lines of sight, in closed form.

With unit vectors u_i from the user to n satellites, ``s = sum u`` and
``S = sum u u^T - s s^T / n`` (positions after the clock is eliminated):
``PDOP^2 = tr S^-1``, ``TDOP^2 = 1/n + s^T S^-1 s / n^2``, ``GDOP^2 = PDOP^2 + TDOP^2``,
``VDOP^2 = up^T S^-1 up``, ``HDOP^2 = PDOP^2 - VDOP^2``; S^-1 by cofactors.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import fused_kernel, inline_kernel, kernel
from compass.core.runs import HIGH, OUT, SQUARE, UP_OUT, UP_Z, most_runs, sight_runs

#: Order of the DOPs in every array.
GDOP, PDOP, HDOP, VDOP, TDOP = range(5)

EPS = np.finfo(np.float64).eps

# A row is worked through in tiles of columns. All that a tile needs lies in one flat array, part
# after part, a constant distance apart: so the compiler knows that the parts do not overlap, and
# works on several columns at once; and the tile stays in the first-level cache.
TILE = 128
XX, YY, ZZ, XY, XZ, YZ, X, Y, Z, N, PX, PY = (k * TILE for k in range(12))


@inline_kernel
def dops(n, sxx, syy, szz, sxy, sxz, syz, sx, sy, sz, ux, uy, uz):
    """GDOP, PDOP, HDOP, VDOP, TDOP from moments of the lines of sight.

    Infinite with fewer than four satellites, and where the lines of sight lie on a cone:
    ``det S <= 64 eps n^3``. Rounding moves each entry of S by at most about ``n eps``, and so
    the determinant by a few ``n^3 eps``; below the limit its sign means nothing. The limit is
    reached near PDOP 4e6; the relative error is about ``eps PDOP^2 n`` before it.

    Parameters
    ----------
    n
        Number of satellites in view.
    sxx, syy, szz, sxy, sxz, syz
        Sums of products of the components of u.
    sx, sy, sz
        Sums of the components of u.
    ux, uy, uz
        The local up.
    """
    if n < 4.0:
        return math.inf, math.inf, math.inf, math.inf, math.inf
    return weighted_dops(n, sxx, syy, szz, sxy, sxz, syz, sx, sy, sz, ux, uy, uz)


@inline_kernel
def weighted_dops(n, sxx, syy, szz, sxy, sxz, syz, sx, sy, sz, ux, uy, uz):
    """`dops` of moments with a weight each, n their sum; four or more sights are taken for given.

    With weights 1/sigma^2 these are no dilutions but errors: sigmas of the fix.
    """
    w = 1.0 / n
    a, b, c = sxx - sx * sx * w, syy - sy * sy * w, szz - sz * sz * w
    d, e, f = sxy - sx * sy * w, sxz - sx * sz * w, syz - sy * sz * w
    caa, cbb, ccc = b * c - f * f, a * c - e * e, a * b - d * d
    cab, cac, cbc = e * f - d * c, d * f - e * b, d * e - a * f
    det = a * caa + d * cab + e * cac
    if det <= 64.0 * EPS * n * n * n:
        return math.inf, math.inf, math.inf, math.inf, math.inf
    r = 1.0 / det
    p2 = (caa + cbb + ccc) * r
    v2 = quadratic(caa, cbb, ccc, cab, cac, cbc, ux, uy, uz) * r
    t2 = w + quadratic(caa, cbb, ccc, cab, cac, cbc, sx, sy, sz) * r * w * w
    return (
        math.sqrt(p2 + t2),
        math.sqrt(p2),
        math.sqrt(max(p2 - v2, 0.0)),
        math.sqrt(max(v2, 0.0)),
        math.sqrt(t2),
    )


@inline_kernel
def quadratic(caa, cbb, ccc, cab, cac, cbc, x, y, z):
    """Value of a symmetric form at a vector."""
    return caa * x * x + cbb * y * y + ccc * z * z + 2.0 * (cab * x * y + cac * x * z + cbc * y * z)


@fused_kernel
def _add_sights(tile, first, stop, rx, ry, rz, pz, square):
    """Add one satellite's line of sight to the moments of columns first ... stop-1 of a tile."""
    r2 = rx * rx + ry * ry + rz * rz + square
    zz = rz - pz
    part = tile[first:]  # counted from 0 the compiler need not allow for negative indices
    for j in range(stop - first):
        px, py = part[PX + j], part[PY + j]
        w = 1.0 / math.sqrt(r2 - 2.0 * (rx * px + ry * py + rz * pz))
        x, y, z = (rx - px) * w, (ry - py) * w, zz * w
        part[XX + j] += x * x
        part[YY + j] += y * y
        part[ZZ + j] += z * z
        part[XY + j] += x * y
        part[XZ + j] += x * z
        part[YZ + j] += y * z
        part[X + j] += x
        part[Y + j] += y
        part[Z + j] += z
        part[N + j] += 1.0


@fused_kernel
def _solve(tile, slant, up_z):
    """Turn the moments of a tile into DOPs, which take the place of the first five moments.

    The users' up, out from the axis, is `slant` times their place.
    """
    for j in range(TILE):
        g, p, h, v, t = dops(
            tile[N + j], tile[XX + j], tile[YY + j], tile[ZZ + j], tile[XY + j], tile[XZ + j],
            tile[YZ + j], tile[X + j], tile[Y + j], tile[Z + j],
            slant * tile[PX + j], slant * tile[PY + j], up_z,
        )  # fmt: skip
        tile[XX + j] = g
        tile[YY + j] = p
        tile[ZZ + j] = h
        tile[XY + j] = v
        tile[XZ + j] = t


class Scratch(NamedTuple):
    """Working space of a row: a tile of columns, runs of columns in sight, whose they are."""

    tile: NDArray[np.float64]
    runs: NDArray[np.int64]
    owners: NDArray[np.int64]


@kernel
def row_runs(r, cos_cap, row, runs, owners):
    """Fill the runs of columns of a row that see a satellite, and whose they are; their number.

    Parameters are those of `dop_row`.
    """
    total = 0
    for s in range(r.shape[0]):
        before = total
        total += sight_runs(r[s, 0], r[s, 1], r[s, 2], cos_cap[s], row, runs[total:])
        owners[before:total] = s
    return total


@kernel
def dop_row(r, cos_cap, row, scratch, counts, out):
    """Counts and DOPs in every column of one row at one epoch.

    Parameters
    ----------
    r
        Satellite positions in units of the equatorial radius, Mars-fixed, shape (satellite, 3).
    cos_cap
        Cosines of the cap radii on a sphere, shape (satellite,); of other users than those on the
        ground of a sphere, over a constant mask, the caps are not used.
    row
        The users, see `compass.core.runs.Row`.
    scratch
        From `row_scratch`.
    counts
        Filled; shape (column,).
    out
        Filled; shape (5, column), in the order GDOP, PDOP, HDOP, VDOP, TDOP.
    """
    place, tile, runs, owners = row.place, scratch.tile, scratch.runs, scratch.owners
    m = row.cos_lon.size
    total = row_runs(r, cos_cap, row, runs, owners)
    out_from_axis, high, square = place[OUT], place[HIGH], place[SQUARE]
    for start in range(0, m, TILE):
        width = min(TILE, m - start)
        tile[:PX] = 0.0
        for j in range(width):
            tile[PX + j] = out_from_axis * row.cos_lon[start + j]
            tile[PY + j] = out_from_axis * row.sin_lon[start + j]
        for k in range(total):
            s = owners[k]
            # a run that goes on past the last column continues at column 0
            for turn in range(2):
                a = max(runs[k, 0] - turn * m - start, 0)
                b = min(min(runs[k, 1] - turn * m, m) - start, width)
                _add_sights(tile, a, b, r[s, 0], r[s, 1], r[s, 2], high, square)
        _solve(tile, place[UP_OUT] / out_from_axis, place[UP_Z])
        for d in range(5):
            out[d, start : start + width] = tile[d * TILE : d * TILE + width]
        for j in range(width):
            counts[start + j] = int(tile[N + j])


@kernel
def row_scratch(satellites, row):
    """Working space for `dop_row`."""
    runs = most_runs(satellites, row)
    return Scratch(np.zeros(12 * TILE), np.empty((runs, 2), np.int64), np.empty(runs, np.int64))


@kernel
def dop_over_time(r, cos_cap, row, counts, out):
    """Counts and DOPs in every column of one row at every epoch.

    Parameters
    ----------
    r, cos_cap, row
        As in `dop_row`, the first two with a leading epoch axis.
    counts
        Filled; shape (epoch, column).
    out
        Filled; shape (epoch, 5, column).
    """
    scratch = row_scratch(r.shape[1], row)
    for t in range(r.shape[0]):
        dop_row(r[t], cos_cap[t], row, scratch, counts[t], out[t])


@kernel
def dop_series(sights, visible, up, counts, out):
    """Counts and DOPs of one user over time.

    Parameters
    ----------
    sights
        Unit vectors from the user to the satellites, shape (satellite, epoch, 3).
    visible
        Which are in view, shape (satellite, epoch).
    up
        The user's up, shape (3,).
    counts
        Filled; shape (epoch,).
    out
        Filled; shape (5, epoch).
    """
    for t in range(sights.shape[1]):
        n = 0.0
        sxx = syy = szz = sxy = sxz = syz = sx = sy = sz = 0.0
        for s in range(sights.shape[0]):
            if visible[s, t]:
                x, y, z = sights[s, t, 0], sights[s, t, 1], sights[s, t, 2]
                n += 1.0
                sxx += x * x
                syy += y * y
                szz += z * z
                sxy += x * y
                sxz += x * z
                syz += y * z
                sx += x
                sy += y
                sz += z
        counts[t] = int(n)
        g, p, h, v, d = dops(n, sxx, syy, szz, sxy, sxz, syz, sx, sy, sz, up[0], up[1], up[2])
        out[0, t] = g
        out[1, t] = p
        out[2, t] = h
        out[3, t] = v
        out[4, t] = d

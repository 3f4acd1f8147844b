"""Dilution of precision from the unit vectors of lines of sight, in closed form.

With unit vectors u_i from the user to n satellites, ``s = sum u`` and
``S = sum u u^T - s s^T / n`` (positions after the clock is eliminated):
``PDOP^2 = tr S^-1``, ``TDOP^2 = 1/n + s^T S^-1 s / n^2``, ``GDOP^2 = PDOP^2 + TDOP^2``,
``VDOP^2 = up^T S^-1 up``, ``HDOP^2 = PDOP^2 - VDOP^2``; S^-1 by cofactors.
"""

import math

import numpy as np

from compass.core.jit import fast_kernel, kernel
from compass.core.runs import cap_runs, horizon_runs

#: Order of the DOPs in every array.
GDOP, PDOP, HDOP, VDOP, TDOP = range(5)

EPS = np.finfo(np.float64).eps


@fast_kernel
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
    if n < 4:
        return math.inf, math.inf, math.inf, math.inf, math.inf
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
    v2 = _quadratic(caa, cbb, ccc, cab, cac, cbc, ux, uy, uz) * r
    t2 = w + _quadratic(caa, cbb, ccc, cab, cac, cbc, sx, sy, sz) * r * w * w
    return (
        math.sqrt(p2 + t2),
        math.sqrt(p2),
        math.sqrt(max(p2 - v2, 0.0)),
        math.sqrt(max(v2, 0.0)),
        math.sqrt(t2),
    )


@fast_kernel
def _quadratic(caa, cbb, ccc, cab, cac, cbc, x, y, z):
    return caa * x * x + cbb * y * y + ccc * z * z + 2.0 * (cab * x * y + cac * x * z + cbc * y * z)


@fast_kernel
def _add_sights(moments, first, stop, rx, ry, rz, px, py, pz):
    """Add one satellite's line of sight to the moments of columns first ... stop-1."""
    r2 = rx * rx + ry * ry + rz * rz + 1.0
    mxx, myy, mzz = moments[0], moments[1], moments[2]
    mxy, mxz, myz = moments[3], moments[4], moments[5]
    mx, my, mz, mn = moments[6], moments[7], moments[8], moments[9]
    zz = rz - pz
    for j in range(first, stop):
        dot = rx * px[j] + ry * py[j] + rz * pz
        w = 1.0 / math.sqrt(r2 - 2.0 * dot)
        x, y, z = (rx - px[j]) * w, (ry - py[j]) * w, zz * w
        mxx[j] += x * x
        myy[j] += y * y
        mzz[j] += z * z
        mxy[j] += x * y
        mxz[j] += x * z
        myz[j] += y * z
        mx[j] += x
        my[j] += y
        mz[j] += z
        mn[j] += 1.0


@kernel
def dop_row(
    r,
    cos_cap,
    azimuths,
    elevations,
    sin_lat,
    cos_lat,
    cos_lon,
    sin_lon,
    lon0,
    px,
    py,
    moments,
    runs,
    counts,
    out,
):
    """Counts and DOPs in every column of one row at one epoch.

    Parameters
    ----------
    r
        Satellite positions in units of the sphere's radius, Mars-fixed, shape (satellite, 3).
    cos_cap
        Cosines of the cap radii, shape (satellite,).
    azimuths, elevations
        The mask; with more than one azimuth, the caps are not used.
    sin_lat, cos_lat
        Of the row.
    cos_lon, sin_lon, lon0
        Of the columns, shape (column,); longitude of column 0.
    px, py
        Scratch, shape (column,).
    moments, runs
        Scratch, shapes (10, column) and (column, 2).
    counts
        Filled; shape (column,).
    out
        Filled; shape (5, column), in the order GDOP, PDOP, HDOP, VDOP, TDOP.
    """
    m = cos_lon.size
    for j in range(m):
        px[j] = cos_lat * cos_lon[j]
        py[j] = cos_lat * sin_lon[j]
    moments[:] = 0.0
    for s in range(r.shape[0]):
        rx, ry, rz = r[s, 0], r[s, 1], r[s, 2]
        if azimuths.size == 1:
            w = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz)
            found = cap_runs(
                rx * w,
                ry * w,
                rz * w,
                cos_cap[s],
                sin_lat,
                cos_lat,
                cos_lon,
                sin_lon,
                lon0,
                runs,
            )
        else:
            found = horizon_runs(
                rx, ry, rz, sin_lat, cos_lat, cos_lon, sin_lon, azimuths, elevations, runs
            )
        for k in range(found):
            first, stop = runs[k, 0], runs[k, 1]
            _add_sights(moments, first, min(stop, m), rx, ry, rz, px, py, sin_lat)
            _add_sights(moments, 0, stop - m, rx, ry, rz, px, py, sin_lat)
    for j in range(m):
        n = moments[9, j]
        counts[j] = int(n)
        g, p, h, v, t = dops(
            n,
            moments[0, j],
            moments[1, j],
            moments[2, j],
            moments[3, j],
            moments[4, j],
            moments[5, j],
            moments[6, j],
            moments[7, j],
            moments[8, j],
            px[j],
            py[j],
            sin_lat,
        )
        out[0, j] = g
        out[1, j] = p
        out[2, j] = h
        out[3, j] = v
        out[4, j] = t


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

"""Errors of a fix by weighted least squares, in metres, over a row of users.

With unit vectors u_i to the satellites and range variances s_i^2 the row of the design matrix is
``[-u_i, 1]``. Weights 1/s_i^2 give the covariance ``(G' W G)^-1``; equal weights give
``(G'G)^-1 G' S G (G'G)^-1``, what a receiver gets that does not know the variances.

A range's variance is that of the satellite's position and clock along the line of sight,
``u'Q u + 2 q.u + p``, the receiver's ``(n + z/sin el)^2 + a d^2 + b d^4`` and the ionosphere's.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.dop import TILE, Scratch, quadratic, row_runs, weighted_dops
from compass.core.ionosphere import sunlit
from compass.core.jit import fused_kernel, inline_kernel, kernel
from compass.core.ranking import BINS, add_to_histogram
from compass.core.runs import HIGH, OUT, SQUARE, UP_OUT, UP_Z, most_runs

Array = NDArray[np.float64]

#: Order of the errors in every array.
HORIZONTAL, VERTICAL, POSITION, TIME = range(4)

#: Places among the numbers that all ranges share: receiver's n, z, a, b (with distances in units of
#: the equatorial radius); square of the ionosphere's delay straight up below the Sun; square of the
#: equatorial radius over the shell's; variances that all satellites share, of a horizontal
#: coordinate and of time; whether weights are equal.
NOISE, ZENITH, LOOP, LOOP2, DELAY2, SHELL2, SHARED, SHARED_TIME, EQUAL = range(9)
NUMBERS = 9

#: Sines of elevations below this count as it: a satellite at the very horizon weighs nothing.
LOWEST_SINE = 1e-6

# Parts of a tile: weighted moments, their sum, count, places, share of the ionosphere's variance,
# and with equal weights the moments of the variances.
XX, YY, ZZ, XY, XZ, YZ, X, Y, Z, W, N, PX, PY, SUNLIT = (k * TILE for k in range(14))
VXX, VYY, VZZ, VXY, VXZ, VYZ, VX, VY, VZ, V = (k * TILE for k in range(14, 24))
PARTS = 24


@inline_kernel
def range_variance(x, y, z, w, sine, lit, q, numbers):
    """Variance of a range, m^2: along u, at inverse distance w, over the horizon by `sine`.

    Parameters
    ----------
    x, y, z
        Unit vector to the satellite, in the frame of `q`.
    w
        One over the distance, in units of the equatorial radius.
    sine
        Of the elevation.
    lit
        Share of the ionosphere's variance that the Sun leaves here.
    q
        Q (xx, yy, zz, xy, xz, yz), q and p of the satellite, shape (10,), m^2.
    numbers
        See above.
    """
    orbit = quadratic(q[0], q[1], q[2], q[3], q[4], q[5], x, y, z)
    orbit += 2.0 * (q[6] * x + q[7] * y + q[8] * z) + q[9]
    above = max(sine, LOWEST_SINE)
    heard = numbers[NOISE] + numbers[ZENITH] / above
    d2 = 1.0 / (w * w)
    through = numbers[DELAY2] * lit / (1.0 - numbers[SHELL2] * (1.0 - sine * sine))
    return orbit + heard * heard + d2 * (numbers[LOOP] + numbers[LOOP2] * d2) + through


@fused_kernel
def _add_ranges(tile, first, stop, rx, ry, rz, high, square, slant, up_z, q, numbers):
    """Add a satellite's range, weighed by its variance, to columns first ... stop-1 of a tile."""
    r2 = rx * rx + ry * ry + rz * rz + square
    zz = rz - high
    part = tile[first:]
    for j in range(stop - first):
        px, py = part[PX + j], part[PY + j]
        w = 1.0 / math.sqrt(r2 - 2.0 * (rx * px + ry * py + rz * high))
        x, y, z = (rx - px) * w, (ry - py) * w, zz * w
        sine = slant * (px * x + py * y) + up_z * z
        weight = 1.0 / range_variance(x, y, z, w, sine, part[SUNLIT + j], q, numbers)
        wx, wy, wz = weight * x, weight * y, weight * z
        part[XX + j] += wx * x
        part[YY + j] += wy * y
        part[ZZ + j] += wz * z
        part[XY + j] += wx * y
        part[XZ + j] += wx * z
        part[YZ + j] += wy * z
        part[X + j] += wx
        part[Y + j] += wy
        part[Z + j] += wz
        part[W + j] += weight
        part[N + j] += 1.0


@fused_kernel
def _add_equal_ranges(tile, first, stop, rx, ry, rz, high, square, slant, up_z, q, numbers):
    """As `_add_ranges` with weight one; the moments of the variances beside."""
    r2 = rx * rx + ry * ry + rz * rz + square
    zz = rz - high
    part = tile[first:]
    for j in range(stop - first):
        px, py = part[PX + j], part[PY + j]
        w = 1.0 / math.sqrt(r2 - 2.0 * (rx * px + ry * py + rz * high))
        x, y, z = (rx - px) * w, (ry - py) * w, zz * w
        sine = slant * (px * x + py * y) + up_z * z
        v = range_variance(x, y, z, w, sine, part[SUNLIT + j], q, numbers)
        part[XX + j] += x * x
        part[YY + j] += y * y
        part[ZZ + j] += z * z
        part[XY + j] += x * y
        part[XZ + j] += x * z
        part[YZ + j] += y * z
        part[X + j] += x
        part[Y + j] += y
        part[Z + j] += z
        part[W + j] += 1.0
        part[N + j] += 1.0
        part[VXX + j] += v * x * x
        part[VYY + j] += v * y * y
        part[VZZ + j] += v * z * z
        part[VXY + j] += v * x * y
        part[VXZ + j] += v * x * z
        part[VYZ + j] += v * y * z
        part[VX + j] += v * x
        part[VY + j] += v * y
        part[VZ + j] += v * z
        part[V + j] += v


@inline_kernel
def sandwich(n, s, m, ux, uy, uz):
    """Vertical, position and time variance of equal weights; infinite where geometry is singular.

    With the mean line of sight b and ``S = sum u u' - n b b'``: positions have the covariance
    ``C = S^-1 (M - m b' - b m' + m0 b b') S^-1``, time ``m0/n^2 - 2/n b'S^-1 (m - m0 b) + b'C b``.

    Parameters
    ----------
    n
        Number of sights.
    s, m
        Moments without and with the variances: xx, yy, zz, xy, xz, yz, x, y, z, and m's sum.
    ux, uy, uz
        The local up.
    """
    bx, by, bz = s[6] / n, s[7] / n, s[8] / n
    a, b, c = s[0] - s[6] * bx, s[1] - s[7] * by, s[2] - s[8] * bz
    d, e, f = s[3] - s[6] * by, s[4] - s[6] * bz, s[5] - s[7] * bz
    caa, cbb, ccc = b * c - f * f, a * c - e * e, a * b - d * d
    cab, cac, cbc = e * f - d * c, d * f - e * b, d * e - a * f
    det = a * caa + d * cab + e * cac
    if det <= 64.0 * 2.220446049250313e-16 * n * n * n:
        return math.inf, math.inf, math.inf
    r = 1.0 / det
    m0 = m[9]
    kxx = m[0] - 2.0 * m[6] * bx + m0 * bx * bx
    kyy = m[1] - 2.0 * m[7] * by + m0 * by * by
    kzz = m[2] - 2.0 * m[8] * bz + m0 * bz * bz
    kxy = m[3] - m[6] * by - m[7] * bx + m0 * bx * by
    kxz = m[4] - m[6] * bz - m[8] * bx + m0 * bx * bz
    kyz = m[5] - m[7] * bz - m[8] * by + m0 * by * bz
    # columns of S^-1
    x1, x2, x3 = caa * r, cab * r, cac * r
    y1, y2, y3 = cab * r, cbb * r, cbc * r
    z1, z2, z3 = cac * r, cbc * r, ccc * r
    position = quadratic(kxx, kyy, kzz, kxy, kxz, kyz, x1, x2, x3)
    position += quadratic(kxx, kyy, kzz, kxy, kxz, kyz, y1, y2, y3)
    position += quadratic(kxx, kyy, kzz, kxy, kxz, kyz, z1, z2, z3)
    vx, vy, vz = (
        ux * x1 + uy * y1 + uz * z1,
        ux * x2 + uy * y2 + uz * z2,
        ux * x3 + uy * y3 + uz * z3,
    )
    vertical = quadratic(kxx, kyy, kzz, kxy, kxz, kyz, vx, vy, vz)
    tx, ty, tz = (
        bx * x1 + by * y1 + bz * z1,
        bx * x2 + by * y2 + bz * z2,
        bx * x3 + by * y3 + bz * z3,
    )
    time = quadratic(kxx, kyy, kzz, kxy, kxz, kyz, tx, ty, tz) + m0 / (n * n)
    time -= 2.0 / n * (tx * (m[6] - m0 * bx) + ty * (m[7] - m0 * by) + tz * (m[8] - m0 * bz))
    return vertical, position, time


@fused_kernel
def _solve(tile, width, slant, up_z, shared, shared_time):
    """Turn the moments of a tile into errors, which take the place of the first four."""
    for j in range(width):
        if tile[N + j] < 4.0:
            tile[XX + j] = tile[YY + j] = tile[ZZ + j] = tile[XY + j] = math.inf
            continue
        _, p, h, v, t = weighted_dops(
            tile[W + j], tile[XX + j], tile[YY + j], tile[ZZ + j], tile[XY + j], tile[XZ + j],
            tile[YZ + j], tile[X + j], tile[Y + j], tile[Z + j],
            slant * tile[PX + j], slant * tile[PY + j], up_z,
        )  # fmt: skip
        tile[XX + j] = math.sqrt(h * h + 2.0 * shared)
        tile[YY + j] = v
        tile[ZZ + j] = math.sqrt(p * p + 2.0 * shared)
        tile[XY + j] = math.sqrt(t * t + shared_time)


@fused_kernel
def _solve_equal(tile, width, slant, up_z, shared, shared_time):
    """As `_solve`, with equal weights."""
    s, m = np.empty(10), np.empty(10)
    for j in range(width):
        if tile[N + j] < 4.0:
            tile[XX + j] = tile[YY + j] = tile[ZZ + j] = tile[XY + j] = math.inf
            continue
        for k in range(10):
            s[k], m[k] = tile[k * TILE + j], tile[VXX + k * TILE + j]
        v2, p2, t2 = sandwich(tile[N + j], s, m, slant * tile[PX + j], slant * tile[PY + j], up_z)
        tile[XX + j] = math.sqrt(max(p2 - v2, 0.0) + 2.0 * shared) if p2 < math.inf else math.inf
        tile[YY + j] = math.sqrt(max(v2, 0.0))
        tile[ZZ + j] = math.sqrt(p2 + 2.0 * shared)
        tile[XY + j] = math.sqrt(max(t2, 0.0) + shared_time)


class Ranges(NamedTuple):
    """What ranges are worth over time.

    `q` (epoch, satellite, 10), m^2, see `range_variance`; `sun` (epoch, 3): direction of the Sun,
    Mars-fixed; `lit`: from `compass.core.ionosphere.sunlit_table`; `numbers` (`NUMBERS`,): shared.
    """

    q: Array
    sun: Array
    lit: Array
    numbers: Array


@kernel
def error_row(r, cos_cap, row, scratch, ranges, t, out):
    """Errors of a fix in every column of one row at one epoch.

    Parameters
    ----------
    r, cos_cap, row
        As in `compass.core.dop.dop_row`.
    scratch
        From `error_scratch`.
    ranges, t
        What they are worth, and at which of its epochs.
    out
        Filled; shape (4, column): horizontal, vertical, position, time; m, one sigma.
    """
    place, tile, runs, owners = row.place, scratch.tile, scratch.runs, scratch.owners
    q, sun, lit, numbers = ranges.q[t], ranges.sun[t], ranges.lit, ranges.numbers
    m = row.cos_lon.size
    total = row_runs(r, cos_cap, row, runs, owners)
    out_from_axis, high, square = place[OUT], place[HIGH], place[SQUARE]
    slant, up_z = place[UP_OUT] / out_from_axis, place[UP_Z]
    equal = numbers[EQUAL] > 0.0
    for start in range(0, m, TILE):
        width = min(TILE, m - start)
        tile[:] = 0.0
        for j in range(width):
            x, y = row.cos_lon[start + j], row.sin_lon[start + j]
            tile[PX + j], tile[PY + j] = out_from_axis * x, out_from_axis * y
            if numbers[DELAY2] > 0.0:
                up = (x * sun[0] + y * sun[1]) * place[UP_OUT] + sun[2] * up_z
                tile[SUNLIT + j] = sunlit(up, lit)
        for k in range(total):
            s = owners[k]
            for turn in range(2):
                a = max(runs[k, 0] - turn * m - start, 0)
                b = min(min(runs[k, 1] - turn * m, m) - start, width)
                if equal:
                    _add_equal_ranges(
                        tile, a, b, r[s, 0], r[s, 1], r[s, 2], high, square, slant, up_z, q[s],
                        numbers,
                    )  # fmt: skip
                else:
                    _add_ranges(
                        tile, a, b, r[s, 0], r[s, 1], r[s, 2], high, square, slant, up_z, q[s],
                        numbers,
                    )  # fmt: skip
        if equal:
            _solve_equal(tile, width, slant, up_z, numbers[SHARED], numbers[SHARED_TIME])
        else:
            _solve(tile, width, slant, up_z, numbers[SHARED], numbers[SHARED_TIME])
        for d in range(4):
            for j in range(width):
                out[d, start + j] = tile[d * TILE + j]


@kernel
def error_scratch(satellites, row):
    """Working space for `error_row`."""
    runs = most_runs(satellites, row)
    return Scratch(np.zeros(PARTS * TILE), np.empty((runs, 2), np.int64), np.empty(runs, np.int64))


@kernel
def error_map_row(
    r, cos_cap, row, ranges, limit, weight, good, errors, histograms
):  # fmt: skip
    """Errors of one row over all epochs.

    Parameters
    ----------
    r, cos_cap, row, ranges
        As in `error_row`, the first two with a leading epoch axis.
    limit
        Largest error that counts as within.
    weight
        Weight of a cell at an epoch in the histograms.
    good
        Filled; share of time within the limit, shape (4, column).
    errors
        Filled; shape (4, column, epoch): for order statistics over time.
    histograms
        Added to; shape (4, BINS + 1).
    """
    epochs, m = r.shape[0], row.cos_lon.size
    scratch = error_scratch(r.shape[1], row)
    row_errors, within = np.empty((4, m)), np.zeros((4, m))
    for t in range(epochs):
        error_row(r[t], cos_cap[t], row, scratch, ranges, t, row_errors)
        for d in range(4):
            for j in range(m):
                errors[d, j, t] = row_errors[d, j]
                within[d, j] += 1.0 if row_errors[d, j] <= limit else 0.0
            add_to_histogram(row_errors[d], weight, histograms[d])
    for d in range(4):
        for j in range(m):
            good[d, j] = within[d, j] / epochs


@kernel
def ranges_in_view(place, up, r, seen, ranges, t, lines, variances):
    """Fill unit vectors to the satellites that a user has in view, and variances; their number.

    Parameters
    ----------
    place, up
        Where the user is, in units of the equatorial radius, and the unit vector up, (3,).
    r, seen
        Satellites likewise, (satellite, 3), and which of them are in view.
    ranges, t
        What ranges are worth, and at which of its epochs.
    lines, variances
        Filled; shapes (satellite, 3) and (satellite,), m^2.
    """
    numbers, sun, lit, count = ranges.numbers, ranges.sun[t], 0.0, 0
    if numbers[DELAY2] > 0.0:
        lit = sunlit(up[0] * sun[0] + up[1] * sun[1] + up[2] * sun[2], ranges.lit)
    for s in range(r.shape[0]):
        if not seen[s]:
            continue
        x, y, z = r[s, 0] - place[0], r[s, 1] - place[1], r[s, 2] - place[2]
        w = 1.0 / math.sqrt(x * x + y * y + z * z)
        x, y, z = x * w, y * w, z * w
        sine = up[0] * x + up[1] * y + up[2] * z
        lines[count, 0], lines[count, 1], lines[count, 2] = x, y, z
        variances[count] = range_variance(x, y, z, w, sine, lit, ranges.q[t, s], numbers)
        count += 1
    return count


@kernel
def errors_over_time(places, ups, r, seen, ranges, out):
    """Errors of a fix of one user at every epoch.

    Parameters
    ----------
    places, ups, r, seen
        As of `ranges_in_view`, with a leading epoch axis.
    ranges
        What they are worth.
    out
        Filled, infinite without a fix; shape (epoch, 4): horizontal, vertical, position, time; m.
    """
    numbers, m, v = ranges.numbers, np.empty(10), np.empty(10)
    equal = numbers[EQUAL] > 0.0
    lines, variances = np.empty((r.shape[1], 3)), np.empty(r.shape[1])
    for t in range(places.shape[0]):
        up = ups[t]
        count = ranges_in_view(places[t], up, r[t], seen[t], ranges, t, lines, variances)
        m[:], v[:] = 0.0, 0.0
        for k in range(count):
            x, y, z = lines[k, 0], lines[k, 1], lines[k, 2]
            if equal:
                _add_moments(m, x, y, z, 1.0)
                _add_moments(v, x, y, z, variances[k])
            else:
                _add_moments(m, x, y, z, 1.0 / variances[k])
        out[t] = math.inf
        if count >= 4 and equal:
            v2, p2, t2 = sandwich(m[9], m, v, up[0], up[1], up[2])
            h2 = max(p2 - v2, 0.0) if p2 < math.inf else math.inf
        elif count >= 4:
            _, whole, level, height, time = weighted_dops(
                m[9], m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], up[0], up[1], up[2]
            )
            h2, v2, p2, t2 = level * level, height * height, whole * whole, time * time
        else:
            continue
        out[t, HORIZONTAL] = math.sqrt(h2 + 2.0 * numbers[SHARED])
        out[t, VERTICAL] = math.sqrt(max(v2, 0.0))
        out[t, POSITION] = math.sqrt(p2 + 2.0 * numbers[SHARED])
        out[t, TIME] = math.sqrt(max(t2, 0.0) + numbers[SHARED_TIME])


@inline_kernel
def _add_moments(m, x, y, z, weight):
    """Add a weighted line of sight to moments: xx, yy, zz, xy, xz, yz, x, y, z, sum of weights."""
    m[0] += weight * x * x
    m[1] += weight * y * y
    m[2] += weight * z * z
    m[3] += weight * x * y
    m[4] += weight * x * z
    m[5] += weight * y * z
    m[6] += weight * x
    m[7] += weight * y
    m[8] += weight * z
    m[9] += weight


def empty_error_histograms() -> np.ndarray:
    """Histograms of the errors, ready to be added to."""
    return np.zeros((4, BINS + 1))

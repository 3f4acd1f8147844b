"""Protection levels by solution separation, one faulty satellite at most.

The fix of all ranges is compared with the fixes that leave one range out each. With weights that
are the true variances the difference of two such fixes has the variance ``P_k - P_0``, and P_k is
``P_0 + w P_0 g g'P_0 / (1 - h)``, ``h = w g'P_0 g`` (Sherman and Morrison).

In each direction the level L solves (Working Group C, ARAIM Technical Subgroup 2016, Milestone 3
report; Reference Airborne Algorithm Description 3.0)
``2 Q((L - b_0)/s_0) + sum p_k Q((L - T_k - b_k)/s_k) = P_HMI less the unmonitored share``,
with the thresholds ``T_k = K s_ss,k`` and Q the tail of the normal distribution.

What all satellites have wrong alike (their frame's orientation) moves every one of those fixes the
same way: it adds to the s of each horizontal direction, and no comparison of fixes sees it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.dop import row_runs
from compass.core.error import DELAY2, SHARED, range_variance, ranges_in_view
from compass.core.ionosphere import sunlit
from compass.core.jit import kernel
from compass.core.ranking import BINS, add_to_histogram
from compass.core.runs import HIGH, OUT, UP_OUT, UP_Z, most_runs
from compass.core.smallmatrix import invert

#: Places among the numbers of a promise: P_sat, bias, share of the risk of each direction (east,
#: north, up), and the factor of thresholds of each.
FAULT, BIAS, RISK, FACTOR = 0, 1, 2, 5

#: A range whose leverage leaves less than this cannot be checked by the others.
UNCHECKED = 1e-9

#: Where correlations make a variance larger by this, rounding has made the geometry regular.
SINGULAR = 1e12

#: Halvings of the interval that holds a level: to 1e-6 of it.
HALVINGS = 24


@kernel
def tail(x):
    """Probability that a standard normal number exceeds x."""
    return 0.5 * math.erfc(x * 0.7071067811865476)


@kernel
def level(sigma, bias, sigmas, thresholds, biases, fault, risk):
    """Protection level of one direction, m: where the risk of exceeding it is what is allowed.

    Parameters
    ----------
    sigma, bias
        Of the fix of all ranges.
    sigmas, thresholds, biases
        Of the fixes without one range, and of their tests, shape (n,).
    fault
        Probability of each fault.
    risk
        Allowed.
    """
    high = bias + 8.0 * sigma
    for k in range(sigmas.size):
        high = max(high, thresholds[k] + biases[k] + 8.0 * sigmas[k])
    low = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        total = 2.0 * tail((middle - bias) / sigma)
        for k in range(sigmas.size):
            total += fault * tail((middle - thresholds[k] - biases[k]) / sigmas[k])
        if total > risk:
            low = middle
        else:
            high = middle
    return high


@kernel
def protect(g, variances, shared, numbers, unmonitored, levels):
    """Protection levels east, north and up of one user; False where no fault can be detected.

    Parameters
    ----------
    g
        Rows of the design matrix: east, north, up and clock, shape (n, 4).
    variances
        Of the ranges, m^2, shape (n,).
    shared
        Variance of a horizontal coordinate that all satellites share, m^2.
    numbers
        Of the promise: see above.
    unmonitored
        Share of the risk that faults of two satellites use up.
    levels
        Filled; shape (3,), m; infinite where there is none.
    """
    n = g.shape[0]
    levels[:] = math.inf
    if n < 5:
        return False
    normal, p, work = np.zeros((4, 4)), np.empty((4, 4)), np.empty((4, 4))
    for i in range(n):
        for a in range(4):
            for b in range(4):
                normal[a, b] += g[i, a] * g[i, b] / variances[i]
    if not invert(normal, p, work):
        return False
    for a in range(4):
        if p[a, a] * normal[a, a] > SINGULAR:
            return False
    pg = g @ p
    left = np.empty(n)
    for i in range(n):
        h = 0.0
        for a in range(4):
            h += pg[i, a] * g[i, a]
        left[i] = 1.0 - h / variances[i]
        if left[i] < UNCHECKED:
            return False
    if unmonitored >= 1.0:
        return True
    sigmas, thresholds, biases = np.empty(n), np.empty(n), np.zeros(n)
    for q in range(3):
        bias, alike = 0.0, p[q, q] + (shared if q < 2 else 0.0)
        for k in range(n):
            more = pg[k, q] * pg[k, q] / (variances[k] * left[k])
            sigmas[k] = math.sqrt(alike + more)
            thresholds[k] = numbers[FACTOR + q] * math.sqrt(more)
        if numbers[BIAS] > 0.0:
            for i in range(n):
                bias += numbers[BIAS] * abs(pg[i, q]) / variances[i]
            for k in range(n):
                biases[k] = 0.0
                for i in range(n):
                    if i != k:
                        between = 0.0
                        for a in range(4):
                            between += pg[k, a] * g[i, a]
                        row = pg[i, q] + pg[k, q] * between / (variances[k] * left[k])
                        biases[k] += numbers[BIAS] * abs(row) / variances[i]
        risk = numbers[RISK + q] * (1.0 - unmonitored)
        levels[q] = level(math.sqrt(alike), bias, sigmas, thresholds, biases, numbers[FAULT], risk)
    return True


class Promise(NamedTuple):
    """What users are promised.

    `numbers`: of the promise, as `protect` takes them; `unmonitored` (satellite + 1,): share of the
    risk that two faults use up, by number in view; `alerts` (2,): largest useful levels, horizontal
    and vertical, m.
    """

    numbers: NDArray[np.float64]
    unmonitored: NDArray[np.float64]
    alerts: NDArray[np.float64]


@kernel
def protection_row(
    r, cos_cap, row, ranges, promise, weight, levels, shares, histograms, total
):  # fmt: skip
    """Protection levels of one row of users over all epochs.

    Parameters
    ----------
    r, cos_cap, row, ranges
        As in `compass.core.error.error_map_row`.
    promise
        What is promised, see `Promise`.
    weight
        Weight of a cell at an epoch.
    levels
        Filled; horizontal and vertical, m, shape (2, column, epoch).
    shares
        Filled; of time with a fault detectable, and with both levels useful, shape (2, column).
    histograms
        Added to; shape (2, BINS + 1).
    total
        Added to: shares of area and time detectable, horizontal, vertical, both; shape (4,).
    """
    place, sun, alerts, numbers = row.place, ranges.sun, promise.alerts, ranges.numbers
    m, n = row.cos_lon.size, r.shape[1]
    runs = np.empty((most_runs(n, row), 2), np.int64)
    owners, seen = np.empty(len(runs), np.int64), np.zeros((m, n), np.bool_)
    g, variances, of_user = np.empty((n, 4)), np.empty(n), np.empty(3)
    level = np.empty((2, m))
    up_out, up_z, out, high = place[UP_OUT], place[UP_Z], place[OUT], place[HIGH]
    shares[:] = 0.0
    for t in range(r.shape[0]):
        count = row_runs(r[t], cos_cap[t], row, runs, owners)
        seen[:] = False
        for k in range(count):
            for j in range(runs[k, 0], runs[k, 1]):
                seen[j % m, owners[k]] = True
        for j in range(m):
            c, s = row.cos_lon[j], row.sin_lon[j]
            shade = (
                sunlit((c * sun[t, 0] + s * sun[t, 1]) * up_out + sun[t, 2] * up_z, ranges.lit)
                if (numbers[DELAY2] > 0.0)
                else 0.0
            )
            size = 0
            for k in range(n):
                if seen[j, k]:
                    dx, dy, dz = r[t, k, 0] - out * c, r[t, k, 1] - out * s, r[t, k, 2] - high
                    w = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
                    x, y, z = dx * w, dy * w, dz * w
                    outward = x * c + y * s
                    sine = outward * up_out + z * up_z
                    g[size, 0], g[size, 1] = s * x - c * y, outward * up_z - z * up_out
                    g[size, 2], g[size, 3] = -sine, 1.0
                    variances[size] = range_variance(
                        x, y, z, w, sine, shade, ranges.q[t, k], numbers
                    )
                    size += 1
            able = protect(
                g[:size],
                variances[:size],
                numbers[SHARED],
                promise.numbers,
                promise.unmonitored[size],
                of_user,
            )
            level[0, j] = math.sqrt(of_user[0] * of_user[0] + of_user[1] * of_user[1])
            level[1, j] = of_user[2]
            flat, tall = level[0, j] <= alerts[0], level[1, j] <= alerts[1]
            shares[0, j] += able
            shares[1, j] += flat and tall
            total[0] += weight * able
            total[1] += weight * flat
            total[2] += weight * tall
            total[3] += weight * (flat and tall)
            levels[0, j, t], levels[1, j, t] = level[0, j], level[1, j]
        for d in range(2):
            add_to_histogram(level[d], weight, histograms[d])
    for d in range(2):
        for j in range(m):
            shares[d, j] /= r.shape[0]


@kernel
def levels_over_time(places, axes, r, seen, ranges, promise, out, able):
    """Protection levels of one user at every epoch.

    Parameters
    ----------
    places, r, seen, ranges
        As of `compass.core.error.errors_over_time`.
    axes
        Unit vectors east, north and up there, rows, (epoch, 3, 3).
    promise
        What is promised, see `Promise`.
    out, able
        Filled; levels, infinite where there is none, shape (epoch, 2): horizontal and vertical, m;
        whether a fault can be detected, shape (epoch,).
    """
    n = r.shape[1]
    lines, variances, levels = np.empty((n, 3)), np.empty(n), np.empty(3)
    g = np.ones((n, 4))
    for t in range(places.shape[0]):
        size = ranges_in_view(places[t], axes[t, 2], r[t], seen[t], ranges, t, lines, variances)
        for k in range(size):
            for d in range(3):
                g[k, d] = -(
                    axes[t, d, 0] * lines[k, 0]
                    + axes[t, d, 1] * lines[k, 1]
                    + axes[t, d, 2] * lines[k, 2]
                )
        able[t] = protect(
            g[:size],
            variances[:size],
            ranges.numbers[SHARED],
            promise.numbers,
            promise.unmonitored[size],
            levels,
        )
        out[t, 0] = math.sqrt(levels[0] * levels[0] + levels[1] * levels[1])
        out[t, 1] = levels[2]


def empty_level_histograms() -> np.ndarray:
    """Histograms of the levels, ready to be added to."""
    return np.zeros((2, BINS + 1))

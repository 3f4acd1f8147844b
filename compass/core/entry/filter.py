"""Kalman filters on Cartesian states and further blocks: predict, update, one run.

States: position and velocity (6), then the blocks that `places` names. Those behind the estimated
ones are considered (Schmidt): the filter knows how uncertain they are and lets that uncertainty
into its covariance, but does not correct them.

How a filter moves on (see `PLAIN`) matters where density or L/D are badly known. An extended filter
linearises about what it believes, and what it has learnt so far keeps the slope of that moment:
with density known to 20 % a few dozen ranges in the first air leave it sure of a wrong value.
`RELINEARISED` goes back: whenever it knows one of the two twice as well as when it last did, it
flies backwards from what it believes, and hears all measurements again about that flight. Where
states are shaken or the density wanders there is no such flight; there `UNSCENTED` takes mean and
covariance through points spread as its belief is.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.flow import advance_spread, advance_transition, bank_at, retreat
from compass.core.entry.kinds import INFORMATION, RELINEARISED, ROOTED, UNSCENTED
from compass.core.entry.measure import AIR, ATTITUDE, CLOCK, ESTIMATED, GYRO, LIFT, added, measured
from compass.core.entry.rates import COLUMNS, OF_AIR, OF_LIFT
from compass.core.entry.rates import LIFT as RATIO
from compass.core.entry.root import absorb_root, root_of, square_of, triangle
from compass.core.jit import fast_kernel, inline_kernel, kernel
from compass.core.smallmatrix import invert


class Problem(NamedTuple):
    """What is to be estimated along a flight; made by `compass.entry.covariance.problem_of`.

    Attributes
    ----------
    p, bank
        Parameters of the dynamics, and bank angles (k, 2) of `advance`.
    times, longest
        Epochs (t,) and the longest Runge-Kutta step, s.
    noise, walk, fade
        From the epoch before to each: roots of the process noise, (t, 6, 6) or (t, 0, 6) for
        none, variances of the further states, (t, s), and what is left of the logarithm of the
        density, (t,).
    sources, variances, kinds
        Positions and velocities (t, n, 6); variances (t, n, c), nan for what is not measured, of
        the kinds (c,) of `compass.core.entry.measure`.
    places
        Where the blocks of the state are.
    """

    p: NDArray[np.float64]
    bank: NDArray[np.float64]
    times: NDArray[np.float64]
    longest: float
    noise: NDArray[np.float64]
    walk: NDArray[np.float64]
    fade: NDArray[np.float64]
    sources: NDArray[np.float64]
    variances: NDArray[np.float64]
    kinds: NDArray[np.int64]
    places: NDArray[np.int64]


@inline_kernel
def rate_of(i, places):
    """State by which state i grows each second, -1 for none: drift of a clock, or of axes."""
    if i == places[CLOCK]:
        return i + 1
    if places[GYRO] >= 0 and 0 <= i - places[ATTITUDE] < 3:
        return places[GYRO] + i - places[ATTITUDE]
    return -1


@fast_kernel
def moved_rows(phi, dt, fade, places, matrix, out):
    """``F A`` of a matrix A (s, k), F made as in `moved_covariance`."""
    air, lift = places[AIR], places[LIFT]
    for i in range(6):
        for j in range(matrix.shape[1]):
            total = 0.0
            for k in range(6):
                total += phi[i, k] * matrix[k, j]
            if air >= 0:
                total += phi[i, OF_AIR] * matrix[air, j]
            if lift >= 0:
                total += phi[i, OF_LIFT] * matrix[lift, j]
            out[i, j] = total
    for i in range(6, matrix.shape[0]):
        rate = rate_of(i, places)
        for j in range(matrix.shape[1]):
            out[i, j] = fade * matrix[i, j] if i == air else matrix[i, j]
            if rate >= 0:
                out[i, j] += dt * matrix[rate, j]


@kernel
def moved_root(phi, dt, noise, walk, fade, places, root):
    """As `moved_covariance`, of the root S: the triangle of ``[F S, G, W^(1/2)]``."""
    size, shaken = root.shape[0], noise.shape[1]
    rows = np.zeros((size, 2 * size + shaken))
    moved_rows(phi, dt, fade, places, root, rows[:, :size])
    rows[:6, size : size + shaken] = noise
    for i in range(6, size):
        rows[i, size + shaken + i] = math.sqrt(walk[i])
    triangle(rows, root)


@fast_kernel
def moved_covariance(phi, dt, noise, walk, fade, places, half, covariance):
    """``P = F P F^T + G G^T + W`` in place, with F made of `phi` and of what stays as it is.

    Parameters
    ----------
    phi
        Derivative of position and velocity, (6, 8), of `advance_transition`.
    dt
        Seconds.
    noise
        G (6, k): root of the process noise of the step.
    walk, fade
        Variance that all states but the first six gather over the step, (s,), and what is left
        of the logarithm of the density at its end.
    places
        See `compass.core.entry.measure.PLACES`.
    half
        Scratch, (s, s).
    covariance
        P, (s, s).
    """
    size = covariance.shape[0]
    air, lift = places[AIR], places[LIFT]
    moved_rows(phi, dt, fade, places, covariance, half)
    for i in range(size):
        for j in range(min(i + 1, 6)):
            total = 0.0
            for k in range(6):
                total += half[i, k] * phi[j, k]
            if air >= 0:
                total += half[i, air] * phi[j, OF_AIR]
            if lift >= 0:
                total += half[i, lift] * phi[j, OF_LIFT]
            if i < 6:
                for k in range(noise.shape[1]):
                    total += noise[i, k] * noise[j, k]
            covariance[i, j] = total
            covariance[j, i] = total
        for j in range(6, i + 1):
            value = fade * half[i, j] if j == air else half[i, j]
            rate = rate_of(j, places)
            if rate >= 0:
                value += dt * half[i, rate]
            covariance[i, j] = value
            covariance[j, i] = value
        if i >= 6:
            covariance[i, i] += walk[i]


@fast_kernel
def absorb(row, residual, variance, estimated, gain, covariance, shift):
    """Update by one measurement, linear in the state: `shift` and `covariance` change.

    ``g = P h``, ``s = h g + R``: ``shift += g/s (residual - h shift)`` on the estimated states and
    ``P -= g g^T / s`` but for the considered ones among themselves, which is Joseph's form with
    Schmidt's gain.
    """
    size = row.size
    s = variance
    for i in range(size):
        gain[i] = 0.0
    for j in range(size):
        if row[j] != 0.0:  # a range knows three states and a bias
            for i in range(size):
                gain[i] += covariance[j, i] * row[j]
    for i in range(size):
        s += row[i] * gain[i]
        residual -= row[i] * shift[i]
    for i in range(size):
        scaled = gain[i] / s
        if i < estimated:
            shift[i] += scaled * residual
        for j in range(min(i + 1, estimated)):
            value = covariance[i, j] - scaled * gain[j]
            covariance[i, j] = value
            covariance[j, i] = value


@kernel
def informed(y, gathered, covariance, shift):
    """``P = Y^-1`` and ``shift = P y``; not a number where Y is not positive definite."""
    if not invert(y, covariance, np.empty(y.shape)):
        covariance[:, :] = np.nan
    for i in range(shift.size):
        shift[i] = 0.0
        for j in range(shift.size):
            shift[i] += covariance[i, j] * gathered[j]


@kernel
def update(x, covariance, base, problem, t, z, iterations, method):
    """Update with what is measured at epoch t, linearised at `base` and iterated from there.

    That is z (n, c), nan for what is not measured. `covariance` is its root for a filter that
    carries that. In the form of `INFORMATION` all measurements of the epoch are gathered first,
    ``Y = P^-1 + sum h^T h / R``, and inverted once.

    Gauss-Newton on the posterior: each pass linearises at the latest estimate and starts again
    from the prior; one pass from ``base = x`` is the plain extended Kalman filter.
    """
    p, bank, times, _, _, _, _, sources, variances, kinds, places = problem
    angle, size = bank[bank_at(times[t], bank), 1], x.size
    prior, shift, before = covariance.copy(), np.empty(size), np.empty(size)
    rows, gain, point = np.zeros((kinds.size, size)), np.empty(size), np.empty(size)
    first, y = np.empty((size, size)), np.empty((size, size))
    if method == INFORMATION:
        informed(prior, shift, first, before)
    for i in range(size):
        shift[i] = base[i] - x[i]
    for _ in range(iterations):
        for i in range(size):
            before[i] = shift[i]
            point[i] = x[i] + shift[i]
            shift[i] = 0.0
        covariance[:, :] = prior
        if method == INFORMATION:
            y[:, :] = first
            gain[:] = 0.0
        for b in range(sources.shape[1]):
            for c in range(kinds.size):
                if math.isnan(z[b, c]):
                    continue
                row, variance = rows[c], variances[t, b, c]
                residual = z[b, c] - measured(
                    kinds[c], point, sources[t, b], b, places, p, angle, row
                )
                for i in range(size):
                    residual += row[i] * before[i]
                if method == INFORMATION:
                    for i in range(size):
                        share = row[i] / variance
                        gain[i] += share * residual
                        for j in range(size):
                            y[i, j] += share * row[j]
                    continue
                if method == ROOTED:
                    absorb_root(row, residual, variance, places[ESTIMATED], gain, covariance, shift)
                    continue
                absorb(row, residual, variance, places[ESTIMATED], gain, covariance, shift)
        if method == INFORMATION:
            informed(y, gain, covariance, shift)
        change = 0.0
        for i in range(places[ESTIMATED]):
            square = prior[i, i]
            if method == ROOTED:
                square = (prior[i] * prior[i]).sum()
            change = max(change, abs(shift[i] - before[i]) / math.sqrt(square))
        if change < 1e-9:
            break
    for i in range(size):
        x[i] += shift[i]


@kernel
def spread_factor(covariance, places, factor):
    """Cholesky factor of what moves: position, velocity, density, L/D; a known one's is zero."""
    for i in range(COLUMNS):
        at = i if i < 6 else places[AIR] if i == OF_AIR else places[LIFT]
        for j in range(i + 1):
            other = j if j < 6 else places[AIR] if j == OF_AIR else places[LIFT]
            factor[j, i] = 0.0
            total = covariance[at, other] if at >= 0 and other >= 0 else 0.0
            for k in range(j):
                total -= factor[i, k] * factor[j, k]
            if i == j:
                factor[i, i] = math.sqrt(total)
            else:
                factor[i, j] = total / factor[j, j] if factor[j, j] > 0.0 else 0.0


@kernel
def move(x, covariance, base, problem, t, method, half):
    """Move an estimate to epoch t from that before, linearised at `base` (which may be `x`)."""
    p, bank, longest, places = problem.p, problem.bank, problem.longest, problem.places
    start, stop = problem.times[t - 1], problem.times[t]
    noise, walk, fade = problem.noise[t], problem.walk[t], problem.fade[t]
    after, phi = np.empty(6), np.empty((6, COLUMNS))
    roots, shaken = np.zeros((6, 6 + COLUMNS)), noise.shape[0]
    for i in range(shaken):
        for j in range(6):
            roots[i, j] = noise[i, j]
    air, lift, count = places[AIR], places[LIFT], shaken
    thicker, ratio = added(base, air), p[RATIO] + added(base, lift)
    if method == UNSCENTED:
        factor, bend = np.empty((COLUMNS, COLUMNS)), np.empty((6, COLUMNS))
        spread_factor(covariance, places, factor)
        advance_spread(
            base, factor, thicker, ratio, p, bank, start, stop, longest, after, phi, bend
        )
        roots[:, 6:] = bend
        count = 6 + COLUMNS
    else:
        advance_transition(base, thicker, ratio, p, bank, start, stop, longest, after, phi)
    if method == ROOTED:
        moved_root(phi, stop - start, roots[:, :count], walk, fade, places, covariance)
    else:
        moved_covariance(phi, stop - start, roots[:, :count], walk, fade, places, half, covariance)
    for i in range(6):
        for k in range(6):
            after[i] += phi[i, k] * (x[k] - base[k])
        if air >= 0:
            after[i] += phi[i, OF_AIR] * (x[air] - base[air])
        if lift >= 0:
            after[i] += phi[i, OF_LIFT] * (x[lift] - base[lift])
    for i in range(6):
        x[i] = after[i]
    for i in range(6, x.size):
        rate = rate_of(i, places)
        if rate >= 0:
            x[i] += (stop - start) * x[rate]
    if air >= 0:
        x[air] *= fade


@kernel
def halved(covariance, places, marks):
    """Whether density or L/D is known twice as well as at the marks (2), which then move."""
    found = False
    for k in range(2):
        at = places[AIR] if k == 0 else places[LIFT]
        if 0 <= at < places[ESTIMATED] and math.sqrt(covariance[at, at]) < 0.5 * marks[k]:
            found = True
    if found:
        mark(covariance, places, marks)
    return found


@kernel
def mark(covariance, places, marks):
    """Write how well density and L/D are known, (2,)."""
    for k in range(2):
        at = places[AIR] if k == 0 else places[LIFT]
        marks[k] = math.sqrt(covariance[at, at]) if at >= 0 else 0.0


@kernel
def filter_run(x0, covariance0, problem, z, iterations, method, xs, ps):
    """One filter run.

    Parameters
    ----------
    x0, covariance0
        Estimate (s,) and its covariance at the first time, before that time's measurements.
    problem, z
        The `Problem`, and its measurements (t, n, c); nan for what is not measured.
    iterations, method
        The passes of the update, and the way of filtering.
    xs, ps
        Outputs after each update, (t, s) and (t, s, s).
    """
    p, bank, times, longest, places = (
        problem.p, problem.bank, problem.times, problem.longest, problem.places
    )  # fmt: skip
    x, covariance, half = x0.copy(), covariance0.copy(), np.empty(covariance0.shape)
    back = times.size if method == RELINEARISED else 0
    path, marks = np.empty((back, x.size)), np.empty(2)
    mark(covariance, places, marks)
    if method == ROOTED:
        root_of(covariance0, covariance)
    for t in range(times.size):
        if t > 0:
            move(x, covariance, x, problem, t, method, half)
        update(x, covariance, x, problem, t, z[t], iterations, method)
        if method == RELINEARISED and halved(covariance, places, marks):
            path[t] = x
            for k in range(t, 0, -1):
                path[k - 1] = x
                retreat(
                    path[k], added(x, places[AIR]), p[RATIO] + added(x, places[LIFT]), p, bank,
                    times[k], times[k - 1], longest, path[k - 1],
                )  # fmt: skip
            x[:] = x0
            covariance[:, :] = covariance0
            for k in range(t + 1):
                if k > 0:
                    move(x, covariance, path[k - 1], problem, k, method, half)
                update(x, covariance, path[k], problem, k, z[k], 1, method)
        xs[t] = x
        if method == ROOTED:
            square_of(covariance, ps[t])
        else:
            ps[t] = covariance


@kernel
def covariance_run(path, covariance0, problem, method, ps):
    """Linear covariance along a flight: what `filter_run` would claim at the true states.

    With the states known that is the posterior Cramer-Rao bound,
    ``J_k = (Q + Phi J_(k-1)^-1 Phi^T)^-1 + H^T R^-1 H`` carried as ``P = J^-1``. Parameters as in
    `filter_run`; `path` is the flight at the epochs, (t, 6), `method` `PLAIN` or `ROOTED`.
    """
    p, bank, times, _, _, _, _, sources, variances, kinds, places = problem
    size = covariance0.shape[0]
    covariance, half = covariance0.copy(), np.empty((size, size))
    rows, gain = np.zeros((kinds.size, size)), np.empty(size)
    x, shift = np.zeros(size), np.zeros(size)
    if method == ROOTED:
        root_of(covariance0, covariance)
    for t in range(times.size):
        if t > 0:
            move(x, covariance, x, problem, t, method, half)
        for i in range(6):
            x[i] = path[t, i]
        angle = bank[bank_at(times[t], bank), 1]
        for b in range(sources.shape[1]):
            for c in range(kinds.size):
                variance = variances[t, b, c]
                if math.isnan(variance):
                    continue
                measured(kinds[c], x, sources[t, b], b, places, p, angle, rows[c])
                if method == ROOTED:
                    absorb_root(rows[c], 0.0, variance, places[ESTIMATED], gain, covariance, shift)
                else:
                    absorb(rows[c], 0.0, variance, places[ESTIMATED], gain, covariance, shift)
        if method == ROOTED:
            square_of(covariance, ps[t])
        else:
            ps[t] = covariance

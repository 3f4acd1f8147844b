"""Extended Kalman filter on the six entry states: one run, many runs, and the bound they obey."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.runs import normalised_square
from compass.core.jit import kernel
from compass.core.papers.spherical import BANK, STATES, rk4_step, rk4_step_transition
from compass.core.papers.spherical_geometry import cartesian, cartesian_jacobian, range_rows

Array = NDArray[np.float64]


@kernel
def _predict(x, covariance, p, dt, noise, after, phi):
    """Move the mean by a Runge-Kutta step and the covariance by its derivative, plus noise."""
    rk4_step_transition(x, p, dt, after, phi)
    half = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += phi[i, k] * covariance[k, j]
            half[i, j] = total
    for i in range(6):
        for j in range(i + 1):
            total = 0.0
            for k in range(6):
                total += half[i, k] * phi[j, k]
            covariance[i, j] = total
            covariance[j, i] = total
        covariance[i, i] += noise[i] * dt


@kernel
def _absorb(row, residual, variance, covariance, shift):
    """Update by one scalar measurement, linear in the state: ``shift`` and covariance change.

    ``P - g g^T / s`` with ``g = P h``, ``s = h g + R``: symmetric by construction, and equal to
    Joseph's form for the gain in use.
    """
    g = np.empty(6)
    s = variance
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += covariance[i, j] * row[j]
        g[i] = total
    for i in range(6):
        s += row[i] * g[i]
        residual -= row[i] * shift[i]
    for i in range(6):
        shift[i] += g[i] * residual / s
        for j in range(i + 1):
            value = covariance[i, j] - g[i] * g[j] / s
            covariance[i, j] = value
            covariance[j, i] = value


@kernel
def _update(x, covariance, r, v, taken, variances, z, iterations):
    """Update with all ranges and range rates of an epoch; iterated about the new mean.

    Gauss-Newton on the posterior: each pass linearises at the latest estimate and starts again
    from the prior; one pass is the plain extended Kalman filter.
    """
    prior, shift, before = covariance.copy(), np.zeros(6), np.empty(6)
    range_row, rate_row = np.empty(6), np.empty(6)
    c, jc, point = np.empty(6), np.empty((6, 6)), x.copy()
    for _ in range(iterations):
        for i in range(6):
            before[i] = shift[i]
            point[i] = x[i] + shift[i]
            shift[i] = 0.0
        covariance[:, :] = prior
        cartesian(point, c)
        cartesian_jacobian(point, jc)
        for b in range(r.shape[0]):
            if not taken[b]:
                continue
            distance, rate = range_rows(c, r[b], v[b], jc, range_row, rate_row)
            for kind in range(2):
                if math.isnan(variances[kind]):
                    continue
                row = range_row if kind == 0 else rate_row
                residual = z[b, kind] - (distance if kind == 0 else rate)
                for i in range(6):
                    residual += row[i] * before[i]
                _absorb(row, residual, variances[kind], covariance, shift)
        change = 0.0
        for i in range(6):
            change = max(change, abs(shift[i] - before[i]) / math.sqrt(prior[i, i]))
        if change < 1e-9:
            break
    for i in range(6):
        x[i] += shift[i]


class Course(NamedTuple):
    """How the filter's world moves from time to time.

    `p` are the parameters of the dynamics, `banks` (t,) the bank angles and `times` (t,) the
    epochs, s: one Runge-Kutta step from each to the next. `noise` (6,) is the process noise
    variance per second of the six states.
    """

    p: Array
    banks: Array
    times: Array
    noise: Array


class Sights(NamedTuple):
    """What is measured: beacons `r`, `v` (t, n, 3), and which are `taken` (t, n).

    `variances` (2,) are those of ranges and of range rates, nan for one that is not measured.
    """

    r: Array
    v: Array
    taken: NDArray[np.bool_]
    variances: Array


class Start(NamedTuple):
    """First estimate `x` (8,), its covariance (6, 6) and a root of it, from which runs draw."""

    x: Array
    covariance: Array
    root: Array


class Draws(NamedTuple):
    """Standard normal: of first estimates (m, 6), measurements (m, t, n, 2), states (m, t, 6)."""

    first: Array
    heard: Array
    shaken: Array


@kernel
def filter_run(x0, covariance0, course, sights, z, iterations, xs, ps):
    """One filter run.

    Parameters
    ----------
    x0, covariance0
        Estimate (8) and its covariance (6, 6) at the first time, before that time's measurements.
    course, sights
        `Course`, `Sights`.
    z
        Measurements, (t, n, 2).
    iterations
        Passes of the update.
    xs, ps
        Outputs after each update, (t, 6) and (t, 6, 6).
    """
    p, banks, times, noise = course
    r, v, taken, variances = sights
    p = p.copy()
    x, covariance = x0.copy(), covariance0.copy()
    after, phi = np.empty(STATES), np.empty((STATES, STATES))
    for t in range(times.size):
        if t > 0:
            p[BANK] = banks[t - 1]
            _predict(x, covariance, p, times[t] - times[t - 1], noise, after, phi)
            x[:] = after
        _update(x, covariance, r[t], v[t], taken[t], variances, z[t], iterations)
        xs[t] = x[:6]
        ps[t] = covariance


@kernel
def measure(states, r, v, out):
    """Ranges and range rates without noise, (t, n, 2), from states (t, >= 6)."""
    c = np.empty(6)
    for t in range(states.shape[0]):
        cartesian(states[t], c)
        for b in range(r.shape[1]):
            square, product = 0.0, 0.0
            for i in range(3):
                d = c[i] - r[t, b, i]
                square += d * d
                product += d * (c[3 + i] - v[t, b, i])
            distance = math.sqrt(square)
            out[t, b, 0] = distance
            out[t, b, 1] = product / distance


@kernel
def monte_carlo(truth0, p_true, start, course, sights, iterations, draws, errors, squares, sigmas):
    """Run the filter many times: errors in position and velocity, NEES and claimed sigmas.

    Each run draws the first estimate about that of `start`, measurement noise and process noise;
    `truth0` and `p_true` fly the truth. `Course`, `Sights` and `iterations` as in `filter_run`;
    m runs take `Draws`. Outputs: `errors` (m, t, 6) Cartesian, m and m/s; `squares` (m, t), NEES of
    the six states; `sigmas` (m, t, 2), root of the trace of the position and of the velocity
    covariance.
    """
    x0, covariance0, root0 = start
    _p, banks, times, noise = course
    r, v, _taken, variances = sights
    first, heard, shaken = draws
    runs, epochs, n = errors.shape[0], times.size, r.shape[1]
    truth, xs, ps = np.empty((epochs, STATES)), np.empty((epochs, 6)), np.empty((epochs, 6, 6))
    z, drawn, p_true = np.empty((epochs, n, 2)), x0.copy(), p_true.copy()
    c, estimate, jc, difference = np.empty(6), np.empty(6), np.empty((6, 6)), np.empty(6)
    for m in range(runs):
        truth[0] = truth0
        for t in range(1, epochs):
            p_true[BANK] = banks[t - 1]
            dt = times[t] - times[t - 1]
            rk4_step(truth[t - 1], p_true, dt, truth[t])
            for i in range(6):
                truth[t, i] += math.sqrt(noise[i] * dt) * shaken[m, t, i]
        measure(truth, r, v, z)
        for t in range(epochs):
            for b in range(n):
                for kind in range(2):
                    if not math.isnan(variances[kind]):
                        z[t, b, kind] += math.sqrt(variances[kind]) * heard[m, t, b, kind]
        for i in range(6):
            drawn[i] = x0[i]
            for j in range(i + 1):
                drawn[i] += root0[i, j] * first[m, j]
        filter_run(drawn, covariance0, course, sights, z, iterations, xs, ps)
        for t in range(epochs):
            cartesian(truth[t], c)
            cartesian(xs[t], estimate)
            for i in range(6):
                errors[m, t, i] = estimate[i] - c[i]
                difference[i] = xs[t, i] - truth[t, i]
            squares[m, t] = normalised_square(ps[t], difference)
            cartesian_jacobian(xs[t], jc)
            spread(ps[t], jc, sigmas[m, t])


@kernel
def spread(covariance, jacobian, out):
    """Root of the trace of the position and of the velocity part of ``J P J^T``, into `out`."""
    for part in range(2):
        total = 0.0
        for i in range(3 * part, 3 * part + 3):
            for a in range(6):
                for b in range(6):
                    total += jacobian[i, a] * covariance[a, b] * jacobian[i, b]
        out[part] = math.sqrt(total)


@kernel
def posterior_bound(states, covariance0, course, sights, ps):
    """Recursive Cramer-Rao bound along a trajectory: covariances (t, 6, 6) after each epoch.

    ``J_k = (Q + Phi J_(k-1)^-1 Phi^T)^-1 + H^T R^-1 H``, carried as ``P = J^-1`` (the matrix
    inversion lemma, one measurement at a time), with Phi and H at the true states.
    """
    p, banks, times, noise = course
    r, v, taken, variances = sights
    p = p.copy()
    covariance = covariance0.copy()
    after, phi, shift = np.empty(STATES), np.empty((STATES, STATES)), np.zeros(6)
    c, jc, range_row, rate_row = np.empty(6), np.empty((6, 6)), np.empty(6), np.empty(6)
    for t in range(times.size):
        if t > 0:
            p[BANK] = banks[t - 1]
            _predict(states[t - 1], covariance, p, times[t] - times[t - 1], noise, after, phi)
        cartesian(states[t], c)
        cartesian_jacobian(states[t], jc)
        for b in range(r.shape[1]):
            if not taken[t, b]:
                continue
            range_rows(c, r[t, b], v[t, b], jc, range_row, rate_row)
            for kind in range(2):
                if not math.isnan(variances[kind]):
                    row = range_row if kind == 0 else rate_row
                    _absorb(row, 0.0, variances[kind], covariance, shift)
        ps[t] = covariance

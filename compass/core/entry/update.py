"""What measurements change: one row by Schmidt's gain, or all of an epoch, iterated."""

import math

import numpy as np

from compass.core.entry.flow import bank_at
from compass.core.entry.kinds import INFORMATION, ROOTED
from compass.core.entry.measure import ESTIMATED, measured
from compass.core.entry.root import absorb_root
from compass.core.jit import fast_kernel, kernel
from compass.core.smallmatrix import invert


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
def update(x, covariance, base, problem, t, z, variances, iterations, method):
    """Update with what is measured at epoch t, linearised at `base` and iterated from there.

    That is z (n, c), nan for what is not measured, with `variances` (n, c). `covariance` is its
    root for a filter that carries that. In the form of `INFORMATION` all measurements of the epoch
    are gathered first, ``Y = P^-1 + sum h^T h / R``, and inverted once.

    Gauss-Newton on the posterior: each pass linearises at the latest estimate and starts again
    from the prior; one pass from ``base = x`` is the plain extended Kalman filter.
    """
    p, bank, kinds, places, sources = (
        problem.p, problem.bank, problem.kinds, problem.places, problem.sources
    )  # fmt: skip
    angle, size = bank[bank_at(problem.times[t], bank), 1], x.size
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
                row, variance = rows[c], variances[b, c]
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
        if iterations == 1:
            break
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

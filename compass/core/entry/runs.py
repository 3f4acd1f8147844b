"""Many runs of one filter against one true flight: errors, consistency, what it claims."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.filter import filter_run
from compass.core.entry.flow import advance
from compass.core.entry.measure import AIR, ESTIMATED, LIFT, added, ideal_values
from compass.core.entry.predict import rate_of
from compass.core.entry.rates import LIFT as RATIO
from compass.core.jit import kernel


@kernel
def normalised_square(covariance, error):
    """``e^T P^-1 e`` by Cholesky of the correlation matrix; nan if P is not positive definite."""
    n = error.size
    low, y = np.zeros((n, n)), np.empty(n)
    total = 0.0
    for i in range(n):
        si = math.sqrt(covariance[i, i])
        for j in range(i + 1):
            value = covariance[i, j] / (si * math.sqrt(covariance[j, j]))
            for k in range(j):
                value -= low[i, k] * low[j, k]
            if i == j:
                if not value > 0.0:
                    return np.nan
                low[i, i] = math.sqrt(value)
            else:
                low[i, j] = value / low[j, j]
        value = error[i] / si
        for k in range(i):
            value -= low[i, k] * y[k]
        y[i] = value / low[i, i]
        total += y[i] * y[i]
    return total


class Draws(NamedTuple):
    """Standard normal draws of m runs, and what scales the first.

    The root (s, s) of the first covariance, draws of the first state (m, s), of what is measured
    (m, t, n, c), nan where nothing arrives in a run, and of what shakes (m, t, s).
    """

    root: NDArray[np.float64]
    first: NDArray[np.float64]
    measured: NDArray[np.float64]
    shaken: NDArray[np.float64]


@kernel
def monte_carlo(
    path, p_true, covariance0, problem, iterations, method, draws, errors, squares, sigmas
):
    """Run the filter many times against the true flight.

    Without process noise the truth is `path` itself, however far apart the epochs are; with it,
    the truth is moved from its own last state, by the same steps as the filter's, and shaken, and
    so it is where the density wanders. All other blocks begin at zero in truth and gather what
    `walk` says; the first estimate is drawn about the truth, and where the density wanders, the
    truth about the estimate.

    Parameters
    ----------
    path, p_true
        The true flight at the epochs, (t, 6), and the parameters it was flown with.
    covariance0, problem, iterations, method
        As in `filter_run`.
    draws
        What the runs have by chance.
    errors
        Output, (m, t, 6), estimate minus truth.
    squares
        Output, (m, t, 2): normalised error squared of position and velocity, and of all states
        that are estimated.
    sigmas
        Output, (m, t, 2): roots of the traces of the covariance of position and of velocity.
    """
    _, bank, times, longest, noise, walk, fade, sources, variances, kinds, places = problem
    runs, epochs, size = errors.shape[0], times.size, covariance0.shape[0]
    truth = np.zeros((epochs, size))
    truth[:, :6] = path
    xs, ps = np.empty((epochs, size)), np.empty((epochs, size, size))
    ideal, z = np.empty(variances.shape), np.empty(variances.shape)
    start, difference = np.empty(size), np.empty(size)
    estimated, shaken = places[ESTIMATED], noise.shape[1] > 0
    air, wanders, walks = places[AIR], fade.min() < 1.0, walk.max() > 0.0
    ideal_values(truth, sources, kinds, places, p_true, bank, times, ideal)
    for m in range(runs):
        for i in range(size):
            start[i] = 0.0
            for j in range(i + 1):
                start[i] += draws.root[i, j] * draws.first[m, j]
        if wanders:
            truth[0, air] = -start[air]
            start[air] = 0.0
        if walks:
            for t in range(1, epochs):
                for i in range(6, size):
                    kept, rate = fade[t] if i == air else 1.0, rate_of(i, places)
                    truth[t, i] = kept * truth[t - 1, i]
                    if rate >= 0:
                        truth[t, i] += (times[t] - times[t - 1]) * truth[t - 1, rate]
                    truth[t, i] += math.sqrt(walk[t, i]) * draws.shaken[m, t, i]
        if shaken or wanders:
            for t in range(1, epochs):
                advance(
                    truth[t - 1], added(truth[t - 1], air),
                    p_true[RATIO] + added(truth[t - 1], places[LIFT]), p_true, bank,
                    times[t - 1], times[t], longest, truth[t],
                )  # fmt: skip
                for i in range(noise.shape[1]):
                    for j in range(6):
                        truth[t, i] += noise[t, i, j] * draws.shaken[m, t, j]
        if shaken or walks:
            ideal_values(truth, sources, kinds, places, p_true, bank, times, ideal)
        for i in range(6):
            start[i] += truth[0, i]
        for t in range(epochs):
            for b in range(z.shape[1]):
                for c in range(z.shape[2]):
                    sigma = math.sqrt(variances[t, b, c])
                    z[t, b, c] = ideal[t, b, c] + sigma * draws.measured[m, t, b, c]
        filter_run(start, covariance0, problem, z, iterations, method, xs, ps)
        for t in range(epochs):
            for i in range(size):
                difference[i] = xs[t, i] - truth[t, i]
            for i in range(6):
                errors[m, t, i] = difference[i]
            squares[m, t, 0] = normalised_square(ps[t, :6, :6], difference[:6])
            squares[m, t, 1] = squares[m, t, 0]
            if estimated > 6:
                squares[m, t, 1] = normalised_square(
                    ps[t, :estimated, :estimated], difference[:estimated]
                )
            for part in range(2):
                total = 0.0
                for i in range(3 * part, 3 * part + 3):
                    total += ps[t, i, i]
                sigmas[m, t, part] = math.sqrt(total)

"""Many runs of one filter against one true flight: errors, consistency, what it claims."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.filter import filter_run
from compass.core.entry.flow import advance
from compass.core.entry.measure import (
    AIR,
    BIAS,
    ESTIMATED,
    FRAME,
    LIFT,
    ideal_values,
    world_of,
)
from compass.core.entry.predict import rate_of
from compass.core.jit import kernel
from compass.core.smallmatrix import cholesky


@kernel
def normalised_square(covariance, error):
    """``e^T P^-1 e`` by Cholesky; nan if P is not positive definite."""
    n, total = error.size, 0.0
    low, y = np.empty((n, n)), np.empty(n)
    if not cholesky(covariance, low):
        return np.nan
    for i in range(n):
        value = error[i]
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
def true_flight(path, world, normals, truth):
    """Move all states of a truth (t, s) on from the first, as process noise shakes them.

    Position and velocity are those of `path` (t, 6) unless they are shaken, or density or L/D
    wanders: then they are flown from the shaken ones, by the same steps as a filter's.

    Parameters
    ----------
    path
        The flight without noise.
    world
        The `compass.core.entry.groups.Problem` of one who knows the truth.
    normals
        Draws, (t, s).
    truth
        Output, but for what is behind position and velocity at the first epoch.
    """
    _, bank, times, longest, noise, walk, fade, _, _, _, places = world
    air, lift = places[AIR], places[LIFT]
    flown = noise.shape[1] > 0 or (air >= 0 and truth[0, air] != 0.0)
    truth[:, :6] = path
    for t in range(1, times.size):
        for i in range(6, truth.shape[1]):
            kept, rate = fade[t] if i == air else 1.0, rate_of(i, places)
            truth[t, i] = kept * truth[t - 1, i] + math.sqrt(walk[t, i]) * normals[t, i]
            if rate >= 0:
                truth[t, i] += (times[t] - times[t - 1]) * truth[t - 1, rate]
            flown = flown or (i in (air, lift) and walk[t, i] > 0.0)
        if flown:
            there = world_of(world.p, truth[t - 1], places)
            advance(truth[t - 1], there, bank, times[t - 1], times[t], longest, truth[t])
            for i in range(noise.shape[1]):
                for j in range(6):
                    truth[t, i] += noise[t, i, j] * normals[t, j]


@kernel
def monte_carlo(
    path, world, covariance0, problem, iterations, method, draws, errors, squares, sigmas
):
    """Run the filter many times against the true flight.

    Without process noise the truth is `path` itself, however far apart the epochs are; with it, and
    where the density wanders, that of `true_flight`. All other blocks begin at zero in truth; the
    first estimate is drawn about the truth, and where the density wanders, the truth about the
    estimate.

    Parameters
    ----------
    path, world
        The true flight at the epochs, (t, 6), and the problem of one who knows the world.
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
    p, bank, times, _, noise, walk, fade, sources, variances, kinds, places = world
    runs, epochs, size = errors.shape[0], times.size, covariance0.shape[0]
    truth = np.zeros((epochs, size))
    truth[:, :6] = path
    xs, ps = np.empty((epochs, size)), np.empty((epochs, size, size))
    ideal, z = np.empty(variances.shape), np.empty(variances.shape)
    start, difference = np.empty(size), np.empty(size)
    estimated, air, wanders = places[ESTIMATED], places[AIR], fade.min() < 1.0
    shaken = noise.shape[1] > 0 or walk.max() > 0.0
    true_places = places.copy()  # in truth no range is biased and no frame turned
    true_places[BIAS] = true_places[FRAME] = -1
    ideal_values(truth, sources, kinds, true_places, p, bank, times, ideal)
    for m in range(runs):
        for i in range(size):
            start[i] = 0.0
            for j in range(i + 1):
                start[i] += draws.root[i, j] * draws.first[m, j]
        if wanders:
            truth[0, air] = -start[air]
            start[air] = 0.0
        if shaken or wanders:
            true_flight(path, world, draws.shaken[m], truth)
            ideal_values(truth, sources, kinds, true_places, p, bank, times, ideal)
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

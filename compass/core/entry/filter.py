"""Kalman filters on Cartesian states and further blocks: one run.

States: position and velocity (6), then the blocks that `places` names. Those behind the estimated
ones are considered (Schmidt): the filter knows how uncertain they are and lets that uncertainty
into its covariance, but does not correct them.

How a filter moves on (see `compass.core.entry.kinds`) matters where density or L/D are badly known.
An extended filter linearises about what it believes, and what it has learnt so far keeps the slope
of that moment: with density known to 20 % a few dozen ranges in the first air leave it sure of a
wrong value.
`RELINEARISED` goes back: whenever it knows one of the two twice as well as when it last did, it
flies backwards from what it believes, and hears all measurements again about that flight. Where
states are shaken or the density wanders there is no such flight; there `UNSCENTED` takes mean and
covariance through points spread as its belief is.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.flow import bank_at, retreat
from compass.core.entry.kinds import RELINEARISED, ROOTED
from compass.core.entry.measure import AIR, ESTIMATED, LIFT, added, measured
from compass.core.entry.predict import move
from compass.core.entry.rates import LIFT as RATIO
from compass.core.entry.root import absorb_root, root_of, square_of
from compass.core.entry.update import absorb, update
from compass.core.jit import kernel


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

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

import numpy as np

from compass.core.entry.flow import advance
from compass.core.entry.kinds import RELINEARISED, ROOTED
from compass.core.entry.measure import AIR, ESTIMATED, LIFT, world_of
from compass.core.entry.predict import move
from compass.core.entry.root import root_of, square_of
from compass.core.entry.update import update
from compass.core.jit import kernel


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
        The `compass.core.entry.groups.Problem`, and its measurements (t, n, c); nan for what is not
        measured.
    iterations, method
        The passes of the update, and the way of filtering.
    xs, ps
        Outputs after each update, (t, s) and (t, s, s).
    """
    times, variances, places = problem.times, problem.variances, problem.places
    x, covariance, half = x0.copy(), covariance0.copy(), np.empty(covariance0.shape)
    back = times.size if method == RELINEARISED else 0
    path, marks = np.empty((back, x.size)), np.empty(2)
    mark(covariance, places, marks)
    if method == ROOTED:
        root_of(covariance0, covariance)
    for t in range(times.size):
        if t > 0:
            move(x, covariance, x, problem, t, method, half)
        update(x, covariance, x, problem, t, z[t], variances[t], iterations, method)
        if method == RELINEARISED and halved(covariance, places, marks):
            path[t], world = x, world_of(problem.p, x, places)
            for k in range(t, 0, -1):
                path[k - 1] = x
                advance(
                    path[k], world, problem.bank, times[k], times[k - 1], problem.longest,
                    path[k - 1],
                )  # fmt: skip
            x[:] = x0
            covariance[:, :] = covariance0
            for k in range(t + 1):
                if k > 0:
                    move(x, covariance, path[k - 1], problem, k, method, half)
                update(x, covariance, path[k], problem, k, z[k], variances[k], 1, method)
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
    covariance, half = covariance0.copy(), np.empty(covariance0.shape)
    x = np.zeros(covariance0.shape[0])
    if method == ROOTED:
        root_of(covariance0, covariance)
    for t in range(problem.times.size):
        if t > 0:
            move(x, covariance, x, problem, t, method, half)
        x[:6], x[6:] = path[t], 0.0
        z = problem.variances[t]  # what is read does not matter, but what is not
        update(x, covariance, x, problem, t, z, z, 1, method)
        x[:6], x[6:] = path[t], 0.0
        if method == ROOTED:
            square_of(covariance, ps[t])
        else:
            ps[t] = covariance

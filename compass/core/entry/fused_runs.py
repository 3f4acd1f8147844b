"""Many runs of fused filters against one true flight: truth, measurements, filters, errors."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.flow import advance, bank_at
from compass.core.entry.fuse import fuse_run
from compass.core.entry.groups import Array, Heard, Told, World
from compass.core.entry.measure import (
    AIR,
    AXES,
    LIFT,
    PLACES,
    acceleration_rows,
    added,
    ideal_values,
)
from compass.core.entry.rates import LIFT as RATIO
from compass.core.entry.runs import normalised_square
from compass.core.jit import kernel


class Truth(NamedTuple):
    """What is true in every run.

    The flight `path` (t, 6) in the world `p`, by the angles `bank` (k, 2); process noise as roots
    `noise` (t, 6, 6), or (t, 0, 6) for none, and the variance per second `walk` (s,) of the states
    behind the first six;
    `offset` (t, s): what the true value of each state is more than the filters' count of it;
    `sigma` (t, 3 + n c): of every measurement, nan for what is not due, hidden or out, and its
    `error` beyond noise; `arrival` (t, m): the probability that it gets through; `alive` (t, m).
    """

    path: Array
    p: Array
    bank: Array
    noise: Array
    walk: Array
    offset: Array
    sigma: Array
    error: Array
    arrival: Array
    alive: NDArray[np.bool_]


class Outcome(NamedTuple):
    """What became of every run, one row each.

    `ends`: -1, or the epoch at which the filter was lost; `errors` and `variances` (t, s), position
    and velocity along the given axes; `squares` (t,): normalised error squared; `weights` (t, m),
    `arrived` and `gated` (t, 3 + n) of accelerometers and sources; `last` (3, 3): covariance of
    the position at the end.
    """

    ends: NDArray[np.int64]
    errors: Array
    variances: Array
    squares: Array
    weights: Array
    arrived: NDArray[np.bool_]
    gated: NDArray[np.bool_]
    last: Array


@kernel
def true_flight(truth, known, normals, path, further):
    """Fly the truth: `path` (t, 6) and the `further` states (t, s), shaken where there is noise."""
    size = further.shape[1]
    path[:, :] = truth.path
    further[0] = 0.0
    air, lift = known.places[AIR], known.places[LIFT]
    for t in range(1, known.times.size):
        dt = known.times[t] - known.times[t - 1]
        for i in range(6, size):
            further[t, i] = further[t - 1, i] + math.sqrt(truth.walk[i] * dt) * normals[t, i]
        if truth.noise.shape[1] == 0:
            continue
        before = further[t - 1]
        advance(
            path[t - 1], added(before, air), truth.p[RATIO] + added(before, lift), truth.p,
            truth.bank, known.times[t - 1], known.times[t], known.longest, path[t],
        )  # fmt: skip
        for i in range(6):
            for j in range(6):
                path[t, i] += truth.noise[t, i, j] * normals[t, j]


@kernel
def measure(truth, known, path, further, normals, uniforms, lost_is_zero, z, variances, arrived):
    """Write what is measured, and as how good the filters take it; nan for what does not come.

    A beacon's lost signal reads 0 to a filter with `lost_is_zero`. `variances` comes with those the
    filters assume, and leaves with nan where nothing came.
    """
    epochs, m = uniforms.shape
    c = known.kinds.size
    ideal, rows = np.empty((epochs, known.sources.shape[1], c)), np.zeros((AXES, 6))
    places = np.full(PLACES, -1)  # the truth is no filter's state
    ideal_values(
        path, known.sources, known.kinds, places, truth.p, truth.bank, known.times, ideal
    )  # fmt: skip
    for t in range(epochs):
        angle = truth.bank[bank_at(known.times[t], truth.bank), 1]
        acceleration_rows(
            path[t], added(further[t], known.places[AIR]),
            truth.p[RATIO] + added(further[t], known.places[LIFT]), truth.p, math.cos(angle),
            math.sin(angle), places, rows, z[t],
        )  # fmt: skip
        for r in range(z.shape[1]):
            k, kind = (r - AXES) // c, (r - AXES) % c
            comes, radio = not math.isnan(truth.sigma[t, r]), r >= AXES and k < m
            if radio:
                comes = comes and uniforms[t, k] < truth.arrival[t, k]
            if r >= AXES:
                z[t, r] = ideal[t, k, kind] if comes else 0.0
            if comes:
                z[t, r] += truth.error[t, r] + truth.sigma[t, r] * normals[t, r]
                arrived[t, r if r < AXES else AXES + k] = True
            elif not (lost_is_zero and radio):
                variances[t, r] = np.nan


@kernel
def fused_runs(
    arrangement, truth, known, starts, p0, assumed, lost_is_zero, axes, draws, noises, uniforms,
    unknown, out,
):  # fmt: skip
    """Fly, measure, filter and compare, once for each row of the draws.

    Parameters
    ----------
    arrangement, truth, known
        Of `compass.core.entry.groups`, and what is true.
    starts, p0
        First estimate of each run, (runs, s), and the covariance the filters take it to have.
    assumed
        Variances that the filters assume, (t, 3 + n c), nan for what is never measured.
    lost_is_zero
        Whether a range that does not arrive is taken for one that reads 0.
    axes
        Rows of the directions in which errors are told, (t, 3, 3).
    draws, noises, uniforms
        Normal numbers for the truth, (runs, t, s), and the measurements, (runs, t, 3 + n c), and
        uniform ones for the arrivals, (runs, t, m).
    unknown
        What is added to the logarithm of the density and to L/D that the filters know, (runs, 2).
    out
        An `Outcome`, filled.
    """
    runs, epochs, size = draws.shape
    c = known.kinds.size
    path, further = np.empty((epochs, 6)), np.zeros((epochs, size))
    z, variances = np.empty(assumed.shape), np.empty(assumed.shape)
    xs, ps = np.empty((epochs, size)), np.empty((epochs, size, size))
    gated, error = np.empty(assumed.shape, dtype=np.bool_), np.empty(size)
    for run in range(runs):
        true_flight(truth, known, draws[run], path, further)
        variances[:, :] = assumed
        out.arrived[run] = False
        measure(
            truth, known, path, further, noises[run], uniforms[run], lost_is_zero, z, variances,
            out.arrived[run],
        )  # fmt: skip
        end = fuse_run(
            arrangement, known, starts[run], p0, Heard(z, variances, truth.alive),
            World(unknown[run, 0], unknown[run, 1]), Told(xs, ps, out.weights[run], gated),
        )  # fmt: skip
        out.gated[run] = False
        for t in range(epochs if end < 0 else end):
            for i in range(size):
                true = path[t, i] if i < 6 else further[t, i]
                error[i] = xs[t, i] - true - truth.offset[t, i]
            out.squares[run, t] = normalised_square(ps[t], error)
            if not math.isfinite(out.squares[run, t]):
                end = t
                break
            turn(axes[t], error, ps[t], out.errors[run, t], out.variances[run, t])
            for r in range(gated.shape[1]):
                if gated[t, r]:
                    out.gated[run, t, r if r < AXES else AXES + (r - AXES) // c] = True
        out.ends[run] = end
        out.last[run] = ps[epochs - 1, :3, :3]


@kernel
def turn(axes, error, cov, errors, variances):
    """Write errors and variances, those of position and velocity along the rows of `axes`."""
    for i in range(error.size):
        errors[i], variances[i] = error[i], cov[i, i]
    for part in range(2):
        for a in range(3):
            total, square = 0.0, 0.0
            for i in range(3):
                total += axes[a, i] * error[3 * part + i]
                for j in range(3):
                    square += axes[a, i] * axes[a, j] * cov[3 * part + i, 3 * part + j]
            errors[3 * part + a], variances[3 * part + a] = total, square

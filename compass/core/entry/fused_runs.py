"""Many runs of fused filters against one true flight: truth, measurements, filters, errors."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.fuse import fuse_run
from compass.core.entry.groups import Array, Problem, Told, in_world
from compass.core.entry.kinds import ACCELERATION
from compass.core.entry.measure import AXES, ideal_values
from compass.core.entry.rates import thickened
from compass.core.entry.runs import normalised_square, true_flight
from compass.core.jit import kernel


class Truth(NamedTuple):
    """What is true in every run.

    The flight `path` (t, 6), and the `world` as one who knows it has it: its variances are nan for
    what is not due, hidden or out; `offset` (t, s): what the true value of each state is more than
    the filters' count of it; `error` (t, n, c): of every measurement beyond noise; `arrival`
    (t, m): the probability that a beacon's gets through; `alive` (t, m).
    """

    path: Array
    world: Problem
    offset: Array
    error: Array
    arrival: Array
    alive: NDArray[np.bool_]


class Drawn(NamedTuple):
    """What runs have by chance: normal numbers, and uniform ones for the arrivals.

    First estimates `starts` (runs, s), `shaken` (runs, t, s) of the truth, `measured` (runs, t, n,
    c), `arrivals` (runs, t, m), and what is added to the logarithm of the density and to L/D that
    the filters know, `unknown` (runs, 2).
    """

    starts: Array
    shaken: Array
    measured: Array
    arrivals: Array
    unknown: Array


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
def column(b, kind):
    """Of source b's reading of a kind among what is told of accelerometers and sources."""
    return kind - ACCELERATION if kind >= ACCELERATION else AXES + b


@kernel
def measure(truth, known, states, normals, uniforms, lost_is_zero, z, arrived):
    """Write what is measured of true states (t, s), as filters hear it; nan for what does not come.

    A beacon's lost signal reads 0 to a filter with `lost_is_zero`, if it is one that it knows of.
    """
    world, m = truth.world, truth.alive.shape[1]
    ideal_values(
        states, world.sources, world.kinds, world.places, world.p, world.bank, world.times, z
    )  # fmt: skip
    for t in range(z.shape[0]):
        for b in range(z.shape[1]):
            for c in range(z.shape[2]):
                sigma = math.sqrt(world.variances[t, b, c])
                comes = not math.isnan(sigma)
                if b < m:
                    comes = comes and uniforms[t, b] < truth.arrival[t, b]
                if comes:
                    z[t, b, c] += truth.error[t, b, c] + sigma * normals[t, b, c]
                    arrived[t, column(b, world.kinds[c])] = True
                else:
                    z[t, b, c] = 0.0 if lost_is_zero and b < m else np.nan
                if math.isnan(known.variances[t, b, c]):
                    z[t, b, c] = np.nan


@kernel
def fused_runs(arrangement, truth, known, p0, lost_is_zero, axes, drawn, out):
    """Fly, measure, filter and compare, once for each row of what is drawn.

    Parameters
    ----------
    arrangement, truth, known
        `compass.core.entry.groups.Arrangement`, what is true, and the problem as filters know it.
    p0
        Covariance that they take the first estimate to have.
    lost_is_zero
        Whether a range that does not arrive is taken for one that reads 0.
    axes
        Rows of the directions in which errors are told, (t, 3, 3).
    drawn
        `Drawn`.
    out
        An `Outcome`, filled.
    """
    runs, epochs, size = drawn.shaken.shape
    states, z = np.zeros((epochs, size)), np.empty(known.variances.shape)
    xs, ps = np.empty((epochs, size)), np.empty((epochs, size, size))
    gated, error = np.empty(z.shape, dtype=np.bool_), np.empty(size)
    for run in range(runs):
        true_flight(truth.path, truth.world, drawn.shaken[run], states)
        out.arrived[run] = False
        measure(
            truth, known, states, drawn.measured[run], drawn.arrivals[run], lost_is_zero, z,
            out.arrived[run],
        )  # fmt: skip
        p = thickened(known.p, drawn.unknown[run, 0], drawn.unknown[run, 1])
        end = fuse_run(
            arrangement, in_world(known, p, known.bank), drawn.starts[run], p0, z, truth.alive,
            Told(xs, ps, out.weights[run], gated),
        )  # fmt: skip
        out.gated[run] = False
        for t in range(epochs if end < 0 else end):
            for i in range(size):
                error[i] = xs[t, i] - states[t, i] - truth.offset[t, i]
            out.squares[run, t] = normalised_square(ps[t], error)
            if not math.isfinite(out.squares[run, t]):
                end = t
                break
            turn(axes[t], error, ps[t], out.errors[run, t], out.variances[run, t])
            for b in range(gated.shape[1]):
                for c in range(gated.shape[2]):
                    if gated[t, b, c]:
                        out.gated[run, t, column(b, known.kinds[c])] = True
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

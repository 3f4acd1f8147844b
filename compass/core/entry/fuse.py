"""Filters that hear accelerometers and beacons: all in one, or subsystems that are fused.

A subsystem hears its own beacon and what the lander reads of itself, its accelerometers and other
instruments; a fusion node adds the information of the
subsystems with coefficients c_i: ``P = (sum_i c_i Y_i)^-1``, ``x = P sum_i c_i Y_i x_i``. The
algorithms differ in what a subsystem starts from and in the coefficients (see
`compass.core.entry.groups.Arrangement`); dynamics, measurements and update are those of every
other filter here.
"""

import math

import numpy as np

from compass.core.entry.flow import bank_at
from compass.core.entry.groups import Problem, make_estimates
from compass.core.entry.kinds import PLAIN
from compass.core.entry.measure import measured
from compass.core.entry.node import fuse, sound, weigh
from compass.core.entry.predict import move
from compass.core.entry.update import update
from compass.core.entry.weights import make_scratch
from compass.core.jit import fast_kernel, kernel


@fast_kernel
def innovation_variance(cov, row, noise):
    """``h P h^T + R``."""
    total = noise
    for i in range(row.size):
        part = 0.0
        for j in range(row.size):
            part += cov[i, j] * row[j]
        total += row[i] * part
    return total


@kernel
def learn(arrangement, problem, t, z, group, factor, x, cov, gated):
    """Update an estimate by what the subsystem of a ``group = first, last, m`` of beacons hears.

    That is its beacons and all that is none, whose variances are multiplied by `factor`; z (n, c)
    is what comes at epoch t. The gate looks at each measurement alone, so its answer does not
    depend on their order. False if the estimate is lost.
    """
    first, last, m = group
    heard, variances, row = z.copy(), problem.variances[t].copy(), np.zeros(x.size)
    shut = arrangement.gate < math.inf and problem.times[t] >= arrangement.gate_start
    angle = problem.bank[bank_at(problem.times[t], problem.bank), 1]
    for b in range(z.shape[0]):
        if b >= m:
            variances[b] *= factor
        elif not first <= b < last:
            heard[b] = np.nan
        for c in range(z.shape[1] if shut else 0):
            if math.isnan(heard[b, c]):
                continue
            row[:] = 0.0
            residual = z[b, c] - measured(
                problem.kinds[c], x, problem.sources[t, b], b, problem.places, problem.p, angle, row
            )
            variance = innovation_variance(cov, row, problem.variances[t, b, c])
            if not residual * residual <= arrangement.gate * variance:
                heard[b, c] = np.nan
                gated[b, c] = True
    update(x, cov, x, problem, t, heard, variances, arrangement.iterations, PLAIN)
    return sound(x, cov)


@kernel
def calm(problem):
    """Return the problem without process noise."""
    p, bank, times, longest, _, walk, fade, sources, variances, kinds, places = problem
    return Problem(
        p, bank, times, longest, np.empty((times.size, 0, 6)), np.zeros(walk.shape), fade, sources,
        variances, kinds, places,
    )  # fmt: skip


@kernel
def shake(problem, t, factor, cov):
    """Add the process noise that is gathered by epoch t, multiplied by `factor`."""
    for i in range(6):
        for j in range(6):
            for k in range(problem.noise.shape[1]):
                cov[i, j] += factor * problem.noise[t, i, k] * problem.noise[t, j, k]
    for i in range(6, cov.shape[0]):
        cov[i, i] += factor * problem.walk[t, i]


@kernel
def fuse_epoch(arrangement, problem, quiet, t, z, alive, estimates, half, work):
    """Move all estimates to epoch t and let them hear what there is; False if one is lost.

    Dead subsystems wait; without feedback they come back from the fused estimate of the epoch
    before. If all are dead the fused estimate is predicted.

    Parameters
    ----------
    arrangement, problem, quiet
        Who hears what, the world as they know it, and `calm` of it.
    t
        Epoch.
    z, alive
        What comes at it, (n, c), and which subsystems work, (m,).
    estimates, half, work
        Of `make_estimates`, (s, s), and of `compass.core.entry.weights.make_scratch`.
    """
    x, cov, m, count = estimates.x, estimates.P, alive.size, alive.sum()
    estimates.gated[:, :] = False
    together = not arrangement.apart or count == 0
    if t > 0 and (arrangement.feedback or together):
        move(x, cov, x, quiet, t, PLAIN, half)
    if together:
        shake(problem, t, 1.0, cov)
        estimates.waiting[:] = True
        if arrangement.apart:
            return sound(x, cov)
        return learn(arrangement, problem, t, z, (0, m, m), 1.0, x, cov, estimates.gated)
    for i in range(m):
        own_x, own_cov = estimates.local_x[i], estimates.local_cov[i]
        if not alive[i]:
            estimates.waiting[i] = True
            continue
        shares = 1.0
        if arrangement.feedback or estimates.waiting[i]:
            own_x[:] = x
            part = 1.0
            if arrangement.divided:
                shares = 1.0 * count
                part = 1.0 / count
            elif arrangement.fading:
                part = max(estimates.weights[i], arrangement.floor)
            own_cov[:, :] = cov / part
            estimates.waiting[i] = False
        if t > 0 and not arrangement.feedback:
            move(own_x, own_cov, own_x, quiet, t, PLAIN, half)
        shake(problem, t, shares, own_cov)
        group = (i, i + 1, m)
        if not learn(arrangement, problem, t, z, group, shares, own_x, own_cov, estimates.gated):
            return False
    if not weigh(arrangement, alive, estimates, half, work):
        return False
    coefficients = work.gradient
    for i in range(m):
        coefficients[i] = estimates.weights[i]
        if arrangement.divided:
            coefficients[i] = 1.0 if alive[i] else 0.0
    return fuse(arrangement, coefficients, estimates, work)


@kernel
def fuse_run(arrangement, problem, x0, p0, z, alive, told):
    """Filter all epochs; return -1, or the epoch at which an estimate was lost.

    Parameters
    ----------
    arrangement, problem
        As in `fuse_epoch`.
    x0, p0
        First estimate, before the first epoch's measurements, (s,) and (s, s).
    z, alive
        Measurements (t, n, c), nan for what does not come, the first m sources beacons; and which
        subsystems work, (t, m).
    told
        Output, `compass.core.entry.groups.Told`.
    """
    m, quiet, half = alive.shape[1], calm(problem), np.empty(p0.shape)
    gated = np.zeros(z[0].shape, dtype=np.bool_)
    estimates, work = make_estimates(x0, p0, m, gated), make_scratch(x0.size, m)
    for t in range(problem.times.size):
        if not fuse_epoch(arrangement, problem, quiet, t, z[t], alive[t], estimates, half, work):
            return t
        told.xs[t] = estimates.x
        told.ps[t] = estimates.P
        told.weights[t] = estimates.weights
        told.gated[t] = gated
    return -1

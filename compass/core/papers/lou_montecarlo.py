"""Monte Carlo of entry filters: truth, measurements, filter and statistics in one compiled loop."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import flat_kernel, kernel
from compass.core.papers.lou_common import Array, Epoch, make_bank, make_work, start_bank
from compass.core.papers.lou_measurement import ACCELERATIONS, predict_measurements
from compass.core.papers.lou_steps import start, step
from compass.core.papers.spherical import BANK, rk4_step
from compass.core.smallmatrix import cholesky

#: Normal numbers a run takes for its start (the largest state), and for the states of the truth.
START_DRAWS, TRUTH_STATES = 11, 8


class World(NamedTuple):
    """What is true: the same for every run of an experiment, for epochs 0 to K.

    `x0` (8,), parameters `p` of the dynamics, `bank` angles (K+1,), square roots `noise` (8,) of
    the process noise of one step, IMU `bias` (3,) and `acc_sigma` (3,), `range_sigma` (m,),
    `beacons` (K+1, m, 3), arrival probabilities `arrival` (K+1, m) with 0 where hidden or out,
    range errors `offset` (K+1, m) and live subsystems `alive` (K+1, m).
    """

    x0: Array
    p: Array
    bank: Array
    noise: Array
    bias: Array
    acc_sigma: Array
    range_sigma: Array
    beacons: Array
    arrival: Array
    offset: Array
    alive: NDArray[np.bool_]


class Belief(NamedTuple):
    """What a filter starts from and assumes.

    Estimate `x0` (8 or 11,) around which the start is drawn with the factor `spread` (as many
    rows and columns; zero: the start is `x0`), covariance `p0` (n, n), parameters `p`; with
    `lost_is_zero` a range that did not arrive reads 0.
    """

    x0: Array
    p0: Array
    spread: Array
    p: Array
    lost_is_zero: bool


class Tally(NamedTuple):
    """Running statistics over runs (Welford), for epochs 0 to K.

    `runs` (1,), errors `mean` and `m2` (K+1, n), mean variances `variance` (K+1, n), shares
    `captured` (K+1, n) of errors within 3 sigma, mean squared `position` error (K+1,), `nees`
    mean and second moment (K+1, 2), mean `weights` (K+1, m), shares of rows that arrived in
    `arrivals` and were refused in `gated` (K+1, 3 + m), and at the end the mean and second moments
    (4, 3) of the east, north and up `miss`, with the mean covariance of it in `claimed` (3, 3).
    """

    runs: Array
    mean: Array
    m2: Array
    variance: Array
    captured: Array
    position: Array
    nees: Array
    weights: Array
    arrivals: Array
    gated: Array
    miss: Array
    claimed: Array


class Trace(NamedTuple):
    """One run, for epochs 0 to K.

    `truth` (K+1, 8), measurements `z` (K+1, 3 + m) and whether they `arrived`, estimates `x`
    (K+1, 8 or 11) with covariances `cov` (K+1, n, n), `weights` (K+1, m), refusals `gated`
    (K+1, 3 + m), and then `error` (K+1, n) and `nees` (K+1,).
    """

    truth: Array
    z: Array
    arrived: NDArray[np.bool_]
    x: Array
    cov: Array
    weights: Array
    gated: NDArray[np.bool_]
    error: Array
    nees: Array


@kernel
def make_trace(n, size, epochs, m):
    """Return an empty record of one run."""
    rows = ACCELERATIONS + m
    return Trace(
        np.zeros((epochs, TRUTH_STATES)),
        np.zeros((epochs, rows)),
        np.zeros((epochs, rows), dtype=np.bool_),
        np.zeros((epochs, size)),
        np.zeros((epochs, n, n)),
        np.zeros((epochs, m)),
        np.zeros((epochs, rows), dtype=np.bool_),
        np.zeros((epochs, n)),
        np.zeros(epochs),
    )


@kernel
def scaled_nees(error, cov, factor, work):
    """Normalised estimation error squared ``e^T P^-1 e``; nan if P is not positive definite."""
    n = error.size
    if not cholesky(cov, factor):
        return math.nan
    total = 0.0
    for i in range(n):
        part = error[i]
        for k in range(i):
            part -= factor[i, k] * work[k]
        work[i] = part / factor[i, i]
        total += work[i] * work[i]
    return total


@flat_kernel
def fly(dt, world, normals, uniforms, trace):
    """Fly the truth and measure it: write `truth`, `z` and `arrived` of the trace.

    A range that does not arrive reads 0. The bank angle at an epoch holds from it to the next one;
    at a switch the accelerometers read the new one.

    Parameters
    ----------
    dt
        Step, s.
    world
        The truth.
    normals
        Standard normal numbers, shape (11 + K (11 + m),), the first 11 left for the start.
    uniforms
        Uniform numbers in [0, 1), shape (K m,).
    trace
        Output.
    """
    epochs, m = world.alive.shape
    p, true, moved = world.p.copy(), world.x0.copy(), np.empty(TRUTH_STATES)
    slopes = np.empty((ACCELERATIONS + m, TRUTH_STATES))
    trace.truth[0] = true
    place = START_DRAWS
    for k in range(1, epochs):
        p[BANK] = world.bank[k - 1]
        rk4_step(true, p, dt, moved)
        p[BANK] = world.bank[k]
        for i in range(TRUTH_STATES):
            true[i] = moved[i] + world.noise[i] * normals[place + i]
            trace.truth[k, i] = true[i]
        place += TRUTH_STATES
        z = trace.z[k]
        predict_measurements(true, TRUTH_STATES, p, False, world.beacons[k], z, slopes)
        for i in range(ACCELERATIONS):
            z[i] += world.bias[i] + world.acc_sigma[i] * normals[place + i]
            trace.arrived[k, i] = True
        place += ACCELERATIONS
        for i in range(m):
            row = ACCELERATIONS + i
            arrives = uniforms[(k - 1) * m + i] < world.arrival[k, i]
            trace.arrived[k, row] = arrives
            error = world.offset[k, i] + world.range_sigma[i] * normals[place + i]
            z[row] = z[row] + error if arrives else 0.0
        place += m


@kernel
def track(algorithm, settings, belief, x0, bank_angles, beacons, alive, trace):
    """Filter the measurements of a trace; write `x`, `cov`, `weights` and `gated` of it.

    Returns -1, or the epoch at which the filter diverged.

    Parameters
    ----------
    algorithm, settings
        Of `compass.core.papers.lou_steps`.
    belief
        What the filter assumes.
    x0
        The estimate at epoch 0, shape (8,) or (11,).
    bank_angles, beacons, alive
        As in `World`.
    trace
        Input `z` and `arrived`, and output.
    """
    epochs, m = alive.shape
    n, size = settings.states, x0.size
    bank, work = make_bank(n, size, m), make_work(n, size, m, belief.p.size)
    start_bank(bank, x0, belief.p0)
    p, here, arrived = belief.p.copy(), belief.p.copy(), np.ones(ACCELERATIONS + m, dtype=np.bool_)
    if not start(algorithm, settings, bank, work):
        return 0
    for k in range(epochs):
        if k > 0:
            p[BANK], here[BANK] = bank_angles[k - 1], bank_angles[k]
            for i in range(arrived.size):
                arrived[i] = trace.arrived[k, i] or belief.lost_is_zero
            gate = settings.gate if k * settings.dt >= settings.gate_start else math.inf
            epoch = Epoch(p, here, beacons[k], trace.z[k], arrived, alive[k], gate)
            if not step(algorithm, settings, epoch, bank, work):
                return k
        trace.x[k] = bank.x
        trace.cov[k] = bank.P
        trace.weights[k] = bank.weights
        trace.gated[k] = bank.gated
    return -1


@flat_kernel
def one_run(algorithm, settings, world, belief, normals, uniforms, trace):
    """Fly, measure, filter and compare; fill `trace`, return -1 or the epoch of divergence."""
    n = settings.states
    x0 = belief.x0.copy()
    for i in range(x0.size):
        for j in range(x0.size):
            x0[i] += belief.spread[i, j] * normals[j]
    fly(settings.dt, world, normals, uniforms, trace)
    end = track(algorithm, settings, belief, x0, world.bank, world.beacons, world.alive, trace)
    factor, half = np.empty((n, n)), np.empty(n)
    last = trace.nees.size if end < 0 else end
    for k in range(last):
        for j in range(n):
            if j < TRUTH_STATES:
                true = trace.truth[k, j]
                if j == 6 and settings.linear:
                    true = math.exp(true)
            else:
                true = world.bias[j - TRUTH_STATES]
            trace.error[k, j] = trace.x[k, j] - true
        trace.nees[k] = scaled_nees(trace.error[k], trace.cov[k], factor, half)
        if not math.isfinite(trace.nees[k]):
            return k
    return end


@flat_kernel
def add_run(trace, tally):
    """Take a finished run into the statistics."""
    epochs, n = trace.error.shape
    m = trace.weights.shape[1]
    tally.runs[0] += 1.0
    share = 1.0 / tally.runs[0]
    for k in range(epochs):
        for j in range(n):
            error, variance = trace.error[k, j], trace.cov[k, j, j]
            delta = error - tally.mean[k, j]
            tally.mean[k, j] += delta * share
            tally.m2[k, j] += delta * (error - tally.mean[k, j])
            tally.variance[k, j] += (variance - tally.variance[k, j]) * share
            inside = 1.0 if error * error <= 9.0 * variance else 0.0
            tally.captured[k, j] += (inside - tally.captured[k, j]) * share
        r, lat = trace.truth[k, 0], trace.truth[k, 2]
        up = trace.error[k, 0]
        east, north = r * math.cos(lat) * trace.error[k, 1], r * trace.error[k, 2]
        squared = up * up + east * east + north * north
        tally.position[k] += (squared - tally.position[k]) * share
        delta = trace.nees[k] - tally.nees[k, 0]
        tally.nees[k, 0] += delta * share
        tally.nees[k, 1] += delta * (trace.nees[k] - tally.nees[k, 0])
        for i in range(m):
            tally.weights[k, i] += (trace.weights[k, i] - tally.weights[k, i]) * share
        for i in range(ACCELERATIONS + m):
            came = 1.0 if trace.arrived[k, i] else 0.0
            refused = 1.0 if trace.gated[k, i] else 0.0
            tally.arrivals[k, i] += (came - tally.arrivals[k, i]) * share
            tally.gated[k, i] += (refused - tally.gated[k, i]) * share
    _add_miss(trace, tally, share)


@flat_kernel
def _add_miss(trace, tally, share):
    """Take the east, north and up errors at the last epoch into the statistics."""
    r, lat = trace.truth[-1, 0], trace.truth[-1, 2]
    arm = np.array([r * math.cos(lat), r, 1.0])
    column = np.array([1, 2, 0])
    miss, before = np.empty(3), np.empty(3)
    for a in range(3):
        miss[a] = arm[a] * trace.error[-1, column[a]]
        before[a] = miss[a] - tally.miss[0, a]
        tally.miss[0, a] += before[a] * share
    for a in range(3):
        for b in range(3):
            tally.miss[1 + a, b] += before[a] * (miss[b] - tally.miss[0, b])
            claim = arm[a] * arm[b] * trace.cov[-1, column[a], column[b]]
            tally.claimed[a, b] += (claim - tally.claimed[a, b]) * share


@kernel
def run_block(algorithm, settings, world, belief, normals, uniforms, trace, tally, ends, last_x):
    """Do one run for each row of `normals` and `uniforms`, and add those that did not diverge.

    `ends` (runs,) takes -1 or the epoch of divergence, `last_x` (runs, 8 or 11) the estimate at
    the last epoch before it; `trace` holds the last run.
    """
    for run in range(normals.shape[0]):
        end = one_run(algorithm, settings, world, belief, normals[run], uniforms[run], trace)
        ends[run] = end
        if end < 0:
            add_run(trace, tally)
        else:
            last_x[run] = trace.x[max(end - 1, 0)]

"""What every filter shares: its settings, its data, the time update and the measurement update.

A filter is a kernel ``step(settings, epoch, bank, work) -> bool`` that moves the `Bank` of
estimates over one epoch; False says that it diverged (a state that is not finite or a covariance
that is not positive definite). Centralised filters use the fused estimate alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import fast_kernel, kernel
from compass.core.papers.lou_measurement import ACCELERATIONS, TINY_DENSITY, predict_measurements
from compass.core.papers.spherical import DRAG, rk4_step_transition

Array = NDArray[np.float64]


class Settings(NamedTuple):
    """What stays the same over a run.

    `states` n is 6, 8 or 11; `linear` carries rho0 instead of its logarithm; `q` (n,) is the
    process noise variance of one step; `r_acc` (3,) and `r_range` (m,) the variances of the
    measurements; `scale` (n,) the size of each state in which information is weighed; `gate`
    the largest squared innovation over its variance that is believed (inf: all), from `gate_start`
    seconds on;
    `weighting` and `floor` the rule of the fusion weights and their smallest value;
    `iterations` the relinearisations of the iterated filter.
    """

    states: int
    linear: bool
    dt: float
    q: Array
    r_acc: Array
    r_range: Array
    scale: Array
    gate: float
    gate_start: float
    weighting: int
    floor: float
    iterations: int


class Epoch(NamedTuple):
    """What one step is given.

    Parameters `p` of the dynamics (filter's side) over the step, and `here` with the bank that
    holds from the new epoch on, by which the accelerometers are read; `beacons` (m, 3) at the new
    epoch, the measurements `z` (3 + m,), which of them `arrived` (3 + m,), which subsystems are
    `alive` (m,), and the `gate` in force.
    """

    p: Array
    here: Array
    beacons: Array
    z: Array
    arrived: NDArray[np.bool_]
    alive: NDArray[np.bool_]
    gate: float


class Bank(NamedTuple):
    """Estimates: fused `x` (8 or 11,) and `P` (n, n); those of m subsystems; weights (m,).

    `Y` (n, n) is the information matrix, scaled, of the filters that carry one instead of P.
    `gated` (3 + m,) says which rows the gate refused at this step (by any subsystem), `waiting`
    (m,) which subsystems without feedback are dead.
    """

    x: Array
    P: Array
    Y: Array
    local_x: Array
    local_cov: Array
    weights: Array
    gated: NDArray[np.bool_]
    waiting: NDArray[np.bool_]


class Work(NamedTuple):
    """Scratch: vectors and matrices that steps write before they read."""

    x8: Array
    phi8: Array
    p: Array
    h: Array
    big_h: Array
    dx: Array
    u: Array
    gain: Array
    phi: Array
    a: Array
    b: Array
    c: Array
    d: Array
    information: Array
    stack: Array
    gradient: Array
    hessian: Array
    factor: Array
    direction: Array
    trial: Array
    used: NDArray[np.bool_]


@kernel
def make_bank(n, size, subsystems):
    """Return a bank of estimates of the right shapes, zero."""
    return Bank(
        np.zeros(size),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((subsystems, size)),
        np.zeros((subsystems, n, n)),
        np.full(subsystems, 1.0 / max(subsystems, 1)),
        np.zeros(ACCELERATIONS + subsystems, dtype=np.bool_),
        np.zeros(subsystems, dtype=np.bool_),
    )


@kernel
def make_work(n, size, subsystems, parameters):
    """Return scratch of the right shapes."""
    rows = ACCELERATIONS + subsystems
    m = subsystems
    return Work(
        np.zeros(8),
        np.zeros((8, 8)),
        np.zeros(parameters),
        np.zeros(rows),
        np.zeros((rows, n)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((m, n, n)),
        np.zeros((m, n, n)),
        np.zeros(m),
        np.zeros((m, m)),
        np.zeros((m, m)),
        np.zeros(m),
        np.zeros(m),
        np.zeros(rows, dtype=np.bool_),
    )


@kernel
def start_bank(bank, x0, p0):
    """Give the fused estimate and every subsystem the same start, and equal weights."""
    m = bank.weights.size
    bank.x[:] = x0
    bank.P[:, :] = p0
    for i in range(m):
        bank.local_x[i] = x0
        bank.local_cov[i] = p0
        bank.weights[i] = 1.0 / m
    bank.gated[:] = False
    bank.waiting[:] = False


@fast_kernel
def predict_state(settings, p, x, work):
    """Move `x` by one Runge-Kutta step and write the derivative of the step into `work.phi`.

    On linear rho0 the chain rule through the logarithm gives the same map exactly: drag is
    rho0 B times known things, so the sign of rho0 goes to B.
    """
    n = settings.states
    for i in range(p.size):
        work.p[i] = p[i]
    rho0 = x[6]
    if settings.linear:
        if abs(rho0) < TINY_DENSITY:
            rho0 = TINY_DENSITY
        x[6] = math.log(abs(rho0))
        if rho0 < 0.0:
            work.p[DRAG] = -p[DRAG]
    rk4_step_transition(x, work.p, settings.dt, work.x8, work.phi8)
    for i in range(8):
        x[i] = work.x8[i]
    if settings.linear:
        x[6] = rho0
        for i in range(8):
            if i != 6:
                work.phi8[i, 6] /= rho0
    for i in range(n):
        for j in range(n):
            if i < 8 and j < 8:
                work.phi[i, j] = work.phi8[i, j]
            else:
                work.phi[i, j] = 1.0 if i == j else 0.0


@fast_kernel
def propagate(phi, cov, half):
    """``P <- Phi P Phi^T`` in place, exactly symmetric; rows from the seventh on of Phi are I."""
    n = cov.shape[0]
    for i in range(6):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += phi[i, k] * cov[k, j]
            half[i, j] = total
    for i in range(6):
        for j in range(i, 6):
            total = 0.0
            for k in range(n):
                total += half[i, k] * phi[j, k]
            cov[i, j] = total
            cov[j, i] = total
        for j in range(6, n):
            cov[i, j] = half[i, j]
            cov[j, i] = half[i, j]


@fast_kernel
def add_noise(cov, q, factor):
    """Add `factor` times the process noise variances to the diagonal."""
    for i in range(cov.shape[0]):
        cov[i, i] += factor * q[i]


@kernel
def linearise(settings, epoch, x, work):
    """Write the predicted measurements of `x` and their derivatives into `work`."""
    predict_measurements(
        x, settings.states, epoch.here, settings.linear, epoch.beacons, work.h, work.big_h
    )


@fast_kernel
def innovation_variance(cov, big_h, row, noise):
    """``H P H^T + R`` of one row."""
    n = cov.shape[0]
    total = noise
    for i in range(n):
        part = 0.0
        for j in range(n):
            part += cov[i, j] * big_h[row, j]
        total += big_h[row, i] * part
    return total


@kernel
def choose_rows(settings, epoch, bank, cov, only, work):
    """Mark in `work.used` the rows that arrived, belong to subsystem `only` and pass the gate.

    `only` -1 takes every range. The gate compares each row alone with the predicted covariance
    ``cov``, so its answer does not depend on the order of the rows.
    """
    used, arrived = work.used, epoch.arrived
    for i in range(arrived.size):
        mine = i < ACCELERATIONS or only < 0 or i - ACCELERATIONS == only
        used[i] = mine and arrived[i]
    if epoch.gate < math.inf:
        for i in range(arrived.size):
            if used[i]:
                noise = row_noise(settings.r_acc, settings.r_range, i)
                residual = epoch.z[i] - work.h[i]
                variance = innovation_variance(cov, work.big_h, i, noise)
                if not residual * residual <= epoch.gate * variance:
                    used[i] = False
                    bank.gated[i] = True


@fast_kernel
def row_noise(r_acc, r_range, row):
    """Variance of a row of the measurements."""
    return r_acc[row] if row < ACCELERATIONS else r_range[row - ACCELERATIONS]


@kernel
def update(settings, z, x, cov, acc_factor, work):
    """Update `x` and `cov` by the rows in `work.used`; see `joseph_rows`."""
    return joseph_rows(
        z,
        work.used,
        work.h,
        work.big_h,
        settings.r_acc,
        settings.r_range,
        acc_factor,
        x,
        cov,
        work.dx,
        work.u,
        work.gain,
    )


@fast_kernel
def joseph_rows(z, used, h, big_h, r_acc, r_range, acc_factor, x, cov, dx, u, gain):
    """Measurement update of a state and its covariance, one row after the other.

    ``K = P H^T / (H P H^T + R)``, ``P <- (I - K H) P (I - K H)^T + K R K^T``: with uncorrelated
    noise the same as all rows at once. Every row keeps the linearisation at the state before the
    first row. False if an innovation variance is not positive.

    Parameters
    ----------
    z, used
        Measurements and which of them to take, shape (3 + m,).
    h, big_h
        What the state would measure, and the derivative, shapes (3 + m,) and (3 + m, n).
    r_acc, r_range
        Variances, shapes (3,) and (m,); those of the accelerometers times `acc_factor`.
    x, cov
        Updated in place, shapes (8 or 11,) and (n, n).
    dx, u, gain
        Scratch, shape (n,).
    """
    n = cov.shape[0]
    for j in range(n):
        dx[j] = 0.0
    for i in range(z.size):
        if not used[i]:
            continue
        noise = row_noise(r_acc, r_range, i)
        width = 3  # a range depends on the position alone
        if i < ACCELERATIONS:
            noise *= acc_factor
            width = n
        residual = z[i] - h[i]
        variance = noise
        for j in range(n):
            total = 0.0
            for k in range(width):
                total += cov[j, k] * big_h[i, k]
            u[j] = total
        for j in range(width):
            variance += big_h[i, j] * u[j]
            residual -= big_h[i, j] * dx[j]
        if not variance > 0.0:
            return False
        inverse = 1.0 / variance
        for j in range(n):
            gain[j] = u[j] * inverse
            dx[j] += gain[j] * residual
        # (I - K H) P, then its product with H^T, then the right factor: the Joseph form
        for j in range(n):
            g = gain[j]
            for k in range(n):
                cov[j, k] -= g * u[k]
        for j in range(n):
            total = 0.0
            for k in range(width):
                total += cov[j, k] * big_h[i, k]
            u[j] = total
        for j in range(n):
            correction = noise * gain[j] - u[j]
            for k in range(j, n):
                value = cov[j, k] + correction * gain[k]
                cov[j, k] = value
                cov[k, j] = value
    for j in range(n):
        x[j] += dx[j]
    return True


@kernel
def sound(x, cov):
    """Whether a state can be flown on: finite, radius and speed positive, variances positive."""
    for i in range(x.size):
        if not math.isfinite(x[i]):
            return False
    if not (x[0] > 0.0 and x[3] > 0.0):
        return False
    smallest = math.inf
    for i in range(cov.shape[0]):
        if not math.isfinite(cov[i, i]):
            return False
        smallest = min(smallest, cov[i, i])
    return smallest > 0.0

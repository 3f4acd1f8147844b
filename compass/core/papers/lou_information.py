"""Information filter, also with intermittent measurements: carries ``Y = P^-1``.

``A = Phi^-T Y+ Phi^-1``, ``Y- = (I + A Q)^-1 A``;
``Y+ = Y- + sum_i lambda_i H_i^T R_i^-1 H_i``,
``x+ = x- + sum_i lambda_i K_i (z_i - h_i(x-))``, ``K_i = P H_i^T R_i^-1``, with ``lambda_i`` 1
where the measurement arrived and 0 where not. Algebraically the extended Kalman filter that skips
the missing rows. Y is scaled by the settings' `scale`, and ``(I + A Q)^-1 A`` is better
conditioned than ``A - A (A + Q^-1)^-1 A`` (and allows Q = 0).

References
----------
Lou et al. 2017, doi 10.1155/2017/4378640, eqs. 20 to 29; its A has Phi's transposes exchanged.
"""

import math

from compass.core.jit import kernel
from compass.core.papers.lou_common import (
    choose_rows,
    linearise,
    predict_state,
    row_noise,
    sound,
)
from compass.core.smallmatrix import invert, matmul, solve_general


@kernel
def information_start(settings, bank, work):
    """Write the information matrix of the fused estimate; False if P is not positive definite."""
    if not invert(bank.P, bank.Y, work.a):
        return False
    u = settings.scale
    for i in range(settings.states):
        for j in range(settings.states):
            bank.Y[i, j] *= u[i] * u[j]
    return True


@kernel
def predict_information(settings, y, work):
    """Replace `y` (scaled) by ``(I + A Q)^-1 A``, ``A = Phi^-T Y Phi^-1``; False if singular."""
    n, u = settings.states, settings.scale
    inverse, phi = work.a, work.b
    for i in range(n):
        for j in range(n):
            phi[i, j] = work.phi[i, j] * u[j] / u[i]
            inverse[i, j] = 1.0 if i == j else 0.0
    if not solve_general(phi, inverse):
        return False
    matmul(y, inverse, work.c)
    for i in range(n):
        for j in range(i, n):
            total = 0.0
            for k in range(n):
                total += inverse[k, i] * work.c[k, j]
            y[i, j] = total
            y[j, i] = total
    for i in range(n):
        for j in range(n):
            work.c[i, j] = y[i, j] * settings.q[j] / (u[j] * u[j])
        work.c[i, i] += 1.0
    if not solve_general(work.c, y):
        return False
    for i in range(n):
        for j in range(i):
            mean = 0.5 * (y[i, j] + y[j, i])
            y[i, j] = mean
            y[j, i] = mean
    return True


@kernel
def information_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it diverged."""
    predict_state(settings, epoch.p, bank.x, work)
    if not predict_information(settings, bank.Y, work):
        return False
    linearise(settings, epoch, bank.x, work)
    if epoch.gate < math.inf and not covariance(settings, bank, work):
        return False
    choose_rows(settings, epoch, bank, bank.P, -1, work)
    if not add_information(settings, epoch.z, bank, work):
        return False
    return sound(bank.x, bank.P)


@kernel
def add_information(settings, z, bank, work):
    """Update by the rows in `work.used`, linearised in `work`; False if Y is not definite."""
    n, u = settings.states, settings.scale
    for j in range(n):
        work.u[j] = 0.0
    for i in range(z.size):
        if not work.used[i]:
            continue
        weight = 1.0 / row_noise(settings.r_acc, settings.r_range, i)
        residual = weight * (z[i] - work.h[i])
        for j in range(n):
            slope = work.big_h[i, j] * u[j]
            if slope == 0.0:
                continue
            work.u[j] += slope * residual
            for k in range(n):
                bank.Y[j, k] += weight * slope * work.big_h[i, k] * u[k]
    if not covariance(settings, bank, work):
        return False
    for j in range(n):
        total = 0.0
        for k in range(n):
            total += bank.P[j, k] / u[k] * work.u[k]
        bank.x[j] += total
    return True


@kernel
def covariance(settings, bank, work):
    """Write ``P = Y^-1`` in the state's units; False if Y is not positive definite."""
    n, u = settings.states, settings.scale
    if not invert(bank.Y, bank.P, work.a):
        return False
    for j in range(n):
        for k in range(n):
            bank.P[j, k] *= u[j] * u[k]
    return True

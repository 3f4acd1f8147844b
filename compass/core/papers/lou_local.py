"""What the distributed filters share: local filters of IMU and one beacon, weights, fusion.

Subsystem i updates its own estimate with the accelerometers and range i; a fusion node adds
the subsystems' information matrices with coefficients c_i:
``P = (sum_i c_i Y_i)^-1``, ``x = P sum_i c_i Y_i x_i``.
"""

from compass.core.entry.weights import (
    DETERMINANT,
    EQUAL,
    FAST,
    TRACE,
    equal_weights,
    fast_weights,
    optimal_weights,
    weighted_sum,
)
from compass.core.jit import kernel
from compass.core.papers.lou_common import (
    add_noise,
    choose_rows,
    linearise,
    predict_state,
    propagate,
    sound,
    update,
)
from compass.core.smallmatrix import invert


@kernel
def predict_shared(settings, epoch, bank, work):
    """Move the fused estimate to the epoch, linearise there; True if a subsystem is alive.

    P is left as ``Phi P Phi^T``, without process noise.
    """
    predict_state(settings, epoch.p, bank.x, work)
    propagate(work.phi, bank.P, work.a)
    linearise(settings, epoch, bank.x, work)
    alive = 0
    for i in range(epoch.alive.size):
        alive += 1 if epoch.alive[i] else 0
    return alive > 0


@kernel
def inherit(settings, bank, i, p_factor, q_factor):
    """Give subsystem i the fused prediction, its covariance multiplied by the factors."""
    n = settings.states
    cov = bank.local_cov[i]
    for j in range(bank.x.size):
        bank.local_x[i, j] = bank.x[j]
    for j in range(n):
        for k in range(n):
            cov[j, k] = p_factor * bank.P[j, k]
    add_noise(cov, settings.q, q_factor)


@kernel
def update_local(settings, epoch, bank, i, acc_factor, work):
    """Update subsystem i by its rows and write its scaled information; False if it diverged.

    The linearisation at the subsystem's prediction is in `work`.
    """
    n, u = settings.states, settings.scale
    x, cov, y = bank.local_x[i], bank.local_cov[i], work.information[i]
    choose_rows(settings, epoch, bank, cov, i, work)
    if not update(settings, epoch.z, x, cov, acc_factor, work) or not sound(x, cov):
        return False
    if not invert(cov, y, work.a):
        return False
    for j in range(n):
        for k in range(n):
            y[j, k] *= u[j] * u[k]
    return True


@kernel
def choose_weights(settings, epoch, bank, work):
    """Write the fusion weights by the settings' rule; False if the rule found none."""
    if settings.weighting == EQUAL:
        equal_weights(epoch.alive, bank.weights)
    elif settings.weighting == FAST:
        fast_weights(work.information, epoch.alive, bank.weights, work.a)
    elif settings.weighting in (DETERMINANT, TRACE):
        by_trace = settings.weighting == TRACE
        return optimal_weights(work.information, epoch.alive, by_trace, bank.weights, work)
    return True


@kernel
def fuse(settings, bank, coefficients, work):
    """Write the fused estimate; False if it is not positive definite.

    Sums run over differences from one subsystem's state, so that 3 400 km do not cost digits.
    """
    n, m, u = settings.states, coefficients.size, settings.scale
    first = 0
    while coefficients[first] == 0.0:
        first += 1
    weighted_sum(work.information, coefficients, work.b)
    if not invert(work.b, bank.P, work.a):
        return False
    for j in range(n):
        work.u[j] = 0.0
    for i in range(m):
        if coefficients[i] == 0.0 or i == first:
            continue
        for k in range(n):
            difference = (bank.local_x[i, k] - bank.local_x[first, k]) / u[k]
            for j in range(n):
                work.u[j] += coefficients[i] * work.information[i, j, k] * difference
    for j in range(n):
        total = 0.0
        for k in range(n):
            total += bank.P[j, k] * work.u[k]
        bank.x[j] = bank.local_x[first, j] + u[j] * total
    for j in range(n):
        for k in range(n):
            bank.P[j, k] *= u[j] * u[k]
    return sound(bank.x, bank.P)

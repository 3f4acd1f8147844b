"""The filters of Lou et al. 2017 and 2019, a step each, and the choice among them by number.

All stand on `compass.core.papers.lou_common`; the distributed ones on `lou_local` too.
"""

from compass.core.entry.weights import equal_weights
from compass.core.jit import flat_kernel, kernel
from compass.core.papers.lou_common import (
    add_noise,
    choose_rows,
    linearise,
    predict_state,
    propagate,
    sound,
    update,
)
from compass.core.papers.lou_information import information_start, information_step
from compass.core.papers.lou_local import (
    choose_weights,
    fuse,
    inherit,
    predict_shared,
    update_local,
)

EKF, ITERATED, INFORMATION, CI, CI_FEEDBACK, DCIFAIF, FEDERATED = range(7)

#: Iterations stop when no state moves by more than this share of its predicted sigma.
SMALL_STEP = 1e-6


@kernel
def ekf_step(settings, epoch, bank, work):
    """Centralised extended Kalman filter: every measurement in one filter.

    ``x- = f(x+)``, ``P- = Phi P+ Phi^T + Q``; ``K = P- H^T (H P- H^T + R)^-1``,
    ``x+ = x- + K (z - h(x-))``, ``P+ = (I - K H) P- (I - K H)^T + K R K^T``, with f one Runge-Kutta
    step and Phi its exact derivative. Rows that did not arrive are skipped.

    Move the fused estimate over one epoch; False if it diverged.
    """
    predict_state(settings, epoch.p, bank.x, work)
    propagate(work.phi, bank.P, work.a)
    add_noise(bank.P, settings.q, 1.0)
    linearise(settings, epoch, bank.x, work)
    choose_rows(settings, epoch, bank, bank.P, -1, work)
    if not update(settings, epoch.z, bank.x, bank.P, 1.0, work):
        return False
    return sound(bank.x, bank.P)


@kernel
def iterated_step(settings, epoch, bank, work):
    """Iterated extended Kalman filter: the update relinearised about its own result (Gauss-Newton).

    ``x_(j+1) = x- + K_j (z - h(x_j) - H_j (x- - x_j))``, starting at ``x_0 = x-``; the covariance
    is that of the last linearisation. With one iteration it is the extended Kalman filter.

    Move the fused estimate over one epoch; False if it diverged.
    """
    n = settings.states
    x, predicted = bank.x, bank.local_x[0]
    predict_state(settings, epoch.p, x, work)
    propagate(work.phi, bank.P, work.a)
    add_noise(bank.P, settings.q, 1.0)
    for j in range(x.size):
        predicted[j] = x[j]
    before = work.b
    before[:, :] = bank.P
    linearise(settings, epoch, x, work)
    choose_rows(settings, epoch, bank, before, -1, work)
    for _ in range(settings.iterations):
        for i in range(epoch.z.size):
            for j in range(n):
                work.h[i] += work.big_h[i, j] * (predicted[j] - x[j])
        largest = 0.0
        for j in range(n):
            work.c[0, j] = x[j]
            x[j] = predicted[j]
        bank.P[:, :] = before
        if not update(settings, epoch.z, x, bank.P, 1.0, work) or not sound(x, bank.P):
            return False
        for j in range(n):
            step = x[j] - work.c[0, j]
            largest = max(largest, step * step / before[j, j])
        if largest < SMALL_STEP * SMALL_STEP:
            break
        linearise(settings, epoch, x, work)
    return True


@kernel
def ci_step(settings, epoch, bank, work):
    """Covariance intersection without feedback: the subsystems never learn the fused estimate.

    ``P_CI = (sum_i w_i P_i^-1)^-1``, ``x_CI = P_CI sum_i w_i P_i^-1 x_i`` (Lou et al. 2019, eqs.
    19 and 20). Consistent for every cross-correlation of consistent estimates (Julier and Uhlmann
    1997).

    Move the subsystems and the fused estimate over one epoch; False if one diverged.

    A dead subsystem waits; it comes back from the fused estimate of the epoch before. If all
    are dead the fused estimate is predicted.
    """
    m, any_alive = epoch.alive.size, False
    for i in range(m):
        if not epoch.alive[i]:
            bank.waiting[i] = True
            continue
        any_alive = True
        if bank.waiting[i]:
            bank.local_x[i] = bank.x
            bank.local_cov[i] = bank.P
            bank.waiting[i] = False
        predict_state(settings, epoch.p, bank.local_x[i], work)
        propagate(work.phi, bank.local_cov[i], work.a)
        add_noise(bank.local_cov[i], settings.q, 1.0)
        linearise(settings, epoch, bank.local_x[i], work)
        if not update_local(settings, epoch, bank, i, 1.0, work):
            return False
    if not any_alive:
        predict_state(settings, epoch.p, bank.x, work)
        propagate(work.phi, bank.P, work.a)
        add_noise(bank.P, settings.q, 1.0)
        return True
    if not choose_weights(settings, epoch, bank, work):
        return False
    return fuse(settings, bank, bank.weights, work)


@kernel
def ci_feedback_step(settings, epoch, bank, work):
    """Covariance intersection with feedback: every subsystem starts from the fused estimate.

    ``x_i = x_CI``, ``P_i = P_CI`` after every fusion: the fused estimate is the common prior.

    Move the fused estimate over one epoch; False if it or a subsystem diverged.
    """
    if not predict_shared(settings, epoch, bank, work):
        add_noise(bank.P, settings.q, 1.0)
        return True
    for i in range(epoch.alive.size):
        if epoch.alive[i]:
            inherit(settings, bank, i, 1.0, 1.0)
            if not update_local(settings, epoch, bank, i, 1.0, work):
                return False
    if not choose_weights(settings, epoch, bank, work):
        return False
    return fuse(settings, bank, bank.weights, work)


@kernel
def dcifaif_step(settings, epoch, bank, work):
    """Distributed covariance intersection fusion with adaptive information feedback, as published.

    After every fusion ``x_i = x_CI``, ``P_i = P_CI / w_i`` (Lou et al. 2019, eqs. 19 to 22). The
    feedback discounts the prior a second time, after covariance intersection has: a fading memory
    whose sigma is about twice that of `federated`. Weights are floored in the division alone.

    Move the fused estimate over one epoch; False if it or a subsystem diverged.
    """
    if not predict_shared(settings, epoch, bank, work):
        add_noise(bank.P, settings.q, 1.0)
        return True
    for i in range(epoch.alive.size):
        if epoch.alive[i]:
            inherit(settings, bank, i, 1.0 / max(bank.weights[i], settings.floor), 1.0)
            if not update_local(settings, epoch, bank, i, 1.0, work):
                return False
    if not choose_weights(settings, epoch, bank, work):
        return False
    return fuse(settings, bank, bank.weights, work)


@kernel
def federated_step(settings, epoch, bank, work):
    """Federated filter with sum-fusion: the centralised filter, cut into subsystems.

    ``P_i = P_f / w``, ``Q_i = Q / w``, ``R_acc,i = R_acc / w`` with w = 1 over the number of live
    subsystems, then ``P_f^-1 = sum_i P_i^-1``: shared information is divided before it is added, so
    nothing is counted twice and the result is the centralised filter's to rounding (Carlson 1990).

    Move the fused estimate over one epoch; False if it or a subsystem diverged.
    """
    if not predict_shared(settings, epoch, bank, work):
        add_noise(bank.P, settings.q, 1.0)
        return True
    equal_weights(epoch.alive, bank.weights)
    for i in range(epoch.alive.size):
        if epoch.alive[i]:
            shares = 1.0 / bank.weights[i]
            inherit(settings, bank, i, shares, shares)
            if not update_local(settings, epoch, bank, i, shares, work):
                return False
    coefficients = work.gradient
    for i in range(epoch.alive.size):
        coefficients[i] = 1.0 if epoch.alive[i] else 0.0
    return fuse(settings, bank, coefficients, work)


@flat_kernel
def start(algorithm, settings, bank, work):
    """Make ready what a filter carries besides the start; False if it cannot be made."""
    if algorithm == INFORMATION:
        return information_start(settings, bank, work)
    return True


@flat_kernel
def step(algorithm, settings, epoch, bank, work):
    """Move a bank of estimates over one epoch; False if the filter diverged."""
    bank.gated[:] = False
    if algorithm == EKF:
        return ekf_step(settings, epoch, bank, work)
    if algorithm == ITERATED:
        return iterated_step(settings, epoch, bank, work)
    if algorithm == INFORMATION:
        return information_step(settings, epoch, bank, work)
    if algorithm == CI:
        return ci_step(settings, epoch, bank, work)
    if algorithm == CI_FEEDBACK:
        return ci_feedback_step(settings, epoch, bank, work)
    if algorithm == DCIFAIF:
        return dcifaif_step(settings, epoch, bank, work)
    return federated_step(settings, epoch, bank, work)

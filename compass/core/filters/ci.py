"""Covariance intersection without feedback: the subsystems never learn the fused estimate.

``P_CI = (sum_i w_i P_i^-1)^-1``, ``x_CI = P_CI sum_i w_i P_i^-1 x_i`` (Lou et al. 2019, eqs. 19 and
20). Consistent for every cross-correlation of consistent estimates (Julier and Uhlmann 1997).
"""

from compass.core.filters.common import add_noise, linearise, predict_state, propagate
from compass.core.filters.local import choose_weights, fuse, update_local
from compass.core.jit import kernel


@kernel
def ci_step(settings, epoch, bank, work):
    """Move the subsystems and the fused estimate over one epoch; False if one diverged.

    A dead subsystem waits; it comes back from the fused estimate of the epoch before. If all
    are dead the fused estimate is predicted.
    """
    m, any_alive = epoch.alive.size, False
    for i in range(m):
        if not epoch.alive[i]:
            continue
        any_alive = True
        if bank.weights[i] < 0.0:  # was dead
            bank.local_x[i] = bank.x
            bank.local_cov[i] = bank.P
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

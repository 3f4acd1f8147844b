"""Covariance intersection with feedback: every subsystem starts from the fused estimate.

``x_i = x_CI``, ``P_i = P_CI`` after every fusion: the fused estimate is the common prior.
"""

from compass.core.filters.common import add_noise
from compass.core.filters.local import choose_weights, fuse, inherit, predict_shared, update_local
from compass.core.jit import kernel


@kernel
def ci_feedback_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it or a subsystem diverged."""
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

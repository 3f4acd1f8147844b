"""Distributed covariance intersection fusion with adaptive information feedback, as published.

After every fusion ``x_i = x_CI``, ``P_i = P_CI / w_i`` (Lou et al. 2019, eqs. 19 to 22). The
feedback discounts the prior a second time, after covariance intersection has: a fading memory whose
sigma is about twice that of `federated`. Weights are floored in the division alone.
"""

from compass.core.filters.common import add_noise
from compass.core.filters.local import choose_weights, fuse, inherit, predict_shared, update_local
from compass.core.jit import kernel


@kernel
def dcifaif_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it or a subsystem diverged."""
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

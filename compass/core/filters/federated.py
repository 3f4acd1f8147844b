"""Federated filter with sum-fusion: the centralised filter, cut into subsystems.

``P_i = P_f / w``, ``Q_i = Q / w``, ``R_acc,i = R_acc / w`` with w = 1 over the number of live
subsystems, then ``P_f^-1 = sum_i P_i^-1``: shared information is divided before it is added, so
nothing is counted twice and the result is the centralised filter's to rounding (Carlson 1990).
"""

from compass.core.filters.common import add_noise
from compass.core.filters.local import fuse, inherit, predict_shared, update_local
from compass.core.fusion import equal_weights
from compass.core.jit import kernel


@kernel
def federated_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it or a subsystem diverged."""
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

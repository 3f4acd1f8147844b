"""Centralised extended Kalman filter: every measurement in one filter.

``x- = f(x+)``, ``P- = Phi P+ Phi^T + Q``; ``K = P- H^T (H P- H^T + R)^-1``,
``x+ = x- + K (z - h(x-))``, ``P+ = (I - K H) P- (I - K H)^T + K R K^T``, with f one Runge-Kutta
step and Phi its exact derivative. Rows that did not arrive are skipped.
"""

from compass.core.filters.common import (
    add_noise,
    choose_rows,
    linearise,
    predict_state,
    propagate,
    sound,
    update,
)
from compass.core.jit import kernel


@kernel
def ekf_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it diverged."""
    predict_state(settings, epoch.p, bank.x, work)
    propagate(work.phi, bank.P, work.a)
    add_noise(bank.P, settings.q, 1.0)
    linearise(settings, epoch, bank.x, work)
    choose_rows(settings, epoch, bank, bank.P, -1, work)
    if not update(settings, epoch.z, bank.x, bank.P, 1.0, work):
        return False
    return sound(bank.x, bank.P)

"""Iterated extended Kalman filter: the update relinearised about its own result (Gauss-Newton).

``x_(j+1) = x- + K_j (z - h(x_j) - H_j (x- - x_j))``, starting at ``x_0 = x-``; the covariance is
that of the last linearisation. With one iteration it is the extended Kalman filter.
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

#: Iterations stop when no state moves by more than this share of its predicted sigma.
SMALL_STEP = 1e-6


@kernel
def iterated_step(settings, epoch, bank, work):
    """Move the fused estimate over one epoch; False if it diverged."""
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

"""What ranges and their rates, gathered one after another, tell a user who stands still.

State: the place east, north, up (m), the user's clock (m) and its rate (m/s), then of each
satellite its error radial, along, cross and of its clock (m), constant throughout. A measurement of
a satellite touches nine of them. Covariances are updated one measurement at a time,
``P <- P - P h h' P / (h' P h + sigma^2)``.
"""

import numpy as np

from compass.core.jit import kernel

#: Numbers of the state that are not satellites', and those of one satellite.
OWN, EACH = 5, 4

#: Variance of a clock and of its rate of which nothing is known, m^2 and (m/s)^2.
OFFSET, RATE = 1e12, 1e5


@kernel
def _measure(p, satellite, row, noise, gain):
    """Take one measurement into the covariance `p`; `row` has nine numbers."""
    m = p.shape[0]
    first = OWN + EACH * satellite
    total = noise
    for i in range(m):
        gain[i] = 0.0
        for k in range(OWN + EACH):
            j = k if k < OWN else first + k - OWN
            gain[i] += p[i, j] * row[k]
    for k in range(OWN + EACH):
        total += row[k] * gain[k if k < OWN else first + k - OWN]
    for i in range(m):
        for j in range(i + 1):
            p[i, j] -= gain[i] * gain[j] / total
            p[j, i] = p[i, j]


@kernel
def gather(p, rows, variances, step, noise, free, out):
    """Fill `out` with the covariance of the place after every epoch.

    Parameters
    ----------
    p
        Covariance before the first epoch, shape (m, m); that after the last one is left in it.
    rows
        Partials of range and range rate, shape (t, n, 2, 9).
    variances
        Of both, shape (t, n, 2); infinite where a satellite is not seen.
    step
        Seconds between epochs.
    noise
        What a step adds to the clock and its rate, shape (2, 2).
    free
        Whether the user's clock is another one at every epoch.
    out
        Shape (t, 3, 3).
    """
    m = p.shape[0]
    gain = np.empty(m)
    for k in range(rows.shape[0]):
        if free or k == 0:
            for j in range(m):
                for c in range(3, OWN):
                    p[c, j] = p[j, c] = 0.0
            p[3, 3], p[4, 4] = OFFSET, RATE
        else:
            for j in range(m):
                p[3, j] += step * p[4, j]
            for j in range(m):
                p[j, 3] += step * p[j, 4]
            p[3:5, 3:5] += noise
        for s in range(rows.shape[1]):
            for kind in range(2):
                if variances[k, s, kind] < np.inf:
                    _measure(p, s, rows[k, s, kind], variances[k, s, kind], gain)
        out[k] = p[:3, :3]

"""What each source of error leaves in a linear covariance: the same gains, one source at a time."""

import math

import numpy as np

from compass.core.entry.flow import advance_transition, bank_at
from compass.core.entry.measure import ESTIMATED, measured
from compass.core.entry.predict import moved_covariance
from compass.core.entry.rates import COLUMNS
from compass.core.entry.rates import LIFT as RATIO
from compass.core.entry.update import absorb
from compass.core.jit import fast_kernel, kernel


@fast_kernel
def absorb_share(row, gain, total, own, estimated, half, share):
    """``S = (I - K h) S (I - K h)^T + r K K^T`` in place, for one source.

    Parameters
    ----------
    row, gain, total
        h, ``P h`` of the whole covariance, and ``h P h + R``: Schmidt's gain is their quotient on
        the estimated states and 0 on the others.
    own
        r: variance of the measurement if its noise is this source, else 0.
    estimated
        How many states are estimated.
    half
        Scratch, (s,).
    share
        S, (s, s).
    """
    size = row.size
    inner = own
    for i in range(size):
        half[i] = 0.0
    for j in range(size):
        if row[j] != 0.0:
            for i in range(size):
                half[i] += share[j, i] * row[j]
    for i in range(size):
        inner += row[i] * half[i]
    for i in range(size):
        mine = gain[i] / total if i < estimated else 0.0
        for j in range(i + 1):
            other = gain[j] / total if j < estimated else 0.0
            value = share[i, j] - mine * half[j] - half[i] * other + mine * other * inner
            share[i, j] = value
            share[j, i] = value


@kernel
def shares_run(path, covariance0, problem, starts, shaken, walked, of_kind, shares):
    """Carry each source's covariance along a flight, through the gains of the whole.

    Parameters
    ----------
    path, covariance0, problem
        As in `compass.core.entry.filter.covariance_run`, but that process noise has roots
        (t, 6, j).
    starts
        What each source leaves at the first time, (k, s, s); they sum to `covariance0`.
    shaken
        Which source the process noise is.
    walked
        Which source the variances `walk` of each state are, (s,); -1 for none.
    of_kind
        Which source the noise of each kind is, (c,).
    shares
        Output: what each leaves after the last epoch's measurements, (k, s, s).
    """
    p, bank, times, longest, noise, walk, fade, sources, variances, kinds, places = problem
    size, count = covariance0.shape[0], starts.shape[0]
    covariance, half = covariance0.copy(), np.empty((size, size))
    rows, gain, line = np.zeros((kinds.size, size)), np.empty(size), np.empty(size)
    x, shift, after = np.zeros(size), np.zeros(size), np.empty(6)
    phi, walking, calm = np.empty((6, COLUMNS)), np.empty(size), np.empty((6, noise.shape[2]))
    calm[:, :] = 0.0
    shares[:, :, :] = starts
    for t in range(times.size):
        if t > 0:
            dt = times[t] - times[t - 1]
            advance_transition(
                x, 0.0, p[RATIO], p, bank, times[t - 1], times[t], longest, after, phi
            )
            moved_covariance(phi, dt, noise[t], walk[t], fade[t], places, half, covariance)
            for k in range(count):
                shaking = noise[t] if k == shaken else calm
                for i in range(size):
                    walking[i] = walk[t, i] if k == walked[i] else 0.0
                moved_covariance(phi, dt, shaking, walking, fade[t], places, half, shares[k])
        for i in range(6):
            x[i] = path[t, i]
        angle = bank[bank_at(times[t], bank), 1]
        for b in range(sources.shape[1]):
            for c in range(kinds.size):
                variance = variances[t, b, c]
                if math.isnan(variance):
                    continue
                row = rows[c]
                measured(kinds[c], x, sources[t, b], b, places, p, angle, row)
                absorb(row, 0.0, variance, places[ESTIMATED], gain, covariance, shift)
                total = variance
                for i in range(size):
                    total += row[i] * gain[i]
                for k in range(count):
                    own = variance if of_kind[c] == k else 0.0
                    absorb_share(row, gain, total, own, places[ESTIMATED], line, shares[k])

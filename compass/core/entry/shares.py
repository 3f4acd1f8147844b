"""What each source of error leaves in a linear covariance: the same gains, one source at a time."""

import math

import numpy as np

from compass.core.entry.flow import advance_transition, bank_at
from compass.core.entry.measure import ESTIMATED, measured
from compass.core.entry.predict import moved_covariance
from compass.core.entry.rates import COLUMNS, LIFT, World
from compass.core.jit import fast_kernel, kernel


@fast_kernel
def absorb_share(gain, total, mine, own, estimated, share):
    """``S = (I - K h) S (I - K h)^T + r K K^T`` in place, for one source.

    Parameters
    ----------
    gain, total
        ``P h`` of the whole covariance, and ``h P h + R``: Schmidt's gain is their quotient on the
        estimated states and 0 on the others.
    mine, own
        ``S h``; and ``h S h + r``, r the variance of the measurement if its noise is this source.
    estimated
        How many states are estimated.
    share
        S, (s, s).
    """
    for i in range(gain.size):
        left = gain[i] / total if i < estimated else 0.0
        for j in range(i + 1):
            right = gain[j] / total if j < estimated else 0.0
            value = share[i, j] - left * mine[j] - mine[i] * right + left * right * own
            share[i, j] = value
            share[j, i] = value


@kernel
def shares_run(path, problem, starts, shaken, walked, of_kind, shares):
    """Carry each source's covariance along a flight, through the gains of the whole.

    Parameters
    ----------
    path, problem
        As in `compass.core.entry.filter.covariance_run`, but that process noise has roots
        (t, 6, j).
    starts
        What each source leaves at the first time, (k, s, s); they sum to the covariance there.
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
    count, size, _ = starts.shape
    half, mine, gain = np.empty((size, size)), np.empty((count, size)), np.empty(size)
    rows, x, after = np.zeros((kinds.size, size)), np.zeros(size), np.empty(6)
    phi, walking, calm = np.empty((6, COLUMNS)), np.empty(size), np.zeros((6, noise.shape[2]))
    shares[:, :, :] = starts
    for t in range(times.size):
        if t > 0:
            dt, world = times[t] - times[t - 1], World(p, 0.0, p[LIFT])
            advance_transition(x, world, bank, times[t - 1], times[t], longest, after, phi)
            for k in range(count):
                shaking = noise[t] if k == shaken else calm
                for i in range(size):
                    walking[i] = walk[t, i] if k == walked[i] else 0.0
                moved_covariance(phi, dt, shaking, walking, fade[t], places, half, shares[k])
        x[:6] = path[t]
        angle = bank[bank_at(times[t], bank), 1]
        for b in range(sources.shape[1]):
            for c in range(kinds.size):
                variance = variances[t, b, c]
                if math.isnan(variance):
                    continue
                row = rows[c]
                measured(kinds[c], x, sources[t, b], b, places, p, angle, row)
                gain[:] = 0.0
                for k in range(count):
                    for i in range(size):
                        mine[k, i] = 0.0
                        for j in range(size):
                            mine[k, i] += shares[k, i, j] * row[j]
                        gain[i] += mine[k, i]
                total = variance + (row * gain).sum()
                for k in range(count):
                    own = (row * mine[k]).sum() + (variance if of_kind[c] == k else 0.0)
                    absorb_share(gain, total, mine[k], own, places[ESTIMATED], shares[k])

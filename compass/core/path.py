"""Positions on paths that are one Legendre series for each stretch of time."""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def piece_of(breaks, t):
    """Index of the stretch that holds a time; the nearest one for a time outside."""
    return min(max(np.searchsorted(breaks, t, side="right") - 1, 0), breaks.size - 2)


@kernel
def path_state(breaks, paths, piece, s, t, state):
    """Fill `state` with the position and velocity of satellite `s` at time `t`, m and m/s.

    The derivative by ``P'_{k+1} = P'_{k-1} + (2 k + 1) P_k``.
    """
    half = 0.5 * (breaks[piece + 1] - breaks[piece])
    x = (t - breaks[piece]) / half - 1.0
    p, q = 1.0, 0.0
    slope, before = 0.0, 0.0
    state[:] = 0.0
    for k in range(paths.shape[3]):
        for c in range(3):
            weight = paths[piece, s, c, k]
            state[c] += weight * p
            state[3 + c] += weight * slope / half
        slope, before = before + (2 * k + 1) * p, slope
        p, q = ((2 * k + 1) * x * p - k * q) / (k + 1), p


@kernel
def path_place(breaks, paths, piece, s, t, place):
    """Fill `place` with the position of satellite `s` at time `t`, as `path_state` does, m."""
    x = 2.0 * (t - breaks[piece]) / (breaks[piece + 1] - breaks[piece]) - 1.0
    p, q = 1.0, 0.0
    place[:] = 0.0
    for k in range(paths.shape[3]):
        for c in range(3):
            place[c] += paths[piece, s, c, k] * p
        p, q = ((2 * k + 1) * x * p - k * q) / (k + 1), p


@kernel
def path_states(breaks, paths, times):
    """Positions and velocities at many times, two arrays of shape (n, t, 3)."""
    n = paths.shape[1]
    r, v = np.empty((n, times.size, 3)), np.empty((n, times.size, 3))
    state = np.empty(6)
    for i in range(times.size):
        piece = piece_of(breaks, times[i])
        for s in range(n):
            path_state(breaks, paths, piece, s, times[i], state)
            r[s, i] = state[:3]
            v[s, i] = state[3:]
    return r, v


@kernel
def pull_bound(breaks, paths, piece, s):
    """Bound on the acceleration on a whole stretch, m/s^2.

    No Legendre polynomial exceeds 1, so that the sum of the magnitudes of the coefficients does;
    those of a derivative are ``d_k = (2 k + 1) (c_{k+1} + c_{k+3} + ...)``.
    """
    half = 0.5 * (breaks[piece + 1] - breaks[piece])
    size = paths.shape[3]
    first, second = np.zeros((3, size + 2)), np.zeros((3, size + 2))
    total = 0.0
    for k in range(size - 2, -1, -1):
        for c in range(3):
            first[c, k] = first[c, k + 2] + paths[piece, s, c, k + 1]
    for k in range(size - 2, -1, -1):
        squared = 0.0
        for c in range(3):
            second[c, k] = second[c, k + 2] + (2 * k + 3) * first[c, k + 1]
            squared += (second[c, k] * (2 * k + 1)) ** 2
        total += math.sqrt(squared)
    return total / (half * half)

"""Covariance of many orbits and clocks, updated range by range; some errors only considered.

Each satellite has nine numbers: position, velocity, clock, clock rate, scale of sunlight's push.
Behind them stand the considered ones, constants that no measurement is allowed to improve: their
rows of the gain are zero. The last of them, the field of gravity, move the satellites. The gain may
know their sigmas (Schmidt 1966, Application of state-space methods to navigation problems) or be
blind to them (the classical consider batch). The covariance is updated for whatever gain:
``P - k h - h'k' + s k k'`` with ``h = H P``, ``s = H P H' + sigma^2``.
"""

import numpy as np

from compass.core.jit import kernel

#: Numbers of a satellite, and those of them that forces move: position and velocity.
STATES = 9
MOVED = 6


@kernel
def _predict(p, transition, drive, noise, scratch):
    """Move the covariance over a step: ``F P F' + Q``, F and Q made of a block each satellite.

    F holds besides what the last considered numbers do to every satellite.
    """
    n, size, driven = transition.shape[0], p.shape[0], drive.shape[2]
    field = size - driven
    for s in range(n):
        first = STATES * s
        for i in range(STATES):
            for j in range(size):
                total = 0.0
                for k in range(STATES):
                    total += transition[s, i, k] * p[first + k, j]
                if i < MOVED:
                    for g in range(driven):
                        total += drive[s, i, g] * p[field + g, j]
                scratch[i, j] = total
        p[first : first + STATES] = scratch
    for i in range(size):
        for s in range(n):
            first = STATES * s
            for j in range(STATES):
                total = 0.0
                for k in range(STATES):
                    total += p[i, first + k] * transition[s, j, k]
                if j < MOVED:
                    for g in range(driven):
                        total += p[i, field + g] * drive[s, j, g]
                scratch[j, 0] = total
            for j in range(STATES):
                p[i, first + j] = scratch[j, 0]
    for s in range(n):
        for i in range(STATES):
            for j in range(STATES):
                p[STATES * s + i, STATES * s + j] += noise[i, j]


@kernel
def _along(p, columns, values, h):
    """Fill ``h = H P`` of a row with `values` at `columns`, -1 where none; return ``H P H'``."""
    size = p.shape[0]
    h[:] = 0.0
    for k in range(columns.size):
        if columns[k] >= 0 and values[k] != 0.0:
            for j in range(size):
                h[j] += values[k] * p[columns[k], j]
    s = 0.0
    for k in range(columns.size):
        if columns[k] >= 0:
            s += values[k] * h[columns[k]]
    return s


@kernel
def _update(p, s, h, gain):
    """Covariance after a measurement taken with a gain, whatever it is: P - k h - h'k' + s k k'."""
    size = p.shape[0]
    for i in range(size):
        for j in range(i, size):
            p[i, j] += s * gain[i] * gain[j] - gain[i] * h[j] - h[i] * gain[j]
            p[j, i] = p[i, j]


@kernel
def follow(
    p, believed, transitions, drives, noise, first, columns, values, variances, estimated, out
):
    """Covariance along an arc: at every epoch the measurements, then the step to the next.

    Parameters
    ----------
    p
        Covariance before the first epoch, worked on in place, shape (size, size); metres, m/s.
    believed
        The covariance that gains are made of where they are blind to what is considered: the same
        with nothing in its place; shape (size, size), or (0, 0) where they are not.
    transitions
        Of every satellite from an epoch to the next, shape (epoch - 1, satellite, 9, 9).
    drives
        What the last g considered numbers do to position and velocity meanwhile, shape (epoch - 1,
        satellite, 6, g).
    noise
        Covariance that a step adds to a satellite, shape (9, 9).
    first
        Number of each epoch's first measurement and, in the end, of all, shape (epoch + 1,).
    columns, values
        Rows of the measurements, shape (measurement, w).
    variances
        Of their noise, shape (measurement,).
    estimated
        How many numbers are estimated; those behind are considered.
    out
        Filled; covariance of position and clock of each satellite, shape (epoch, satellite, 4, 4).
    """
    epochs, n, size = out.shape[0], out.shape[1], p.shape[0]
    scratch, h, gain = np.zeros((STATES, size)), np.zeros(size), np.zeros(size)
    blind, seen = believed.shape[0] > 0, np.zeros(size)
    told = np.array([0, 1, 2, 6])
    for t in range(epochs):
        if t > 0:
            _predict(p, transitions[t - 1], drives[t - 1], noise, scratch)
            if blind:
                _predict(believed, transitions[t - 1], drives[t - 1], noise, scratch)
        for m in range(first[t], first[t + 1]):
            s2 = variances[m] + _along(p, columns[m], values[m], h)
            if blind:
                b2 = variances[m] + _along(believed, columns[m], values[m], seen)
                for j in range(size):
                    gain[j] = seen[j] / b2 if j < estimated else 0.0
                _update(believed, b2, seen, gain)
            else:
                for j in range(size):
                    gain[j] = h[j] / s2 if j < estimated else 0.0
            _update(p, s2, h, gain)
        for s in range(n):
            for i in range(4):
                for j in range(4):
                    out[t, s, i, j] = p[STATES * s + told[i], STATES * s + told[j]]


@kernel
def in_turn(busy):
    """One satellite at every epoch: the next in view after the last, round and round.

    Parameters
    ----------
    busy
        Which are in view, shape (satellite, epoch).
    """
    n = busy.shape[0]
    chosen, last = np.zeros_like(busy), -1
    for t in range(busy.shape[1]):
        for k in range(1, n + 1):
            s = (last + k) % n
            if busy[s, t]:
                chosen[s, t], last = True, s
                break
    return chosen

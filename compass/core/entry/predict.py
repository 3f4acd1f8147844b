"""From one epoch to the next: an estimate and its covariance, or root of it, moved."""

import math

import numpy as np

from compass.core.entry.flow import advance_spread, advance_transition
from compass.core.entry.kinds import ROOTED, UNSCENTED
from compass.core.entry.measure import AIR, ATTITUDE, CLOCK, GYRO, LIFT, world_of
from compass.core.entry.rates import COLUMNS, OF_AIR, OF_LIFT
from compass.core.entry.root import triangle
from compass.core.jit import fast_kernel, inline_kernel, kernel


@inline_kernel
def rate_of(i, places):
    """State by which state i grows each second, -1 for none: drift of a clock, or of axes."""
    if i == places[CLOCK]:
        return i + 1
    if places[GYRO] >= 0 and 0 <= i - places[ATTITUDE] < 3:
        return places[GYRO] + i - places[ATTITUDE]
    return -1


@fast_kernel
def moved_rows(phi, dt, fade, places, matrix, out):
    """``F A`` of a matrix A (s, k), F made as in `moved_covariance`."""
    air, lift = places[AIR], places[LIFT]
    for i in range(6):
        for j in range(matrix.shape[1]):
            total = 0.0
            for k in range(6):
                total += phi[i, k] * matrix[k, j]
            if air >= 0:
                total += phi[i, OF_AIR] * matrix[air, j]
            if lift >= 0:
                total += phi[i, OF_LIFT] * matrix[lift, j]
            out[i, j] = total
    for i in range(6, matrix.shape[0]):
        rate = rate_of(i, places)
        for j in range(matrix.shape[1]):
            out[i, j] = fade * matrix[i, j] if i == air else matrix[i, j]
            if rate >= 0:
                out[i, j] += dt * matrix[rate, j]


@kernel
def moved_root(phi, dt, noise, walk, fade, places, root):
    """As `moved_covariance`, of the root S: the triangle of ``[F S, G, W^(1/2)]``."""
    size, shaken = root.shape[0], noise.shape[1]
    rows = np.zeros((size, 2 * size + shaken))
    moved_rows(phi, dt, fade, places, root, rows[:, :size])
    rows[:6, size : size + shaken] = noise
    for i in range(6, size):
        rows[i, size + shaken + i] = math.sqrt(walk[i])
    triangle(rows, root)


@fast_kernel
def moved_covariance(phi, dt, noise, walk, fade, places, half, covariance):
    """``P = F P F^T + G G^T + W`` in place, with F made of `phi` and of what stays as it is.

    Parameters
    ----------
    phi
        Derivative of position and velocity, (6, 8), of `advance_transition`.
    dt
        Seconds.
    noise
        G (6, k): root of the process noise of the step.
    walk, fade
        Variance that all states but the first six gather over the step, (s,), and what is left
        of the logarithm of the density at its end.
    places
        See `compass.core.entry.measure.PLACES`.
    half
        Scratch, (s, s).
    covariance
        P, (s, s).
    """
    size = covariance.shape[0]
    air, lift = places[AIR], places[LIFT]
    moved_rows(phi, dt, fade, places, covariance, half)
    for i in range(size):
        for j in range(min(i + 1, 6)):
            total = 0.0
            for k in range(6):
                total += half[i, k] * phi[j, k]
            if air >= 0:
                total += half[i, air] * phi[j, OF_AIR]
            if lift >= 0:
                total += half[i, lift] * phi[j, OF_LIFT]
            if i < 6:
                for k in range(noise.shape[1]):
                    total += noise[i, k] * noise[j, k]
            covariance[i, j] = total
            covariance[j, i] = total
        for j in range(6, i + 1):
            value = fade * half[i, j] if j == air else half[i, j]
            rate = rate_of(j, places)
            if rate >= 0:
                value += dt * half[i, rate]
            covariance[i, j] = value
            covariance[j, i] = value
        if i >= 6:
            covariance[i, i] += walk[i]


@kernel
def spread_factor(covariance, places, factor):
    """Cholesky factor of what moves: position, velocity, density, L/D; a known one's is zero."""
    for i in range(COLUMNS):
        at = i if i < 6 else places[AIR] if i == OF_AIR else places[LIFT]
        for j in range(i + 1):
            other = j if j < 6 else places[AIR] if j == OF_AIR else places[LIFT]
            factor[j, i] = 0.0
            total = covariance[at, other] if at >= 0 and other >= 0 else 0.0
            for k in range(j):
                total -= factor[i, k] * factor[j, k]
            if i == j:
                factor[i, i] = math.sqrt(total)
            else:
                factor[i, j] = total / factor[j, j] if factor[j, j] > 0.0 else 0.0


@kernel
def move(x, covariance, base, problem, t, method, half):
    """Move an estimate to epoch t from that before, linearised at `base` (which may be `x`)."""
    bank, longest, places = problem.bank, problem.longest, problem.places
    world, start, stop = world_of(problem.p, base, places), problem.times[t - 1], problem.times[t]
    noise, walk, fade = problem.noise[t], problem.walk[t], problem.fade[t]
    after, phi = np.empty(6), np.empty((6, COLUMNS))
    roots, shaken = np.zeros((6, 6 + COLUMNS)), noise.shape[0]
    for i in range(shaken):
        for j in range(6):
            roots[i, j] = noise[i, j]
    air, lift, count = places[AIR], places[LIFT], shaken
    if method == UNSCENTED:
        factor, bend = np.empty((COLUMNS, COLUMNS)), np.empty((6, COLUMNS))
        spread_factor(covariance, places, factor)
        advance_spread(base, factor, world, bank, start, stop, longest, after, phi, bend)
        roots[:, 6:] = bend
        count = 6 + COLUMNS
    else:
        advance_transition(base, world, bank, start, stop, longest, after, phi)
    if method == ROOTED:
        moved_root(phi, stop - start, roots[:, :count], walk, fade, places, covariance)
    else:
        moved_covariance(phi, stop - start, roots[:, :count], walk, fade, places, half, covariance)
    for i in range(6):
        for k in range(6):
            after[i] += phi[i, k] * (x[k] - base[k])
        if air >= 0:
            after[i] += phi[i, OF_AIR] * (x[air] - base[air])
        if lift >= 0:
            after[i] += phi[i, OF_LIFT] * (x[lift] - base[lift])
    for i in range(6):
        x[i] = after[i]
    for i in range(6, x.size):
        rate = rate_of(i, places)
        if rate >= 0:
            x[i] += (stop - start) * x[rate]
    if air >= 0:
        x[air] *= fade

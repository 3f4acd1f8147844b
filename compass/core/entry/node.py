"""The node that weighs the estimates of subsystems and makes them one."""

import math

import numpy as np

from compass.core.entry.weights import (
    EQUAL,
    FAST,
    TRACE,
    equal_weights,
    fast_weights,
    optimal_weights,
    weighted_sum,
)
from compass.core.jit import kernel
from compass.core.smallmatrix import invert


@kernel
def sound(x, cov):
    """Whether an estimate can be flown on: finite, its variances positive."""
    for i in range(x.size):
        if not (math.isfinite(x[i]) and cov[i, i] > 0.0 and cov[i, i] < math.inf):
            return False
    return True


@kernel
def fuse(arrangement, coefficients, estimates, work):
    """Write the fused estimate; False if it is not positive definite.

    Sums run over differences from one subsystem's state, so that 3 400 km do not cost digits.
    """
    x, cov, u, gain = estimates.x, estimates.P, arrangement.scale, np.zeros(estimates.x.size)
    first = 0
    while coefficients[first] == 0.0:
        first += 1
    weighted_sum(estimates.information, coefficients, work.b)
    if not invert(work.b, cov, work.a):
        return False
    for i in range(first + 1, coefficients.size):
        for k in range(x.size):
            apart = (estimates.local_x[i, k] - estimates.local_x[first, k]) / u[k]
            for j in range(x.size):
                gain[j] += coefficients[i] * estimates.information[i, j, k] * apart
    for j in range(x.size):
        total = 0.0
        for k in range(x.size):
            total += cov[j, k] * gain[k]
        x[j] = estimates.local_x[first, j] + u[j] * total
    for j in range(x.size):
        for k in range(x.size):
            cov[j, k] *= u[j] * u[k]
    return sound(x, cov)


@kernel
def turned(x, y, half, out):
    """Write a symmetric matrix over the states, its first six along up, track and across."""
    axes = np.empty((3, 3))
    r, q, v = 0.0, 0.0, 0.0
    for i in range(3):
        r += x[i] * x[i]
        q += x[i] * x[3 + i]
    for i in range(3):
        axes[0, i] = x[i] / math.sqrt(r)
        axes[1, i] = x[3 + i] - q / r * x[i]
        v += axes[1, i] * axes[1, i]
    for i in range(3):
        axes[1, i] /= math.sqrt(v)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        axes[2, i] = axes[0, j] * axes[1, k] - axes[0, k] * axes[1, j]
    half[:, :] = y
    for a in range(6):
        for b in range(y.shape[0]):
            total = 0.0
            for i in range(3):
                total += axes[a % 3, i] * y[a - a % 3 + i, b]
            half[a, b] = total
    out[:, :] = half
    for a in range(y.shape[0]):
        for b in range(6):
            total = 0.0
            for i in range(3):
                total += axes[b % 3, i] * half[a, b - b % 3 + i]
            out[a, b] = total


@kernel
def weigh(arrangement, alive, estimates, half, work):
    """Write information matrices and weights of the live subsystems; False if there are none."""
    u = arrangement.scale
    for i in range(alive.size):
        if not alive[i]:
            continue
        y = estimates.information[i]
        if not invert(estimates.local_cov[i], y, work.a):
            return False
        for j in range(u.size):
            for k in range(u.size):
                y[j, k] *= u[j] * u[k]
    if arrangement.divided or arrangement.rule == EQUAL:
        equal_weights(alive, estimates.weights)
    elif arrangement.rule == FAST:  # its norm depends on the axes: those of the vehicle
        for i in range(alive.size):
            if alive[i]:
                turned(estimates.x, estimates.information[i], half, work.stack[i])
        fast_weights(work.stack, alive, estimates.weights, work.a)
    else:
        return optimal_weights(
            estimates.information, alive, arrangement.rule == TRACE, estimates.weights, work
        )
    return True

"""Weights of covariance intersection, ``Y = sum_i w_i Y_i`` with ``sum_i w_i = 1``, ``w_i >= 0``.

Information matrices come scaled: element (a, b) times ``u_a u_b``, with u the size of each
state that counts as one. The determinant rule does not depend on u; the trace and the fast
rule do. Subsystems that are not alive get weight 0.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import kernel
from compass.core.smallmatrix import cholesky, cholesky_solve, invert, log_determinant, matmul

EQUAL, FAST, DETERMINANT, TRACE = 0, 1, 2, 3

#: Newton's method stops when the objective can gain at most this much: nats of ln det Y, or
#: this share of the trace of P (both follow from the gradient alone, the problems being convex).
WEIGHT_GAP = 1e-10
MOST_STEPS = 60

Array = NDArray[np.float64]


class Scratch(NamedTuple):
    """What the rules write before they read: (n, n) thrice, (m, n, n), (m,), (m, m) and so on."""

    a: Array
    b: Array
    c: Array
    stack: Array
    gradient: Array
    hessian: Array
    factor: Array
    direction: Array
    trial: Array
    used: NDArray[np.bool_]


@kernel
def make_scratch(n, m):
    """Return scratch for m subsystems of n states."""
    return Scratch(
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((m, n, n)),
        np.zeros(m),
        np.zeros((m, m)),
        np.zeros((m, m)),
        np.zeros(m),
        np.zeros(m),
        np.zeros(m, dtype=np.bool_),
    )


@kernel
def infinity_norm(a, b, sign):
    """Largest row sum of ``|a + sign b|``."""
    n = a.shape[0]
    largest = 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += abs(a[i, j] + sign * b[i, j])
        largest = max(largest, total)
    return largest


@kernel
def equal_weights(alive, weights):
    """Write the same weight for every live subsystem."""
    count = 0
    for i in range(weights.size):
        count += 1 if alive[i] else 0
    for i in range(weights.size):
        weights[i] = 1.0 / count if alive[i] else 0.0


@kernel
def fast_weights(information, alive, weights, total):
    """Write the weights of information contribution in the infinity norm.

    ``w_i = (|Y| - |Y - Y_i| + |Y_i|) / (n |Y| + sum_j (|Y_j| - |Y - Y_j|))``, ``Y = sum_j Y_j``.
    By the triangle inequality none is negative; they sum to 1. `total` (n, n) is scratch.
    """
    m, n = information.shape[0], information.shape[1]
    for a in range(n):
        for b in range(n):
            part = 0.0
            for i in range(m):
                if alive[i]:
                    part += information[i, a, b]
            total[a, b] = part
    whole = infinity_norm(total, total, 0.0)
    denominator = 0.0
    for i in range(m):
        weights[i] = 0.0
        if alive[i]:
            without = infinity_norm(total, information[i], -1.0)
            alone = infinity_norm(information[i], information[i], 0.0)
            weights[i] = whole - without + alone
            denominator += weights[i]
    for i in range(m):
        weights[i] /= denominator


@kernel
def weighted_sum(information, weights, out):
    """Write ``sum_i w_i Y_i``."""
    m, n = information.shape[0], information.shape[1]
    for a in range(n):
        for b in range(n):
            part = 0.0
            for i in range(m):
                part += weights[i] * information[i, a, b]
            out[a, b] = part


@kernel
def objective(information, weights, by_trace, y, factor, p):
    """``-ln det Y`` or ``ln tr P`` of a set of weights, nats; nan if Y is not positive definite."""
    weighted_sum(information, weights, y)
    if not by_trace:
        return -log_determinant(factor) if cholesky(y, factor) else math.nan
    if not invert(y, p, factor):
        return math.nan
    total = 0.0
    for i in range(p.shape[0]):
        total += p[i, i]
    return math.log(total)


@kernel
def optimal_weights(information, alive, by_trace, weights, work):
    """Write the weights that minimise det P or tr P; False if no combination is definite.

    Newton's method on the simplex with an active set: minimise ``f(w) = -ln det Y`` with
    ``df/dw_i = -tr(P Y_i)`` and ``d2f/dw_i dw_j = tr(P Y_i P Y_j)``, or ``f(w) = tr P`` with
    ``-tr(P Y_i P)`` and ``2 tr(P Y_i P Y_j P)``. Both are convex, so
    ``max_i g_i - sum_i w_i g_i`` (g the negative gradient) bounds what is left to gain.

    Parameters
    ----------
    information
        Scaled information matrices, shape (m, n, n).
    alive
        Which subsystems take part, shape (m,).
    by_trace
        Minimise the trace instead of the determinant.
    weights
        Start and result, shape (m,).
    work
        Scratch as made by `make_scratch`.
    """
    m, n = information.shape[0], information.shape[1]
    y, p, factor, product = work.a, work.b, work.c, work.stack
    gradient, hessian, direction, trial = work.gradient, work.hessian, work.direction, work.trial
    equal_weights(alive, weights)
    value = objective(information, weights, by_trace, y, factor, p)
    if not math.isfinite(value):
        return False
    for _ in range(MOST_STEPS):
        weighted_sum(information, weights, y)
        if not invert(y, p, factor):
            return False
        trace = 0.0
        for a in range(n):
            trace += p[a, a]
        best, mean = 0.0, 0.0
        for i in range(m):
            gradient[i] = 0.0
            if not alive[i]:
                continue
            matmul(p, information[i], product[i])  # P Y_i
            for a in range(n):
                if by_trace:
                    for b in range(n):
                        gradient[i] += product[i, a, b] * p[b, a] / trace
                else:
                    gradient[i] += product[i, a, a]
            best = max(best, gradient[i])
            mean += weights[i] * gradient[i]
        if best - mean <= WEIGHT_GAP:
            return True
        for i in range(m):
            for j in range(i, m):
                total = 0.0
                if alive[i] and alive[j]:
                    if by_trace:  # tr(P Y_i P Y_j P)
                        matmul(product[i], product[j], y)
                        for a in range(n):
                            for b in range(n):
                                total += 2.0 * y[a, b] * p[b, a] / trace
                    else:
                        for a in range(n):
                            for b in range(n):
                                total += product[i, a, b] * product[j, b, a]
                hessian[i, j] = total
                hessian[j, i] = total
        if not _newton_direction(weights, alive, mean, work):
            return True
        step = 1.0
        for i in range(m):
            if direction[i] < 0.0:
                step = min(step, -weights[i] / direction[i])
        slope = 0.0
        for i in range(m):
            slope -= gradient[i] * direction[i]
        moved = False
        for _ in range(40):
            for i in range(m):
                trial[i] = max(weights[i] + step * direction[i], 0.0)
                if trial[i] < 1e-15:
                    trial[i] = 0.0
            candidate = objective(information, trial, by_trace, y, factor, p)
            if candidate <= value + 1e-4 * step * slope:
                moved = candidate < value
                break
            step *= 0.5
        if not moved:  # rounding is all that is left
            return True
        value = candidate
        total = 0.0
        for i in range(m):
            total += trial[i]
        for i in range(m):
            weights[i] = trial[i] / total
    return True


@kernel
def _newton_direction(weights, alive, multiplier, work):
    """Write Newton's direction with zero sum that leaves no weight below 0; False if it is 0.

    Weights at 0 whose gradient says so, or that the direction would push below 0, stay there.
    """
    m = weights.size
    gradient, hessian, direction = work.gradient, work.hessian, work.direction
    system, factor, free = work.trial, work.factor, work.used
    scale = 0.0
    for i in range(m):
        scale = max(scale, hessian[i, i])
        free[i] = alive[i] and (weights[i] > 0.0 or gradient[i] > multiplier)
    for _ in range(m):
        # block elimination: H d = g - lambda 1 with 1^T d = 0, by a Cholesky factor of H
        for i in range(m):
            for j in range(m):
                factor[i, j] = hessian[i, j] if free[i] and free[j] else 0.0
            factor[i, i] += 1e-11 * scale if free[i] else 1.0
        if not cholesky(factor, factor):
            return False
        for i in range(m):
            direction[i] = gradient[i] if free[i] else 0.0
            system[i] = 1.0 if free[i] else 0.0
        cholesky_solve(factor, direction)
        cholesky_solve(factor, system)
        over, under = 0.0, 0.0
        for i in range(m):
            over += direction[i]
            under += system[i]
        shift = over / under
        blocked = False
        largest = 0.0
        for i in range(m):
            direction[i] = direction[i] - shift * system[i] if free[i] else 0.0
            if free[i] and weights[i] <= 0.0 and direction[i] < 0.0:
                free[i] = False
                blocked = True
            largest = max(largest, abs(direction[i]))
        if not blocked:
            return largest > 0.0
    return False

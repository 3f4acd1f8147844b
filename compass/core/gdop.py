"""Geometric dilution of precision at scattered places, for ranks of many points."""

import math

import numpy as np

from compass.core.jit import fast_kernel


@fast_kernel
def gdop_at(r, place, sphere_radius, sin_mask):
    """Fold and GDOP of a user at ``sphere_radius place``; GDOP is infinite with fold below 4.

    ``GDOP = sqrt(trace (H^T H)^-1)`` with rows ``(unit line of sight, 1)`` of H for the satellites
    `r`, shape (n, 3), whose elevation's sine is `sin_mask` or more.
    """
    m = np.zeros((4, 4))
    row = np.ones(4)
    fold = 0
    for s in range(r.shape[0]):
        dx = r[s, 0] - sphere_radius * place[0]
        dy = r[s, 1] - sphere_radius * place[1]
        dz = r[s, 2] - sphere_radius * place[2]
        norm = math.sqrt(dx * dx + dy * dy + dz * dz)
        row[0], row[1], row[2] = dx / norm, dy / norm, dz / norm
        if row[0] * place[0] + row[1] * place[1] + row[2] * place[2] < sin_mask:
            continue
        fold += 1
        for i in range(4):
            for j in range(i + 1):
                m[i, j] += row[i] * row[j]
    if fold < 4:
        return fold, math.inf
    # Cholesky factor in place, then the squared norm of its inverse
    for j in range(4):
        for i in range(j, 4):
            total = m[i, j]
            for q in range(j):
                total -= m[i, q] * m[j, q]
            if i == j:
                if total <= 1e-14:
                    return fold, math.inf
                m[j, j] = math.sqrt(total)
            else:
                m[i, j] = total / m[j, j]
    trace = 0.0
    column = np.empty(4)
    for c in range(4):
        for i in range(c, 4):
            total = 1.0 if i == c else 0.0
            for q in range(c, i):
                total -= m[i, q] * column[q]
            column[i] = total / m[i, i]
            trace += column[i] * column[i]
    return fold, math.sqrt(trace)


@fast_kernel
def gdop_over(r, places, sphere_radius, sin_mask):
    """`gdop_at` for moments r, shape (t, n, 3), and places, shape (t, q, 3): arrays (t, q)."""
    moments, count = places.shape[0], places.shape[1]
    fold = np.empty((moments, count), dtype=np.int64)
    gdop = np.empty((moments, count))
    for t in range(moments):
        for q in range(count):
            fold[t, q], gdop[t, q] = gdop_at(r[t], places[t, q], sphere_radius, sin_mask)
    return fold, gdop

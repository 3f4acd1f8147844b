"""Dilution of precision at scattered places, for ranks of many points."""

import math

import numpy as np

from compass.core.dop import GDOP, PDOP, dops
from compass.core.jit import fast_kernel


@fast_kernel
def dops_at(r, place, sphere_radius, sin_mask):
    """Fold, GDOP and PDOP of a user at ``sphere_radius place``; infinite with fold below 4.

    Satellites `r`, shape (n, 3), count if the sine of their elevation is `sin_mask` or more.
    """
    fold = 0
    xx = yy = zz = xy = xz = yz = x = y = z = 0.0
    for s in range(r.shape[0]):
        dx = r[s, 0] - sphere_radius * place[0]
        dy = r[s, 1] - sphere_radius * place[1]
        dz = r[s, 2] - sphere_radius * place[2]
        norm = math.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / norm, dy / norm, dz / norm
        if dx * place[0] + dy * place[1] + dz * place[2] >= sin_mask:
            fold += 1
            x, y, z = x + dx, y + dy, z + dz
            xx, yy, zz = xx + dx * dx, yy + dy * dy, zz + dz * dz
            xy, xz, yz = xy + dx * dy, xz + dx * dz, yz + dy * dz
    if fold < 4:
        return fold, math.inf, math.inf
    dilutions = dops(float(fold), xx, yy, zz, xy, xz, yz, x, y, z, place[0], place[1], place[2])
    return fold, dilutions[GDOP], dilutions[PDOP]


@fast_kernel
def dops_over(r, places, sphere_radius, sin_mask, fold, gdop, pdop):
    """`dops_at` for moments r, shape (t, n, 3), at the same places, shape (q, 3), in each.

    Fills `fold`, `gdop` and `pdop`, shape (t, q).
    """
    for t in range(r.shape[0]):
        for q in range(places.shape[0]):
            fold[t, q], gdop[t, q], pdop[t, q] = dops_at(r[t], places[q], sphere_radius, sin_mask)


@fast_kernel
def gdop_over(r, places, sphere_radius, sin_mask):
    """Fold and GDOP for moments r, shape (t, n, 3), and places, shape (t, q, 3): arrays (t, q)."""
    moments, count = places.shape[0], places.shape[1]
    fold = np.empty((moments, count), dtype=np.int64)
    gdop = np.empty((moments, count))
    for t in range(moments):
        for q in range(count):
            fold[t, q], gdop[t, q], _ = dops_at(r[t], places[t, q], sphere_radius, sin_mask)
    return fold, gdop

"""Dilution of precision at scattered places, for ranks of many points."""

import math

import numpy as np

from compass.core.dop import GDOP, PDOP, PX, PY, TILE, XX, XY, XZ, YY, YZ, ZZ, N, X, Y, Z, dops
from compass.core.jit import fused_kernel, inline_kernel

# Where in a tile, besides the parts of `compass.core.dop`: a place's third component, the answers.
PZ, GDOPS, PDOPS = 12 * TILE, XX, YY


@fused_kernel
def dops_over(r, places, sphere_radius, sin_mask, fold, gdop, pdop):
    """Fold, GDOP and PDOP of users at ``sphere_radius places``, shape (q, 3), at every moment.

    Satellites `r`, shape (t, n, 3), count if the sine of their elevation is `sin_mask` or more.
    Fills `fold`, `gdop` and `pdop`, shape (t, q); infinite with fold below 4. Places are
    worked through in tiles, several at once, all satellites for each: one out of view counts
    nothing.
    """
    tile = np.empty(13 * TILE)
    for first in range(0, places.shape[0], TILE):
        width = min(TILE, places.shape[0] - first)
        for j in range(width):
            place = places[first + j]
            tile[PX + j], tile[PY + j], tile[PZ + j] = place[0], place[1], place[2]
        for t in range(r.shape[0]):
            tile[:PX] = 0.0
            for s in range(r.shape[1]):
                x, y, z = r[t, s, 0], r[t, s, 1], r[t, s, 2]
                _add_seen(tile, width, x / sphere_radius, y / sphere_radius, z / sphere_radius,
                          sin_mask)  # fmt: skip
            _solve(tile, width)
            for j in range(width):
                fold[t, first + j] = tile[N + j]
                gdop[t, first + j], pdop[t, first + j] = tile[GDOPS + j], tile[PDOPS + j]


@inline_kernel
def _add_seen(tile, width, rx, ry, rz, sin_mask):
    """Add a satellite's line of sight to the moments of the places that have it in view."""
    r2 = rx * rx + ry * ry + rz * rz + 1.0
    for j in range(width):
        px, py, pz = tile[PX + j], tile[PY + j], tile[PZ + j]
        along = rx * px + ry * py + rz * pz
        w = 1.0 / math.sqrt(r2 - 2.0 * along)
        seen = 1.0 if (along - 1.0) * w >= sin_mask else 0.0
        w *= seen
        x, y, z = (rx - px) * w, (ry - py) * w, (rz - pz) * w
        tile[XX + j] += x * x
        tile[YY + j] += y * y
        tile[ZZ + j] += z * z
        tile[XY + j] += x * y
        tile[XZ + j] += x * z
        tile[YZ + j] += y * z
        tile[X + j] += x
        tile[Y + j] += y
        tile[Z + j] += z
        tile[N + j] += seen


@inline_kernel
def _solve(tile, width):
    """Turn moments into GDOP and PDOP, which take the place of the first two."""
    for j in range(width):
        dilutions = dops(
            tile[N + j], tile[XX + j], tile[YY + j], tile[ZZ + j], tile[XY + j], tile[XZ + j],
            tile[YZ + j], tile[X + j], tile[Y + j], tile[Z + j], 0.0, 0.0, 1.0,
        )  # fmt: skip
        tile[GDOPS + j], tile[PDOPS + j] = dilutions[GDOP], dilutions[PDOP]

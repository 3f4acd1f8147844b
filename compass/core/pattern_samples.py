"""What users see of one pattern at many inclinations and nodes, at given moments.

A moment is a user's eye, his axes and the phase of the pattern: satellites of equal circular orbits
are at ``r (P cos x + Q sin x)``. Of a claim for always the first moment that breaks it is enough,
and neighbours break it at the same moment: the one that did so last is looked at first.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.clearance import profile_range
from compass.core.dop import dops
from compass.core.jit import kernel
from compass.core.screen import circles

#: Columns of a moment: eye (m), east, north, up, cosine and sine of the phase.
MOMENT = 14

#: Radians below the horizon, and part of a limit above it, that count as kept: a moment that
#: breaks a claim breaks it beyond rounding.
MERCY = 1e-9


class Circles(NamedTuple):
    """Equal circular orbits: nodes, arguments of latitude at phase 0, rad, (n,); `radius`, m."""

    raan: NDArray[np.float64]
    along: NDArray[np.float64]
    radius: float


class Claim(NamedTuple):
    """What is claimed of a moment.

    `azimuths`, `elevations`: profile of the horizon, as `compass.core.clearance.bounds` takes it;
    `fold`: satellites wanted above it; `limits` (5,): of GDOP, PDOP, HDOP, VDOP and TDOP, infinite
    where nothing is wanted; `always`: whether the first broken moment ends a candidate, whose share
    is then 0 and its worst infinite.
    """

    azimuths: NDArray[np.float64]
    elevations: NDArray[np.float64]
    fold: int
    limits: NDArray[np.float64]
    always: bool


@kernel
def sample_pattern(pattern, inclinations, nodes, moments, claim, share, worst):
    """Share of moments that keep a claim, and the largest dilution over its limit.

    Parameters
    ----------
    pattern, claim
        `Circles` and `Claim`.
    inclinations, nodes
        Of the candidates, shape (c,), rad: what is added to all nodes.
    moments
        See `MOMENT`; shape (m, 14).
    share, worst
        Taken in and given back, shape (c,): a candidate of share 0 is not looked at; of a share
        and a worst known already the lesser and the greater are kept.
    """
    n, m = pattern.raan.size, moments.shape[0]
    order = np.arange(m)
    p, q = np.empty((n, 3)), np.empty((n, 3))
    turned = np.empty(n)
    for c in range(inclinations.size):
        if share[c] == 0.0:
            continue
        for s in range(n):
            turned[s] = pattern.raan[s] + nodes[c]
        circles(turned, pattern.along, inclinations[c], p, q)
        kept, most = 0, 0.0
        for k in range(m):
            over = _over(p, q, pattern.radius, moments[order[k]], claim)
            most = max(most, over)
            if over <= 1.0 + MERCY:
                kept += 1
            elif claim.always:
                last = order[k]
                for j in range(k, 0, -1):
                    order[j] = order[j - 1]
                order[0] = last
                kept, most = 0, math.inf
                break
        share[c], worst[c] = min(share[c], kept / m), max(worst[c], most)


@kernel
def _over(p, q, radius, moment, claim):
    """Largest dilution over its limit at a moment; 0 without limits, infinite below the fold."""
    azimuths, elevations, limits = claim.azimuths, claim.elevations, claim.limits
    cx, sx = radius * moment[12], radius * moment[13]
    seen, lowest = 0, math.sin(elevations[0] - MERCY)
    xx = yy = zz = xy = xz = yz = 0.0
    x = y = z = 0.0
    for s in range(p.shape[0]):
        dx = p[s, 0] * cx + q[s, 0] * sx - moment[0]
        dy = p[s, 1] * cx + q[s, 1] * sx - moment[1]
        dz = p[s, 2] * cx + q[s, 2] * sx - moment[2]
        part = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
        east = (moment[3] * dx + moment[4] * dy + moment[5] * dz) * part
        north = (moment[6] * dx + moment[7] * dy + moment[8] * dz) * part
        up = (moment[9] * dx + moment[10] * dy + moment[11] * dz) * part
        if azimuths.size > 1:
            here, _ = profile_range(azimuths, elevations, math.atan2(east, north), 0.0)
            lowest = math.sin(here - MERCY)
        if up < lowest:
            continue
        seen += 1
        x, y, z = x + east, y + north, z + up
        xx, yy, zz = xx + east * east, yy + north * north, zz + up * up
        xy, xz, yz = xy + east * north, xz + east * up, yz + north * up
    if seen < claim.fold:
        return math.inf
    over = 0.0
    if limits.min() < math.inf:
        dilutions = dops(float(seen), xx, yy, zz, xy, xz, yz, x, y, z, 0.0, 0.0, 1.0)
        for k in range(5):
            if limits[k] < math.inf:
                over = max(over, dilutions[k] / limits[k])
    return over

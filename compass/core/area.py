"""Exact areas of the parts of the sphere with a given fold, from the arrangement of caps.

The rim of the part with fold k or more consists of the arcs along which k - 1 other caps reach:
crossing them inwards brings fold k. The area to the left of a closed path of arcs P -> Q about
centres u is the sum of what the great circle from a fixed pole N to a point sweeps:
``A = sum [T(N, P, Q) - T(u, P, Q) + psi (1 - c)]``, with T the signed area of a spherical
triangle, psi the azimuth gone through about u and c the cosine of the circle. T is
``2 atan2(a.(b x c), 1 + a.b + b.c + c.a)``, right modulo 4 pi, and so is the sum.

Caps that coincide share one rim, which bounds one fold more for each: every cap is taken to lie
inside its doubles that come before it.
"""

import math

import numpy as np

from compass.core.fold import arc_events, azimuth_of, circle_point
from compass.core.jit import kernel

FULL = 4.0 * math.pi

#: Caps whose axes and cosines differ by less are one: far above the slack of `arc_events`, which
#: leaves it open where such rims cross, and far below any area of interest.
SAME = 1e-11


@kernel
def triangle(a, b, c):
    """Signed area of the spherical triangle of three unit vectors, modulo 4 pi."""
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
    return 2.0 * math.atan2(volume, 1.0 + ab + bc + ca)


@kernel
def _arc(u, cosine, start, stop):
    """What an arc (azimuths, radians) adds to the area on its left, in pieces below 120 deg."""
    pole = np.array([0.2, 0.3, 0.9])
    pole /= math.sqrt(0.94)
    pieces = int((stop - start) / 2.0) + 1
    total = (stop - start) * (1.0 - cosine)
    before = circle_point(u, cosine, start)
    for k in range(pieces):
        after = circle_point(u, cosine, start + (stop - start) * (k + 1) / pieces)
        total += triangle(pole, before, after) - triangle(u, before, after)
        before = after
    return total


@kernel
def _united(caps, cosines):
    """Caps with doubles made equal, and how many doubles come before each."""
    caps, cosines = caps.copy(), cosines.copy()
    doubles = np.zeros(cosines.size, dtype=np.int64)
    for i in range(cosines.size):
        for j in range(i):
            apart = abs(cosines[i] - cosines[j])
            for k in range(3):
                apart = max(apart, abs(caps[i, k] - caps[j, k]))
            if apart < SAME:
                caps[i], cosines[i] = caps[j], cosines[j]
                doubles[i] += 1
    return caps, cosines, doubles


@kernel
def areas_by_fold(caps, cosines, least, greatest):
    """Area, steradians, where the fold is k or more, for k = 0 ... n.

    Parameters
    ----------
    caps, cosines
        As in `extreme_fold`.
    least, greatest
        Extremes of the fold: they tell none from all.

    Returns
    -------
    areas
        Shape (n + 1,).
    """
    n = cosines.size
    nothing, floors = np.empty((0, 3)), np.empty(0)
    place, step = np.empty(2 * n), np.empty(2 * n, dtype=np.int64)
    areas = np.zeros(n + 1)
    caps, cosines, doubles = _united(caps, cosines)
    for i in range(n):
        if cosines[i] >= 1.0 or cosines[i] <= -1.0:
            continue
        depth, events = arc_events(
            caps[i], cosines[i], i, caps, cosines, nothing, floors, True, True, place, step
        )
        depth += doubles[i]
        if events == 0:
            areas[depth + 1] += _arc(caps[i], cosines[i], -math.pi, math.pi)
            continue
        first = azimuth_of(place[0])
        last = azimuth_of(place[events - 1])
        areas[depth + 1] += _arc(caps[i], cosines[i], last - 2.0 * math.pi, first)
        for k in range(events - 1):
            depth += step[k]
            here, following = azimuth_of(place[k]), azimuth_of(place[k + 1])
            areas[depth + 1] += _arc(caps[i], cosines[i], here, following)
    for k in range(n + 1):
        if k <= least:
            areas[k] = FULL
        elif k > greatest:
            areas[k] = 0.0
        else:
            areas[k] %= FULL
            if areas[k] > FULL - 1e-9:  # a sliver whose area rounds below zero
                areas[k] = 0.0
    return areas

"""Exact areas of the parts of the sphere with a given fold, from the arrangement of caps.

The rim of the part with fold k or more consists of the arcs along which k - 1 other caps reach:
crossing them inwards brings fold k. The area to the left of a closed path of arcs P -> Q about
centres u is the sum of what the great circle from a fixed pole N to a point sweeps:
``A = sum [T(N, P, Q) - T(u, P, Q) + psi (1 - c)]``, with T the signed area of a spherical
triangle, psi the azimuth gone through about u and c the cosine of the circle. T of unit vectors
a, b, c is twice the angle of ``1 + a.b + b.c + c.a + i a.(b x c)``, right modulo 4 pi: the
triangles of a level are added by multiplying these numbers, and one arc tangent ends the sum.
About the antipode of the centre the same arc adds ``T(N, P, Q) - T(-u, P, Q) - psi (1 + c)``.

So is A known modulo 4 pi, the whole sphere. Which levels that leaves out is told by the areas of
all levels together, ``sum over k >= 1 of A_k = sum of the caps' areas``: as many whole spheres as
are missing there belong to the lowest levels, one each.

Caps that coincide share one rim, which bounds one fold more for each: every cap is taken to lie
inside its doubles that come before it.
"""

import math

import numpy as np

from compass.core.fold import Sides, arc_events, azimuth_of, circle_frame
from compass.core.jit import kernel

FULL = 4.0 * math.pi

#: Caps whose axes and cosines differ by less are one: far above the slack of `arc_events`, which
#: leaves it open where such rims cross, and far below any area of interest.
SAME = 1e-11


#: Areas from minus this to nothing are rounded from nothing, steradians: levels are found modulo
#: `FULL`, and it says which of the two ends of that a small one belongs to.
NEGATIVE = 1e-9

#: Areas below this are no more than rounding, steradians.
SLIVER = 1e-12


@kernel
def corner(a, b, c):
    """Complex number whose angle is half the signed area of the triangle of three unit vectors."""
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
    return complex(1.0 + ab + bc + ca, volume)


@kernel
def _rim_point(u, a, b, cosine, azimuth, p):
    """Set `p` to the point of a circle at an azimuth, radians, in its frame ``a, b``."""
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    x, y = sine * math.cos(azimuth), sine * math.sin(azimuth)
    for k in range(3):
        p[k] = cosine * u[k] + x * a[k] + y * b[k]


@kernel
def _add_arc(u, frame, cosine, start, stop, level, swept, turned, before, after):
    """Add an arc, between azimuths in radians, to a level; `before` is its first point.

    Its triangles go to ``turned[level]`` in pieces below 120 deg, the rest to ``swept[level]``.
    `after` becomes its last point.
    """
    pole = (0.2 / math.sqrt(0.94), 0.3 / math.sqrt(0.94), 0.9 / math.sqrt(0.94))
    a, b = frame
    # about the nearer of the circle's two centres, where the triangles are small
    side = 1.0 if cosine >= 0.0 else -1.0
    centre = (side * u[0], side * u[1], side * u[2])
    swept[level] += (stop - start) * (side - cosine)
    pieces = int((stop - start) / 2.0) + 1
    for k in range(pieces):
        _rim_point(u, a, b, cosine, start + (stop - start) * (k + 1) / pieces, after)
        product = (
            turned[level] * corner(pole, before, after) * corner(centre, before, after).conjugate()
        )
        size = abs(product.real) + abs(product.imag)  # only the angle matters, not the length
        if size > 0.0:
            turned[level] = product / size
        before[:] = after


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
def areas_by_fold(caps, cosines):
    """Area, steradians, where the fold is k or more, for k = 0 ... n.

    Parameters
    ----------
    caps, cosines
        As in `extreme_fold`.

    Returns
    -------
    areas
        Shape (n + 1,).
    """
    n = cosines.size
    nothing = Sides(np.empty((0, 3)), np.empty(0))
    place, step = np.empty(2 * n), np.empty(2 * n, dtype=np.int64)
    swept, turned = np.zeros(n + 1), np.ones(n + 1, dtype=np.complex128)
    before, after = np.empty(3), np.empty(3)
    caps, cosines, doubles = _united(caps, cosines)
    for i in range(n):
        c = cosines[i]
        if c >= 1.0 or c <= -1.0:
            continue
        u, frame = caps[i], circle_frame(caps[i])
        depth, events = arc_events(u, c, i, caps, cosines, nothing, True, True, place, step)
        depth += doubles[i]
        last = azimuth_of(place[events - 1]) - 2.0 * math.pi if events else -math.pi
        first = last
        _rim_point(u, frame[0], frame[1], c, first, before)
        for k in range(events):
            here = azimuth_of(place[k])
            _add_arc(u, frame, c, last, here, depth + 1, swept, turned, before, after)
            depth += step[k]
            last = here
        if events == 0:
            _add_arc(u, frame, c, first, math.pi, depth + 1, swept, turned, before, after)
    areas = np.zeros(n + 1)
    missing = 0.0
    for k in range(1, n + 1):
        area = (swept[k] + 2.0 * math.atan2(turned[k].imag, turned[k].real)) % FULL
        if area > FULL - NEGATIVE:
            area -= FULL
        areas[k] = 0.0 if abs(area) < SLIVER else area
        missing += 0.5 * FULL * (1.0 - min(1.0, max(-1.0, cosines[k - 1]))) - areas[k]
    for k in range(round(missing / FULL) + 1):
        areas[k] += FULL
    return areas


@kernel
def areas_at_moments(caps, cosines):
    """As `areas_by_fold`, at each of many moments.

    Parameters
    ----------
    caps, cosines
        Unit vectors, shape (moment, n, 3), and cosines of the radii, shape (moment, n).

    Returns
    -------
    areas
        Shape (moment, n + 1).
    """
    areas = np.empty((cosines.shape[0], cosines.shape[1] + 1))
    for m in range(cosines.shape[0]):
        areas[m] = areas_by_fold(caps[m], cosines[m])
    return areas

"""Exact extremes of the fold over the sphere, or over a part of it, from the arrangement of caps.

A cap is ``{p : u.p >= c}``. Fold is constant on the cells that the cap circles cut the sphere
into, and every cell has an arc of some circle on its rim: just outside circle i the fold is the
number of *other* caps over that arc, just inside it is one more. So the minimum over the sphere
is the least depth of the other caps along the circles, the maximum the greatest plus one. Along
one circle every other cap is a single interval of azimuth, so a sort and a sweep suffice:
``O(N^2 log N)`` in all, and the ends of the intervals are the vertices of the arrangement.

Rounding. The products u_j.p on circle i carry an error below 30 unit roundoffs: 3 for the
product that gives g, 9 each for those with the two frame vectors (3, and 6 in the vectors), and
the scaling and summing of the three terms. `PRODUCT_SLACK`, twice that, moves every cap to its
safe side; what remains (one inverse cosine, one arc tangent, one sum) is a few units in the last
place of an angle, under `ANGLE_SLACK`. With ``certain`` caps shrink by both, so the depth is never
above the true one; without, they grow, and it is never below. Where the two differ, circles meet
in a point to within rounding, and the truth lies between.
"""

import math

import numpy as np

from compass.core.jit import kernel

PRODUCT_SLACK = 32 * 2.220446049250313e-16
ANGLE_SLACK = 1e-14

#: Cosines that stand for a cap with nothing in it and for one with everything in it.
NOTHING, EVERYTHING = 2.0, -2.0

#: Weight of a place outside the region, past any fold.
OUTSIDE = 1_000_000


@kernel
def cap_cosine(radius, growth):
    """Cosine of the cap of `radius` grown (or shrunk, if negative) by an angle, radians."""
    grown = radius + growth
    if grown <= 0.0:
        return NOTHING
    if grown >= math.pi:
        return EVERYTHING
    return math.cos(grown)


@kernel
def circle_frame(u):
    """Two unit vectors that make a right-handed frame with the unit vector `u`."""
    x, y, z = abs(u[0]), abs(u[1]), abs(u[2])
    e = np.zeros(3)
    e[0 if x <= y and x <= z else (1 if y <= z else 2)] = 1.0
    a = np.empty(3)
    a[0] = e[1] * u[2] - e[2] * u[1]
    a[1] = e[2] * u[0] - e[0] * u[2]
    a[2] = e[0] * u[1] - e[1] * u[0]
    a /= math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    b = np.empty(3)
    b[0] = u[1] * a[2] - u[2] * a[1]
    b[1] = u[2] * a[0] - u[0] * a[2]
    b[2] = u[0] * a[1] - u[1] * a[0]
    return a, b


@kernel
def circle_point(u, cosine, azimuth):
    """Point at `azimuth` (radians, in the frame of `circle_frame`) on the circle ``u.p = cosine``."""
    a, b = circle_frame(u)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    return cosine * u + sine * (math.cos(azimuth) * a + math.sin(azimuth) * b)


@kernel
def _interval(u, a, b, cosine, sine, other, threshold, certain):
    """Azimuths of a circle inside another cap: kind (0 none, 1 some, 2 all), middle, half width."""
    g = u[0] * other[0] + u[1] * other[1] + u[2] * other[2]
    slack = PRODUCT_SLACK if certain else -PRODUCT_SLACK
    needed = threshold - cosine * g + slack
    pa = other[0] * a[0] + other[1] * a[1] + other[2] * a[2]
    pb = other[0] * b[0] + other[1] * b[1] + other[2] * b[2]
    reach = sine * math.sqrt(pa * pa + pb * pb)
    if needed > reach:
        return 0, 0.0, 0.0
    if needed <= -reach:
        return 2, 0.0, math.pi
    half = math.acos(needed / reach) + (-ANGLE_SLACK if certain else ANGLE_SLACK)
    if half <= 0.0:
        return 0, 0.0, 0.0
    if half >= math.pi:
        return 2, 0.0, math.pi
    return 1, math.atan2(pb, pa), half


@kernel
def _sweep(u, cosine, skip, caps, cosines, region, floors, low, certain, place, step):
    """Extreme depth of the caps but `skip` along a circle inside the region: depth, azimuth, width.

    `low` picks the least depth, else the greatest; `certain` as in `extreme_fold`. Width is that
    of the widest such arc; the depth is past `OUTSIDE` if no arc is inside the region.
    """
    sign = 1 if low else -1
    a, b = circle_frame(u)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    base, events = 0, 0
    n, m = cosines.size, floors.size
    for j in range(n + m):
        if j < n:
            if j == skip or cosines[j] >= 1.0:
                continue
            if cosines[j] <= -1.0:
                base += sign
                continue
            weight = sign
            kind, middle, half = _interval(
                u, a, b, cosine, sine, caps[j], cosines[j], certain if low else not certain
            )
        else:
            # a place outside a part of the region's rim weighs more than any fold
            base += OUTSIDE
            weight = -OUTSIDE
            if j - n == -skip - 1:
                base -= OUTSIDE
                continue
            kind, middle, half = _interval(
                u, a, b, cosine, sine, region[j - n], floors[j - n], not certain
            )
        if kind == 0:
            continue
        if kind == 2:
            base += weight
            continue
        start, stop = middle - half, middle + half
        if start <= -math.pi:
            start += 2.0 * math.pi
        if stop > math.pi:
            stop -= 2.0 * math.pi
        if start > stop:
            base += weight
        place[events], step[events] = start, weight
        place[events + 1], step[events + 1] = stop, -weight
        events += 2
    if events == 0:
        return base * sign, 0.0, 2.0 * math.pi
    order = np.argsort(place[:events])
    # the arc across azimuth pi, before the first event and after the last
    best = base
    before = place[order[events - 1]] - 2.0 * math.pi
    width = place[order[0]] - before
    azimuth = before + 0.5 * width
    depth = base
    for k in range(events - 1):
        depth += step[order[k]]
        if depth <= best:
            here, following = place[order[k]], place[order[k + 1]]
            if depth < best or following - here > width:
                best, width, azimuth = depth, following - here, 0.5 * (here + following)
    return best * sign, azimuth, width


@kernel
def extreme_fold(caps, cosines, region, floors, low, certain, stop):
    """Least (`low`) or greatest fold over the sphere or a region of it.

    Parameters
    ----------
    caps, cosines
        Unit vectors, shape (n, 3), and cosines of the caps, shape (n,); a cosine of 1 or more is
        an empty cap, of -1 or less a full one.
    region, floors
        The region is where ``region[k].p >= floors[k]`` for every k; shapes (m, 3) and (m,).
        With m = 0 it is the whole sphere.
    low, certain
        Which extreme, and to which side rounding errs: a ``certain`` result bounds the fold of
        every point (never above the least fold, never below the greatest); the other one is
        taken on by some cell (never below the least, never above the greatest).
    stop
        Return as soon as a fold below `stop` (above it, for the greatest) turns up.

    Returns
    -------
    fold, curve, azimuth, width
        The extreme; the circle on which it was found (cap index, or ``-1 - k`` for the rim of
        region part k); azimuth of the middle of the widest such arc and its width, radians.
        Curve ``n`` stands for no curve at all: no circle is there.
    """
    n, m = cosines.size, floors.size
    place = np.empty(2 * (n + m))
    step = np.empty(2 * (n + m), dtype=np.int64)
    fold, curve, azimuth, width = 0, n, 0.0, 0.0
    found = False
    for i in range(-m, n):
        if i >= 0:
            if cosines[i] >= 1.0 or cosines[i] <= -1.0:
                continue
            centre, cosine = caps[i], cosines[i]
        else:
            centre, cosine = region[-1 - i], floors[-1 - i]
        depth, at, wide = _sweep(
            centre, cosine, i, caps, cosines, region, floors, low, certain, place, step
        )
        if abs(depth) >= OUTSIDE // 2:
            continue
        if not low and i >= 0:
            depth += 1
        better = depth < fold if low else depth > fold
        if not found or better or (depth == fold and wide > width):
            found, fold, curve, azimuth, width = True, depth, i, at, wide
            if (low and fold < stop) or (not low and fold > stop):
                return fold, curve, azimuth, width
    if not found:
        for j in range(n):
            if cosines[j] <= -1.0:
                fold += 1
    return fold, curve, azimuth, width


@kernel
def cell_point(curve, azimuth, width, caps, cosines, region, floors, low):
    """Point inside the cell beside an arc that `extreme_fold` found, and the fold there.

    The point steps off the arc (outwards for the least fold, inwards for the greatest, into the
    region from its rim) by half the arc's width, then half of that and so on, and the most
    extreme fold met is kept. Caps that pass within `PRODUCT_SLACK` of the point count against
    the extreme, so the fold is never below that of the point for ``low``, never above for not.
    """
    n, m = cosines.size, floors.size
    best, found = 0, False
    chosen = np.zeros(3)
    if curve == n:
        chosen[2] = 1.0
        for j in range(n):
            if cosines[j] <= -1.0:
                best += 1
        return chosen, best, m == 0
    if curve >= 0:
        centre, cosine, way = caps[curve], cosines[curve], 1.0 if low else -1.0
    else:
        centre, cosine, way = region[-1 - curve], floors[-1 - curve], -1.0
    radius = math.acos(cosine)
    slack = PRODUCT_SLACK if low else -PRODUCT_SLACK
    offset = 0.5 * min(width, 1.0) * math.sin(radius)
    for _ in range(30):
        p = circle_point(centre, math.cos(radius + way * offset), azimuth)
        offset *= 0.5
        outside = False
        for k in range(m):
            dot = region[k, 0] * p[0] + region[k, 1] * p[1] + region[k, 2] * p[2]
            outside = outside or dot < floors[k] + PRODUCT_SLACK
        if outside:
            continue
        fold = 0
        for j in range(n):
            dot = caps[j, 0] * p[0] + caps[j, 1] * p[1] + caps[j, 2] * p[2]
            if dot >= cosines[j] - slack:
                fold += 1
        if not found or (low and fold < best) or (not low and fold > best):
            found, best, chosen = True, fold, p
    return chosen, best, found

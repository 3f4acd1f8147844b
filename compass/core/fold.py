"""Exact extremes of the fold over the sphere, or over a part of it, from the arrangement of caps.

A cap is ``{p : u.p >= c}``. Fold is constant on the cells that the cap circles cut the sphere
into, and every cell has an arc of some circle on its rim: just outside circle i the fold is the
number of *other* caps over that arc, just inside it is one more. So the minimum over the sphere
is the least depth of the other caps along the circles, the maximum the greatest plus one. Along
one circle every other cap is a single interval of azimuth, so a sort and a sweep suffice:
``O(N^2 log N)`` in all, and the ends of the intervals are the vertices of the arrangement.

An azimuth's place along the circle is kept as its *diamond angle*, ``y/(|x| + |y|)`` continued
to (-2, 2]: it rises with the angle by 1/2 to 1 a radian, and needs no trigonometry.

Rounding. The products u_j.p on circle i carry an error below 30 unit roundoffs: 3 for the
product that gives g, 9 each for those with the two frame vectors (3, and 6 in the vectors), and
the scaling and summing of the three terms. The quotient that gives the ends of an interval adds
less than 10 in the same measure, the cosine of a cap from its radius some 5. `PRODUCT_SLACK`,
64 of them, moves every cap to its safe side first; what remains (a root of a product, a
rotation, one quotient) is a few roundoffs of angle, under `ANGLE_SLACK`. With ``certain`` caps
shrink by both, so the depth is never above the true one; without, they grow, and it is never
below. Where the two differ, circles meet in a point to within rounding, and the truth lies
between.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import kernel
from compass.core.sort import sort_together

PRODUCT_SLACK = 32 * 2.220446049250313e-16
ANGLE_SLACK = 1e-14

#: Cosines that stand for a cap with nothing in it and for one with everything in it.
NOTHING, EVERYTHING = 2.0, -2.0

#: Weight of a place outside the region, past any fold.
OUTSIDE = 1_000_000

#: No circle is thin: of `thin_circle`.
WELL = 1_000_000


class Sides(NamedTuple):
    """Sides of a region, whose places p have ``normals[k].p >= floors[k]`` for every k.

    Shapes (m, 3) and (m,); with m = 0 it is the whole sphere.
    """

    normals: NDArray[np.float64]
    floors: NDArray[np.float64]


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
    """Two unit vectors, as tuples, that make a right-handed frame with the unit vector `u`."""
    x, y, z = u[0], u[1], u[2]
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        a = (0.0, -z, y)
    elif abs(y) <= abs(z):
        a = (z, 0.0, -x)
    else:
        a = (-y, x, 0.0)
    norm = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    a = (a[0] / norm, a[1] / norm, a[2] / norm)
    return a, (y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0])


@kernel
def circle_point(u, cosine, azimuth):
    """Point of the circle ``u.p = cosine`` at an azimuth, radians, in its `circle_frame`."""
    a, b = circle_frame(u)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    c, s = sine * math.cos(azimuth), sine * math.sin(azimuth)
    p = np.empty(3)
    for k in range(3):
        p[k] = cosine * u[k] + c * a[k] + s * b[k]
    return p


@kernel
def diamond(x, y):
    """Diamond angle, in (-2, 2], of a plane vector that is not zero."""
    ratio = y / (abs(x) + abs(y))
    if x >= 0.0:
        return ratio
    return 2.0 - ratio if y >= 0.0 else -2.0 - ratio


@kernel
def azimuth_of(place):
    """Angle, radians, of a diamond angle in [-2, 2]."""
    if place > 1.0:
        return math.atan2(2.0 - place, 1.0 - place)
    if place < -1.0:
        return math.atan2(-2.0 - place, 1.0 + place)
    return math.atan2(place, 1.0 - abs(place))


@kernel
def arc_events(u, cosine, skip, caps, cosines, sides, low, certain, place, step):
    """Where along a circle caps but `skip`, and parts of the region, are entered and left.

    Fills `place` with diamond angles and `step` with the change of depth there, sorted, and
    returns the depth just before the first and their number. The depth is the fold, negative
    unless `low`, plus `OUTSIDE` for every part of the region that does not hold.
    """
    sign = 1 if low else -1
    a, b = circle_frame(u)
    u0, u1, u2 = u
    a0, a1, a2 = a
    b0, b1, b2 = b
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    base, events = 0, 0
    region, floors = sides.normals, sides.floors
    n, m = cosines.size, floors.size
    for j in range(n + m):
        if j < n:
            threshold, shrink, weight = cosines[j], certain if low else not certain, sign
            if j == skip or threshold >= 1.0:
                continue
            if threshold <= -1.0:
                base += sign
                continue
            o0, o1, o2 = caps[j, 0], caps[j, 1], caps[j, 2]
        else:
            # a place outside a part of the region's rim weighs more than any fold
            if j - n == -skip - 1:
                continue
            base += OUTSIDE
            threshold, shrink, weight = floors[j - n], not certain, -OUTSIDE
            o0, o1, o2 = region[j - n, 0], region[j - n, 1], region[j - n, 2]
        needed = threshold - cosine * (u0 * o0 + u1 * o1 + u2 * o2)
        needed += PRODUCT_SLACK if shrink else -PRODUCT_SLACK
        pa = o0 * a0 + o1 * a1 + o2 * a2
        pb = o0 * b0 + o1 * b1 + o2 * b2
        reach = sine * math.sqrt(pa * pa + pb * pb)
        if needed > reach:
            continue
        if needed <= -reach:
            base += weight
            continue
        # the ends are the middle (pa, pb), turned either way by the angle of cosine x, sine y
        x = needed / reach
        y = math.sqrt(max(0.0, (1.0 - x) * (1.0 + x)))
        if y <= 2.0 * ANGLE_SLACK:
            if x > 0.0 and shrink:
                continue
            if x < 0.0 and not shrink:
                base += weight
                continue
        slack = ANGLE_SLACK if shrink else -ANGLE_SLACK
        start = diamond(x * pa + y * pb, x * pb - y * pa) + slack
        stop = diamond(x * pa - y * pb, x * pb + y * pa) - slack
        if start > 2.0:
            start -= 4.0
        elif start <= -2.0:
            start += 4.0
        if stop > 2.0:
            stop -= 4.0
        elif stop <= -2.0:
            stop += 4.0
        if start > stop:
            base += weight
        place[events], step[events] = start, weight
        place[events + 1], step[events + 1] = stop, -weight
        events += 2
    sort_together(place, step, events)
    return base, events


@kernel
def _sweep(u, cosine, skip, caps, cosines, sides, low, certain, place, step):
    """Extreme depth of the caps but `skip` along a circle inside the region: depth, place, width.

    `low` picks the least depth, else the greatest; `certain` as in `extreme_fold`. Place and
    width are diamond angles of the widest such arc; the depth is past `OUTSIDE` if no arc is
    inside the region.
    """
    base, events = arc_events(u, cosine, skip, caps, cosines, sides, low, certain, place, step)
    sign = 1 if low else -1
    if events == 0:
        return base * sign, 0.0, 4.0
    # first the arc across place 2, before the first event and after the last
    best = base
    width = place[0] + 4.0 - place[events - 1]
    middle = place[events - 1] + 0.5 * width
    depth = base
    for k in range(events - 1):
        depth += step[k]
        if depth <= best:
            wide = place[k + 1] - place[k]
            if depth < best or wide > width:
                best, width, middle = depth, wide, place[k] + 0.5 * wide
    return best * sign, middle - 4.0 if middle > 2.0 else middle, width


@kernel
def extreme_fold(caps, cosines, sides, low, certain, stop):
    """Least (`low`) or greatest fold over the sphere or a region of it.

    Parameters
    ----------
    caps, cosines
        Unit vectors, shape (n, 3), and cosines of the caps, shape (n,); a cosine of 1 or more is
        an empty cap, of -1 or less a full one.
    sides
        `Sides` of the region.
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
        region part k); azimuth of the middle of the widest such arc, radians, and its width, within
        a factor of two in radians.
        Curve ``n`` stands for no curve at all: no circle is there.
    """
    region, floors = sides.normals, sides.floors
    n, m = cosines.size, floors.size
    place = np.empty(2 * (n + m))
    step = np.empty(2 * (n + m), dtype=np.int64)
    fold, curve, middle, width = 0, n, 0.0, 0.0
    found = False
    for i in range(-m, n):
        if i >= 0:
            if cosines[i] >= 1.0 or cosines[i] <= -1.0:
                continue
            centre, cosine = caps[i], cosines[i]
        else:
            centre, cosine = region[-1 - i], floors[-1 - i]
        depth, at, wide = _sweep(centre, cosine, i, caps, cosines, sides, low, certain, place, step)
        if abs(depth) >= OUTSIDE // 2:
            continue
        if not low and i >= 0:
            depth += 1
        better = depth < fold if low else depth > fold
        if not found or better or (depth == fold and wide > width):
            found, fold, curve, middle, width = True, depth, i, at, wide
            if (low and fold < stop) or (not low and fold > stop):
                break
    if not found:
        for j in range(n):
            if cosines[j] <= -1.0:
                fold += 1
    return fold, curve, azimuth_of(middle), width


@kernel
def thin_beside(i, caps, cosines, sides, k):
    """Whether fewer than `k` caps may be beside circle i: 1, 0, or -1 where it is not there.

    Parameters as of `extreme_fold`; i as its curve.
    """
    region, floors = sides.normals, sides.floors
    n, m = cosines.size, floors.size
    if i < -m or i >= n or (i >= 0 and (cosines[i] >= 1.0 or cosines[i] <= -1.0)):
        return -1
    place = np.empty(2 * (n + m))
    step = np.empty(2 * (n + m), dtype=np.int64)
    if i >= 0:
        centre, cosine = caps[i], cosines[i]
    else:
        centre, cosine = region[-1 - i], floors[-1 - i]
    depth = _sweep(centre, cosine, i, caps, cosines, sides, True, True, place, step)[0]
    if abs(depth) >= OUTSIDE // 2:
        return -1
    return 1 if depth < k else 0


@kernel
def thin_circle(caps, cosines, sides, k, first):
    """Circle beside which fewer than `k` caps may be; `WELL` where k or more surely are everywhere.

    What `extreme_fold` says of the least fold, certain, without how low it is. A region that has
    no place is well covered.

    Parameters
    ----------
    caps, cosines, sides
        As in `extreme_fold`.
    k
        Fold.
    first
        Circle to look at before the others: the one that was thin a moment before, say.

    Returns
    -------
    int
        As the curve of `extreme_fold`, or `WELL`.
    """
    n, m = cosines.size, sides.floors.size
    if thin_beside(first, caps, cosines, sides, k) == 1:
        return first
    met = m > 0
    for i in range(-m, n):
        thin = thin_beside(i, caps, cosines, sides, k)
        if thin == 1:
            return i
        met = met or thin == 0
    full = 0
    for j in range(n):
        if cosines[j] <= -1.0:
            full += 1
    return WELL if met or full >= k else n


@kernel
def cell_point(curve, azimuth, width, caps, cosines, sides, low):
    """Point inside the cell beside an arc that `extreme_fold` found, and the fold there.

    The point steps off the arc (outwards for the least fold, inwards for the greatest, into the
    region from its rim) by half the arc's width, then half of that and so on, and the most
    extreme fold met is kept. Caps that pass within `PRODUCT_SLACK` of the point count against
    the extreme, so the fold is never below that of the point for ``low``, never above for not.
    """
    region, floors = sides.normals, sides.floors
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

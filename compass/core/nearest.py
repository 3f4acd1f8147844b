"""The smallest common cap radius for k-fold coverage, at a moment and over an interval.

The fold of caps of radius lambda is k or more everywhere exactly if no point is farther than
lambda from its k-th nearest satellite. So the smallest radius is the greatest k-th nearest
distance over the sphere. Its local maxima are points equally far from three satellites, far
midpoints of two, or antipodes of one, where fewer than k satellites are nearer.
"""

import math

import numpy as np

from compass.core.certificate import Frame, caps_at
from compass.core.fold import circle_frame
from compass.core.jit import kernel
from compass.core.sort import keep_greatest, sort_together

#: Satellites whose distances differ by less than this count as equally far, cosine.
EQUAL = 1e-13

#: Margin for rounding of the cosine of a radius that is not exceeded.
SLACK = 1e-9


#: Up to so many satellites looking at all of them is quicker than finding out who is near.
FEW = 40

#: Points of a coarse grid for each satellite.
POINTS = 4


@kernel
def _nearer_than(u, among, p, sign, cosine, k, i, j, m):
    """Whether fewer than `k` satellites but i, j and m are nearer to ``sign p`` than `cosine`.

    Only those `among` others are looked at: all that can be nearer.
    """
    count = 0
    for s in among:
        if s in (i, j, m):
            continue
        if sign * (u[s, 0] * p[0] + u[s, 1] * p[1] + u[s, 2] * p[2]) > cosine + EQUAL:
            count += 1
            if count >= k:
                return False
    return True


@kernel
def _coarse_bound(u, k):
    """Radius that the k-th nearest distance does not exceed anywhere, from a coarse grid, radians.

    Cells are at most h high and wide, so that no point is farther than ``h/sqrt(2)`` from the
    centre of one, and distances differ by no more than that.
    """
    n = u.shape[0]
    rows = int(math.sqrt(POINTS * n * math.pi / 4.0)) + 1
    height = math.pi / rows
    nearest = np.empty(k)
    farthest = 1.0
    for row in range(rows):
        latitude = (row + 0.5) * height - 0.5 * math.pi
        low = max(abs(latitude) - 0.5 * height, 0.0)
        columns = max(1, int(math.ceil(2.0 * math.pi * math.cos(low) / height)))
        z, across = math.sin(latitude), math.cos(latitude)
        for column in range(columns):
            longitude = 2.0 * math.pi * column / columns
            x, y = across * math.cos(longitude), across * math.sin(longitude)
            nearest[:] = -2.0  # cosines, the greatest first
            for s in range(n):
                keep_greatest(nearest, u[s, 0] * x + u[s, 1] * y + u[s, 2] * z)
            farthest = min(farthest, nearest[k - 1])
    return min(math.acos(max(farthest, -1.0)) + 0.7072 * height, math.pi)


@kernel
def _from_south(satellites):
    """The satellites, shape (n, 3), the southernmost first."""
    n = satellites.shape[0]
    height, order, u = np.empty(n), np.arange(n), np.empty((n, 3))
    for s in range(n):
        height[s] = satellites[s, 2]
    sort_together(height, order, n)
    for s in range(n):
        for axis in range(3):
            u[s, axis] = satellites[order[s], axis]
    return u


@kernel
def covering_radius(satellites, k, least, most, p_best):
    """Greatest k-th nearest distance, radians: the smallest radius of caps that cover k-fold.

    Three satellites that are equally far from a point, no farther than is possible, are no
    farther from one another than twice that: of many satellites few triples are looked at.

    Parameters
    ----------
    satellites
        Unit vectors to them, shape (n, 3).
    k
        Fold, at least 1.
    least
        Radius, radians, at or below which nothing needs to be told apart; 0 for all.
    most
        Radius, radians, that is known not to be exceeded; pi if nothing is known. Points farther
        than that from three satellites have too many nearer ones, and are not looked at.
    p_best
        Takes the point where it is reached, shape (3,).

    Returns
    -------
    radius
        Radians; `least` if it is not above that, infinity if there are fewer than `k` satellites.
    """
    n = satellites.shape[0]
    if n < k:
        return math.inf
    # from south to north, so that who is near is near in the list
    u = _from_south(satellites)
    if n > FEW and most > 0.25 * math.pi:
        most = min(most, _coarse_bound(u, k))
    best = math.cos(min(max(least, 0.0), math.pi))
    squared = best * abs(best) + EQUAL
    lowest = math.cos(min(most, math.pi)) - SLACK
    low_squared = lowest * abs(lowest)
    reach = min(2.0 * most + 1e-4, math.pi)
    near_cosine, near_height = math.cos(reach) - 1e-12, 2.0 * math.sin(0.5 * reach)
    any_corner = False
    p = np.empty(3)
    near = np.empty(n, np.int64)
    first = 0
    for i in range(n):
        while u[i, 2] - u[first, 2] > near_height:
            first += 1
        count, before = 0, 0  # who is near, and how many of them come before i
        for s in range(first, n):
            if u[s, 2] - u[i, 2] > near_height:
                break
            cosine = u[s, 0] * u[i, 0] + u[s, 1] * u[i, 1] + u[s, 2] * u[i, 2]
            if cosine >= near_cosine or reach == math.pi:
                near[count] = s
                count += 1
                if s <= i:
                    before += 1
        among = near[:count]
        if lowest <= -1.0 < best and _nearer_than(u, among, u[i], -1.0, -1.0, k, i, i, i):
            best, squared, any_corner = -1.0, EQUAL - 1.0, True
            p_best[:] = -u[i]
        for second in range(before, count):
            j = near[second]
            ax, ay, az = u[j, 0] - u[i, 0], u[j, 1] - u[i, 1], u[j, 2] - u[i, 2]
            p[0], p[1], p[2] = u[j, 0] + u[i, 0], u[j, 1] + u[i, 1], u[j, 2] + u[i, 2]
            norm = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
            if norm < 1e-12:  # antipodes: any point of the great circle between them
                p[0], p[1], p[2] = circle_frame(u[i])[0]
            else:
                p /= norm
            far = -0.5 * norm
            if lowest <= far < best and _nearer_than(u, among, p, -1.0, far, k, i, j, j):
                best, squared, any_corner = far, EQUAL - far * far, True
                p_best[:] = -p
            for third in range(second + 1, count):
                m = near[third]
                bx, by, bz = u[m, 0] - u[i, 0], u[m, 1] - u[i, 1], u[m, 2] - u[i, 2]
                x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
                # compare cosines by their squares with signs: most triples end here
                square = x * x + y * y + z * z
                height = x * u[i, 0] + y * u[i, 1] + z * u[i, 2]
                signed, high, low = height * abs(height), squared * square, low_squared * square
                if not (low <= signed < high or low <= -signed < high):
                    continue
                if square < 1e-24:
                    continue
                norm = math.sqrt(square)
                p[0], p[1], p[2] = x / norm, y / norm, z / norm
                cosine = height / norm
                for sign in (1.0, -1.0):
                    if lowest <= sign * cosine < best and _nearer_than(
                        u, among, p, sign, sign * cosine, k, i, j, m
                    ):
                        best, any_corner = sign * cosine, True
                        squared = best * abs(best) + EQUAL
                        p_best[:] = sign * p
    if not any_corner:
        return least
    return math.acos(min(1.0, max(-1.0, best)))


@kernel
def worst_radius(orbits, spin, k, start, stop, first, known, tolerance, limit, max_nodes):
    """Greatest `covering_radius` over [start, stop], bracketed to `tolerance`.

    The covering radius changes no faster than the satellites move in a frame that turns with
    `spin`, so half an interval times that rate, added to its value at mid-time, bounds it; the
    intervals are bisected until the bounds exceed the best value by no more than `tolerance`.

    Parameters
    ----------
    orbits
        `compass.core.certificate.Orbits`.
    spin
        Angular velocity of a frame, shape (3,), rad/s.
    k, start, stop
        Fold; seconds.
    first
        Moment in [start, stop] that is looked at first: the worst one of a like constellation,
        if known, spares most of the others.
    known
        A radius that is reached at another time: only greater ones matter; -1 if there is none.
    tolerance, limit
        Radians; the search ends early, with what it has, once the radius exceeds `limit`.
    max_nodes
        Moments to look at before giving up; the bracket is then wider than `tolerance`.

    Returns
    -------
    least, most, time, point, nodes
        The greatest radius is in [least, most]; `least` is reached at `time` and `point`. After
        an early end `most` is infinite.
    """
    parts = 8
    stack = np.empty((parts + 128, 3))  # intervals, and the radius that is not exceeded in each
    point, candidate = np.zeros(3), np.zeros(3)
    least, most, when = known, 0.0, first
    if orbits.elements.shape[1] < k:
        return math.inf, math.inf, first, point, 0
    sphere = 1e-9 * orbits.elements[0].min()  # caps do not matter here, only directions
    frame = Frame(spin, math.nan, 0.0)
    ceiling = math.pi
    nodes = 0
    for time in (first, start, stop):
        if nodes > 0 and time == first:
            continue
        u, _, stray = caps_at(orbits, frame, sphere, 0.0, time, stop - start)
        value = covering_radius(u, k, least, ceiling, candidate)
        ceiling = min(ceiling, value + stray.max())
        if value > least:
            least, when = value, time
            point[:] = candidate
        nodes += 1
        if least > limit:
            return least, math.inf, when, point, nodes
    depth = 0
    if stop > start:
        for part in range(parts):
            stack[part, 0] = start + (stop - start) * part / parts
            stack[part, 1] = start + (stop - start) * (part + 1) / parts
            stack[part, 2] = ceiling
        depth = parts
    while depth > 0:
        if least > limit:
            return least, math.inf, when, point, nodes
        depth -= 1
        left, right = stack[depth, 0], stack[depth, 1]
        middle = 0.5 * (left + right)
        half = max(middle - left, right - middle)
        u, _, stray = caps_at(orbits, frame, sphere, 0.0, middle, half)
        # a lower radius than this closes the interval, whatever it is
        enough = least + tolerance - stray.max()
        value = covering_radius(u, k, enough, stack[depth, 2], candidate)
        nodes += 1
        if value > max(least, enough):
            least, when = value, middle
            point[:] = candidate
        bound = value + stray.max()
        if (
            value <= enough
            or bound <= least + tolerance
            or nodes >= max_nodes
            or middle <= left
            or middle >= right
        ):
            most = max(most, bound)
            continue
        stack[depth, 0], stack[depth, 1], stack[depth, 2] = middle, right, bound
        stack[depth + 1, 0], stack[depth + 1, 1], stack[depth + 1, 2] = left, middle, bound
        depth += 2
    return least, min(max(least, most), math.pi), when, point, nodes

"""How far the k-th best satellite stands above a horizon: boxes of place and phase, halved.

A user stands at a geodetic latitude and a longitude (seen from the node of the elements), the
satellites have gone through a phase: ``M = M0 + pace phase``. Seen from the user at the centre of a
box of half-widths hb, hl and ht, a satellite at distance d, which moves by at most `swift` for a
radian of phase in the frame that turns with the user, strays by at most
``s = swift ht + rho hl + m hb``: rho is its distance from the axis (turning the user to the east is
turning the sky to the west) and m bounds the meridian's radius of curvature. Its direction turns by
at most ``delta = asin(s/d) + hb``, the last for the user's axes; its elevation by as much, its
azimuth by at most ``asin(sin delta / cos elevation)``. Elevation less delta, over the highest point
of the profile in that range of azimuths, is a lower bound of its clearance in all of the box, and
the k-th highest of these bounds is one of the k-th highest clearance.

On paths the centre's places are those of their series, and `s` holds their error too.

Where antennas have a beam, clearance is the lesser of that and of how far the user is inside the
beam. The angle at the satellite between him and the way down changes by at most ``delta`` and what
the satellite's own direction turns by, ``asin((swift ht + rho hl) / |q|)``.

`least_clearance` keeps the least that any centre showed and halves the boxes whose bound is below
it; `clear_share` adds up the boxes in which the clearance is surely positive or surely negative.
Halves look only at satellites of which it is not known yet on which side of the k-th they are (of
zero, for a share): those surely above it are counted, those surely below left out.

Directions are good to 1e-13 rad for phases of a revolution; `SLACK` covers that many times over,
and phases of thousands of revolutions.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.belt import area_below
from compass.core.jit import kernel
from compass.core.kepler import eccentric_anomaly
from compass.core.path import path_place, piece_of
from compass.core.sort import keep_greatest

#: Radians by which every comparison is made on the safe side.
SLACK = 1e-11

#: Columns of a box: centres and half-widths of latitude, longitude and phase, rad.
BOX = 6

#: Boxes that wait at once: each halving leaves one behind.
DEEPEST = 400

#: Longest side of the first boxes, rad.
COARSE = 0.5


class Question(NamedTuple):
    """Who moves how, and who looks from where: what no box changes.

    Attributes
    ----------
    orbits
        Rows: towards periapsis and across, times the axes (m, 3 each); e, mean anomaly, pace,
        swift, error of the place (m); shape (n, 11).
    breaks, paths
        As in `compass.core.path`, in phase: where satellites are instead of on ellipses, of which
        then swift and error count alone; without a stretch, shape (0, n, 3, 0), on these.
    figure
        Equatorial radius (m), eccentricity squared, height (m), bound of the meridian's radius
        of curvature (m), half angle of the satellites' beam (pi for all around).
    turn
        Of the user with the phase, rad per rad.
    azimuths, elevations
        Profile of the horizon: increasing azimuths in [0, 2 pi) and elevations, shape (m,), rad.
    normals, floors
        The region, as in `side_of`.
    """

    orbits: NDArray[np.float64]
    breaks: NDArray[np.float64]
    paths: NDArray[np.float64]
    figure: NDArray[np.float64]
    turn: float
    azimuths: NDArray[np.float64]
    elevations: NDArray[np.float64]
    normals: NDArray[np.float64]
    floors: NDArray[np.float64]


@kernel
def bounds(asked, k, box, who, ranges, near):
    """Lowest, central and highest clearance of the k-th best satellite in a box.

    Parameters
    ----------
    asked
        See `Question`.
    k
        Which satellite counts.
    box
        See `BOX`.
    who
        Which satellites are looked at, shape (m,).
    ranges
        Here the lowest and highest clearance of each of them is written, shape (m or more, 2).
    near
        Room for three rows of the k highest so far, shape (3, k or more).

    Returns
    -------
    lowest, central, highest
        Radians: bounds for the box, and what its centre shows; minus infinity without k, and
        infinity where none is needed.
    seen
        Satellites above the horizon at the centre.
    """
    orbits, breaks, paths, figure, turn, azimuths, elevations, _, _ = asked
    if k <= 0:
        return math.inf, math.inf, math.inf, 0
    near[:, :k] = -math.inf
    if who.size < k:
        return -math.inf, -math.inf, -math.inf, 0
    cb, sb = math.cos(box[0]), math.sin(box[0])
    across = figure[0] / math.sqrt(1.0 - figure[1] * sb * sb)
    eye_x = (across + figure[2]) * cb
    eye_z = (across * (1.0 - figure[1]) + figure[2]) * sb
    angle = box[1] + turn * box[2]
    ca, sa = math.cos(angle), math.sin(angle)
    level, top_of_all = elevations.min(), elevations.max()
    seen, place = 0, np.empty(3)
    piece = piece_of(breaks, box[2]) if paths.shape[0] > 0 else -1
    for j in range(who.size):
        s = who[j]
        o = orbits[s]
        if piece >= 0:
            path_place(breaks, paths, piece, s, box[2], place)
            x, y, z = place[0], place[1], place[2]
        else:
            anomaly = eccentric_anomaly(o[7] + o[8] * box[2], o[6])
            p, q = math.cos(anomaly) - o[6], math.sin(anomaly)
            x, y, z = o[0] * p + o[3] * q, o[1] * p + o[4] * q, o[2] * p + o[5] * q
        # turned to the longitude of the user, who stays at 0
        dx, dy, dz = ca * x + sa * y - eye_x, ca * y - sa * x, z - eye_z
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        up, north = cb * dx + sb * dz, cb * dz - sb * dx
        # an arc sine would lose half of the digits overhead
        elevation = math.atan2(up, math.sqrt(dy * dy + north * north))
        strays = o[10] + o[9] * box[5] + math.sqrt(x * x + y * y) * box[4] + figure[3] * box[3]
        delta = math.pi
        if strays < distance:
            delta = math.asin(strays / distance) + box[3] + SLACK
        here = bottom = top = level
        if top_of_all > level:
            azimuth = math.atan2(dy, north)
            here, _ = profile_range(azimuths, elevations, azimuth, 0.0)
            flat = math.cos(elevation)
            far = delta >= 0.5 * math.pi or math.sin(delta) >= flat
            around = math.pi if far else math.asin(math.sin(delta) / flat) + SLACK
            bottom, top = profile_range(azimuths, elevations, azimuth, around)
        lowest = max(elevation - delta, -0.5 * math.pi) - top
        central = elevation - here
        highest = min(elevation + delta, 0.5 * math.pi) - bottom
        if figure[4] < math.pi:
            room = figure[4] - _off_nadir(x, y, z, ca * dx - sa * dy, sa * dx + ca * dy, dz)
            away = math.sqrt(x * x + y * y + z * z)
            moves = strays - figure[3] * box[3]
            turn_of_it = math.asin(moves / away) if moves < away else math.pi
            lowest = min(lowest, room - delta - turn_of_it - SLACK)
            central = min(central, room)
            highest = min(highest, room + delta + turn_of_it + SLACK)
        seen += 1 if central >= -SLACK else 0
        ranges[j, 0], ranges[j, 1] = lowest, highest
        keep_greatest(near[0, :k], lowest)
        keep_greatest(near[1, :k], central)
        keep_greatest(near[2, :k], highest)
    return near[0, k - 1], near[1, k - 1], near[2, k - 1], seen


@kernel
def _off_nadir(x, y, z, dx, dy, dz):
    """Angle at a satellite between the way down and a user, who sees it along d, rad."""
    cx, cy, cz = y * dz - z * dy, z * dx - x * dz, x * dy - y * dx
    return math.atan2(math.sqrt(cx * cx + cy * cy + cz * cz), x * dx + y * dy + z * dz)


@kernel
def _open(who, ranges, below, above):
    """Keep at the front of `who` those of which it is not known on which side they are.

    Returns how many these are, and how many are surely above: none of their ranges begins below
    `above`. Those whose ranges end before `below` are left out.
    """
    kept, sure = 0, 0
    for j in range(who.size):
        if ranges[j, 1] < below:
            continue
        if ranges[j, 0] >= above:
            sure += 1
            continue
        who[kept] = who[j]
        kept += 1
    return kept, sure


@kernel
def _wait(half, axis, left, rank, depth, stack, who, ranks):
    """Let both halves of a box wait, cut across an axis; return how many boxes then wait.

    `half` has their size and the box's centre; of the box's `who` the first `left` are looked at,
    for the `rank`-th best of them.
    """
    who[depth + 1, :left] = who[depth, :left]
    for sign in (-1.0, 1.0):
        stack[depth] = half
        stack[depth, axis] += sign * half[3 + axis]
        ranks[depth, 0], ranks[depth, 1] = left, rank
        depth += 1
    return depth


@kernel
def side_of(box, figure, normals, floors):
    """Whether a box lies inside (1) or outside (-1) a region for sure, or may do either (0).

    Parameters
    ----------
    box
        See `BOX`.
    figure
        As in `bounds`.
    normals, floors
        The region: planetocentric directions p at longitude 0 of the box's frame with
        ``normals p >= floors``; shapes (m, 3) and (m,).
    """
    if floors.size == 0:
        return 1
    # a planetocentric direction turns by at most 1/(1 - e^2) of the geodetic latitude
    reach = box[3] / (1.0 - figure[1]) + box[4] + SLACK
    x, z = math.cos(box[0]), (1.0 - figure[1]) * math.sin(box[0])
    length = math.sqrt(x * x + z * z)
    x, z = x / length, z / length
    side = 1
    cl, sl = math.cos(box[1]), math.sin(box[1])
    for m in range(floors.size):
        height = normals[m, 0] * x * cl + normals[m, 1] * x * sl + normals[m, 2] * z - floors[m]
        if height < -reach:
            return -1
        if height < reach:
            side = 0
    return side


@kernel
def least_clearance(asked, k, domain, enough, give_up, tolerance, most):
    """Least clearance of the k-th best satellite over a domain, between bounds.

    Parameters
    ----------
    asked, k
        As in `bounds`.
    domain
        Least and greatest latitude, longitude and phase, shape (3, 2), rad.
    enough
        Clearances from this on need not be told apart, rad.
    give_up
        Stop at the first clearance below this, rad: the lower bound is then minus infinity.
    tolerance
        How near the bounds are to come, rad.
    most
        Boxes to look at before what is left is bounded as it is.

    Returns
    -------
    low, high
        Bounds, rad; infinite of a domain without a place.
    worst
        Latitude, longitude and phase at which `high` was found, shape (3,).
    seen
        Satellites above the horizon there; 0 if it was given up.
    boxes
        Boxes looked at.
    """
    figure, normals, floors = asked.figure, asked.normals, asked.floors
    near, cells = np.empty((3, max(k, 1))), _cells(domain)
    pace, n = _pace(asked.orbits), asked.orbits.shape[0]
    all_, ranges = np.arange(n), np.empty((n, 2))
    box, stack = np.zeros(BOX), np.empty((DEEPEST, BOX))
    who, ranks = np.empty((DEEPEST, n), dtype=np.int64), np.empty((DEEPEST, 2), dtype=np.int64)
    high, seen, worst = math.inf, 0, np.full(3, math.nan)
    # a first guess: the lowest of the centres of the first boxes, and down from there
    for cell in range(cells.prod()):
        _cell(domain, cells, cell, box)
        if side_of(np.array([box[0], box[1], box[2], 0.0, 0.0, 0.0]), figure, normals, floors) < 0:
            continue
        _, central, _, _ = bounds(asked, k, box, all_, ranges, near)
        if central < high:
            high = central
            worst[:] = box[:3]
            if high < give_up:
                return -math.inf, high, worst, seen, cell
    step, spot = 0.5 * COARSE, np.zeros(BOX)
    while step > 1e-7 and high < math.inf:
        better = False
        for axis in range(3):
            for sign in (-1.0, 1.0):
                spot[:3] = worst
                moved = worst[axis] + sign * step
                spot[axis] = min(max(moved, domain[axis, 0]), domain[axis, 1])
                if side_of(spot, figure, normals, floors) < 0:
                    continue
                _, central, _, _ = bounds(asked, k, spot, all_, ranges, near)
                if central < high:
                    high, better = central, True
                    worst[:] = spot[:3]
        if high < give_up:
            return -math.inf, high, worst, seen, 0
        step = step if better else 0.5 * step
    low, boxes = math.inf, 0
    for cell in range(cells.prod()):
        _cell(domain, cells, cell, stack[0])
        who[0], ranks[0, 0], ranks[0, 1] = all_, n, k
        depth = 1
        while depth > 0:
            depth -= 1
            box[:] = stack[depth]
            boxes += 1
            side = side_of(box, figure, normals, floors)
            if side < 0:
                continue
            few, rank = who[depth, : ranks[depth, 0]], ranks[depth, 1]
            bottom, central, top, _ = bounds(asked, rank, box, few, ranges, near)
            # who is nowhere below what was seen already may count as above
            left, sure = _open(few, ranges, bottom, min(np.nextafter(top, math.inf), high))
            if central < high:
                spot[:3] = box[:3]
                if side_of(spot, figure, normals, floors) >= 0:
                    high = central
                    worst[:] = box[:3]
                    if high < give_up:
                        return -math.inf, high, worst, seen, boxes
            longest = _longest(box, pace)
            done = bottom >= min(high - tolerance, enough) or boxes >= most
            if done or depth + 2 > DEEPEST or box[3 + longest] < 1e-10:
                low = min(low, bottom)
                continue
            box[3 + longest] *= 0.5
            depth = _wait(box, longest, left, rank - sure, depth, stack, who, ranks)
    if high < math.inf:
        spot[:3] = worst
        _, _, _, seen = bounds(asked, k, spot, all_, ranges, near)
    return min(low, high), high, worst, seen, boxes


@kernel
def _cells(domain):
    """Along each axis of the domain how many first boxes, of at most `COARSE`, there are."""
    cells = np.empty(3, dtype=np.int64)
    for axis in range(3):
        cells[axis] = max(1, math.ceil((domain[axis, 1] - domain[axis, 0]) / COARSE))
    return cells


@kernel
def _cell(domain, cells, number, box):
    """Write the first box of a number: the domain cut evenly into `cells` along its axes."""
    for axis in range(3):
        place = number % cells[axis]
        number //= cells[axis]
        half = 0.5 * (domain[axis, 1] - domain[axis, 0]) / cells[axis]
        box[axis] = domain[axis, 0] + (2 * place + 1) * half
        # the halves may fall short of the edges by rounding
        box[3 + axis] = half * (1.0 + 1e-15) if half > 0.0 else 0.0


@kernel
def _pace(orbits):
    """How fast satellites stray with the phase, in radii of the orbit."""
    pace = 0.0
    for o in orbits:
        axis = math.sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2])
        pace = max(pace, o[9] / axis)
    return pace


@kernel
def _longest(box, pace):
    """The axis along which satellites stray most, about so as seen from the user."""
    lengths = (1.2 * box[3], box[4], pace * box[5])
    longest = 0
    for axis in range(1, 3):
        if lengths[axis] > lengths[longest]:
            longest = axis
    return longest


@kernel
def clear_share(asked, k, domain, whole, finest, most):
    """Measure of a domain in which the k-th best satellite is clear for sure, is not, and open.

    Parameters
    ----------
    asked, k, domain
        As in `least_clearance`.
    whole
        1 if all latitudes of the domain must be clear at once: shares are then of longitude and
        phase; 2 if all longitudes too: of phase alone. With 0 they are of area and phase, of users
        on the figure itself.
    finest
        Boxes of a smaller measure are not split.
    most
        Boxes to look at before what is left stays open.

    Returns
    -------
    clear, hidden, undecided, boxes
        Measures, and boxes looked at.
    """
    figure, normals, floors = asked.figure, asked.normals, asked.floors
    near, cells = np.empty((3, max(k, 1))), _cells(domain)
    cells[:whole] = 1
    pace, n = _pace(asked.orbits), asked.orbits.shape[0]
    ranges, who = np.empty((n, 2)), np.empty((DEEPEST, n), dtype=np.int64)
    ranks = np.empty((DEEPEST, 2), dtype=np.int64)
    box, stack, kept = np.zeros(BOX), np.empty((DEEPEST, BOX)), np.empty(3)
    clear, hidden, undecided, boxes = 0.0, 0.0, 0.0, 0
    for cell in range(cells.prod()):
        _cell(domain, cells, cell, stack[0])
        who[0], ranks[0, 0], ranks[0, 1] = np.arange(n), n, k
        depth = 1
        while depth > 0:
            depth -= 1
            box[:] = stack[depth]
            boxes += 1
            side = side_of(box, figure, normals, floors)
            if side < 0:
                continue
            part = _measure(box, figure, whole, domain)
            few, rank = who[depth, : ranks[depth, 0]], ranks[depth, 1]
            bottom, _, top, _ = bounds(asked, rank, box, few, ranges, near)
            if bottom >= 0.0 and side > 0:
                clear += part
                continue
            if top < 0.0 and side > 0:
                hidden += part
                continue
            if part <= finest or boxes >= most or depth + 2 > DEEPEST:
                undecided += part
                continue
            kept[:whole] = box[3 : 3 + whole]
            box[3 : 3 + whole] = 0.0
            longest = _longest(box, pace)
            box[3 + longest] *= 0.5
            box[3 : 3 + whole] = kept[:whole]
            left, sure = 0, 0
            if 0 < rank <= few.size:
                left, sure = _open(few, ranges, 0.0, 0.0)
            depth = _wait(box, longest, left, rank - sure, depth, stack, who, ranks)
    return clear, hidden, undecided, boxes


@kernel
def _measure(box, figure, whole, domain):
    """Longitude times phase, and times the figure's area of the belt where that counts.

    Sides of length zero, of a domain that has no more, count as one.
    """
    part = 1.0
    for axis in range(max(whole, 1), 3):
        part *= 2.0 * box[3 + axis] if domain[axis, 1] > domain[axis, 0] else 1.0
    if whole or domain[0, 1] == domain[0, 0]:
        return part
    north, south = box[0] + box[3], box[0] - box[3]
    return part * (area_below(north, figure[1]) - area_below(south, figure[1]))


@kernel
def profile_range(azimuths, elevations, azimuth, turn):
    """Lowest and highest elevation of a profile within `turn` of an azimuth, rad."""
    m = azimuths.size
    if m == 1 or turn >= math.pi:
        return elevations.min(), elevations.max()
    around = 2.0 * math.pi
    bottom, top = math.inf, -math.inf
    for k in range(m):
        following = (k + 1) % m
        start = azimuths[k]
        width = azimuths[following] - start + (around if following == 0 else 0.0)
        # how far into this piece the range begins: pieces before it are cut off at 0
        first = azimuth - turn - start
        first -= around * math.floor(first / around)
        for shift in (0.0, -around):
            begin, end = max(first + shift, 0.0), min(first + shift + 2.0 * turn, width)
            if begin <= end:
                slope = (elevations[following] - elevations[k]) / width
                one, two = elevations[k] + slope * begin, elevations[k] + slope * end
                bottom, top = min(bottom, one, two), max(top, one, two)
    return bottom, top

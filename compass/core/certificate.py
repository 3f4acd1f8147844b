"""Proof over time: bisect an interval until the fold of shrunk caps settles every part of it.

In a frame that turns at Omega, a satellite direction moves at most ``|W h - Omega|`` rad/s, h the
orbit's pole and W the rate of the true anomaly, and the radius of its cap changes at most
``V = dlambda/dr e sqrt(GM/p)``. Over a half interval H the cap at any moment therefore contains
the one of mid-time shrunk by ``(|W h - Omega| + V) H`` and lies inside the one grown by as much.
W = sqrt(GM p)/r^2 and dlambda/dr fall with r, so they are bounded at the least radius that can
occur in the interval, ``max(r_p, r - e sqrt(GM/p) H)``; ``|W h - Omega|`` is convex in W, so its
bound is at one end of the range of W.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.figure import stretched_caps
from compass.core.fold import Sides, cap_cosine, cell_point, extreme_fold
from compass.core.jit import kernel
from compass.core.kepler import elliptic_states

UNIT_ROUNDOFF = 1.1102230246251565e-16

PROVEN, REFUTED, UNDECIDED = 0, 1, 2

#: Unsettled intervals that are kept for the user to see.
KEPT = 32


class Orbits(NamedTuple):
    """Orbits of n satellites.

    `elements` (7, n): rows a, e, i, RAAN, argument of periapsis, mean anomaly, mean motion, SI;
    `poles` (n, 3): unit vectors along the angular momenta in the inertial frame; `gm`, m^3/s^2.
    """

    elements: NDArray[np.float64]
    poles: NDArray[np.float64]
    gm: float


class Frame(NamedTuple):
    """The frame in which motion is bounded.

    `spin` (3,): its angular velocity Omega, rad/s; `angle` at time 0 of one that turns about z with
    ``spin[2]``, nan for directions in the inertial frame (their arrangement is the same, whichever
    way it is turned); `error`: what directions in it may be off by, radians.
    """

    spin: NDArray[np.float64]
    angle: float
    error: float


class Ground(NamedTuple):
    """Who looks up: equatorial `radius`, m, its ratio to the polar one (`stretch`), `mask`, rad."""

    radius: float
    stretch: float
    mask: float


@kernel
def caps_at(orbits, frame, sphere_radius, mask, time, half):
    """Directions, cap radii and how far both can stray within `half` of `time`.

    Parameters
    ----------
    orbits, frame
        `Orbits` and `Frame`.
    sphere_radius, mask
        m, rad.
    time, half
        Seconds.

    Returns
    -------
    u, radius, stray
        Shapes (n, 3), (n,), (n,); radians. `stray` includes the rounding of the motion: phases
        are good to ``4 (|M| + 8)`` roundoffs, times the greatest ``d(true)/d(mean anomaly)``.
    """
    elements, poles, gm, spin = orbits.elements, orbits.poles, orbits.gm, frame.spin
    n = elements.shape[1]
    still = np.zeros(n)
    times = np.empty(1)
    times[0] = time
    r, _ = elliptic_states(
        elements[0], elements[1], elements[2], elements[3], elements[4], elements[5], still, still,
        elements[6], times,
    )  # fmt: skip
    turned = not math.isnan(frame.angle)
    angle = frame.angle + spin[2] * time if turned else 0.0
    ca, sa = math.cos(angle), math.sin(angle)
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty(n)
    for s in range(n):
        x, y, z = r[s, 0, 0], r[s, 0, 1], r[s, 0, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        u[s, 0], u[s, 1], u[s, 2] = (
            (ca * x + sa * y) / distance,
            (ca * y - sa * x) / distance,
            z / distance,
        )
        a, e = elements[0, s], elements[1, s]
        p = a * (1.0 - e * e)
        radial = e * math.sqrt(gm / p)
        nearest = max(a * (1.0 - e), distance - radial * half)
        farthest = min(a * (1.0 + e), distance + radial * half)
        momentum = math.sqrt(gm * p)
        rate = 0.0
        for w in (momentum / (nearest * nearest), momentum / (farthest * farthest)):
            dx = w * poles[s, 0] - spin[0]
            dy = w * poles[s, 1] - spin[1]
            dz = w * poles[s, 2] - spin[2]
            rate = max(rate, math.sqrt(dx * dx + dy * dy + dz * dz))
        rim = sphere_radius * math.cos(mask)
        growth = radial * rim / (nearest * math.sqrt(nearest * nearest - rim * rim))
        radius[s] = math.acos(rim / distance) - mask
        phase = abs(elements[5, s]) + abs(elements[6, s] * time) + abs(angle) + 8.0
        steepest = momentum / (a * a * (1.0 - e) * (1.0 - e)) / elements[6, s]
        stray[s] = (rate + growth) * half + 4.0 * UNIT_ROUNDOFF * phase * steepest
    return u, radius, stray


@kernel
def settle(orbits, frame, ground, sides, low, k, start, stop, tolerance, max_nodes):
    """Settle "fold >= k" (`low`) or "fold <= k" (not `low`) on the whole of [start, stop].

    On an ellipsoid, whose caps are only known between bounds, bands of latitude are halved where
    those bounds are wider than what the satellites' motion does.

    Parameters
    ----------
    orbits, frame, ground
        `Orbits`, `Frame` (on an ellipsoid one that turns about the pole) and `Ground`.
    sides
        `compass.core.fold.Sides`; of an ellipsoid stretched along the pole to a sphere.
    low, k
        The claim.
    start, stop
        Seconds.
    tolerance
        An interval in which no cap strays more than this, radians, is split no further.
    max_nodes
        Intervals to look at before giving up.

    Returns
    -------
    outcome, nodes, open_parts, unsettled, time, point, fold
        `PROVEN`, `REFUTED` or `UNDECIDED`; intervals looked at; intervals left, and the first
        `KEPT` of them (rows start, stop); the moment, place and fold of the counter-example.
    """
    n, parts, stretch = orbits.elements.shape[1], sides.floors.size, ground.stretch
    normals, heights = np.zeros((parts + 2, 3)), np.empty(parts + 2)
    normals[:parts], heights[:parts] = sides.normals, sides.floors
    stack = np.empty((256, 4))  # intervals of time, and bands: sines of their latitudes
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = start, stop, -1.0, 1.0
    depth, nodes, open_parts = 1, 0, 0
    unsettled = np.zeros((KEPT, 2))
    nowhere = np.zeros(3)
    cosines, outer = np.empty(n), np.empty(n)
    while depth > 0:
        depth -= 1
        left, right, south, north = stack[depth]
        if nodes >= max_nodes:
            if open_parts < KEPT:
                unsettled[open_parts, 0], unsettled[open_parts, 1] = left, right
            open_parts += 1
            continue
        nodes += 1
        middle = 0.5 * (left + right)
        half = max(middle - left, right - middle)
        level = ground.mask if stretch == 1.0 else 0.0
        u, radius, stray = caps_at(orbits, frame, ground.radius, level, middle, half)
        outer[:] = radius
        by_band, by_time = 0.0, 0.0
        if stretch != 1.0:
            by_band, by_time = stretched_caps(
                orbits, ground, half, south, north, u, radius, stray, outer
            )
        rows = parts
        for sign, rim in ((1.0, south), (-1.0, -north)):
            if rim > -1.0:
                normals[rows, 2], heights[rows] = sign, rim
                rows += 1
        largest = by_time
        for s in range(n):
            wander = stray[s] + frame.error
            largest = max(largest, wander + by_time)
            cosines[s] = cap_cosine(radius[s] if low else outer[s], -wander if low else wander)
        where = Sides(normals[:rows], heights[:rows])
        fold, curve, _, _ = extreme_fold(u, cosines, where, low, True, k)
        if curve == n and rows > 0:
            continue  # no circle and no rim has a point here: a band beside the region
        if (low and fold >= k) or (not low and fold <= k):
            continue
        for s in range(n):
            cosines[s] = cap_cosine(outer[s] if low else radius[s], 0.0)
        everywhere = -1 if low else n + 1  # no early return: the widest of the extreme arcs
        fold, curve, azimuth, width = extreme_fold(u, cosines, where, low, True, everywhere)
        if (low and fold < k) or (not low and fold > k):
            point, fold, found = cell_point(curve, azimuth, width, u, cosines, where, low)
            if found and ((low and fold < k) or (not low and fold > k)):
                return REFUTED, nodes, open_parts, unsettled, middle, point, fold
        waist = 0.5 * (south + north)
        whole = largest <= tolerance or middle <= left or middle >= right
        if by_band > (tolerance if whole else largest) and south < waist < north:
            for part in range(2):
                row = stack[depth + part]
                row[0], row[1] = left, right
                row[2], row[3] = (waist, north) if part == 0 else (south, waist)
            depth += 2
            continue
        if whole:
            if open_parts < KEPT:
                unsettled[open_parts, 0], unsettled[open_parts, 1] = left, right
            open_parts += 1
            continue
        for part in range(2):
            row = stack[depth + part]
            row[0], row[1] = (middle, right) if part == 0 else (left, middle)
            row[2], row[3] = south, north
        depth += 2
    outcome = UNDECIDED if open_parts else PROVEN
    return outcome, nodes, open_parts, unsettled, 0.0, nowhere, 0

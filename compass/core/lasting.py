"""How long caps on moving paths cover k-fold: proven in time order, no symmetry used.

In an interval of half length h about a moment m, in a frame that turns at a constant Omega, the
direction u of a satellite at r with velocity v and distance rho moves by at most

    |w| h + (A + 2 R' W) h^2 / (2 rho_) + |Omega| W h^2 / 2 .

Here ``w = u' - Omega x u`` at m; the rate of ``|w|`` is the part of ``w' = u'' - Omega x u'``
along w, which is normal to u; normal to u, ``u'' = (r'' - 2 rho' u') / rho``. Bounds over the
interval: A of the acceleration (sums of Legendre coefficients), ``V = |v| + A h`` of the speed,
``rho_ = rho - |rho'| h - (A + V^2/(rho - V h)) h^2 / 2`` of the distance from below, because
``rho'' = u . r'' + rho |u'|^2``; ``W = V / rho_``; and ``R' = |rho'| + (A + V^2 / rho_) h``.

The radius of the cap, ``acos(q / rho) - mask`` with ``q = R cos(mask)``, has the slope
``q / (rho sqrt(rho^2 - q^2))``, which falls with rho: it changes by less than R' h times that at
rho_. An error e of the path turns the direction by less than ``1.001 e / rho_`` (e is below a
twentieth of rho_) and changes the radius by e times the slope. Every cap of the interval thus
contains the one of m shrunk by the sum of all these: its `stray`.

The frame turns with the mean of the satellites' angular velocities at m (about the pole alone for
a band of latitude, with Mars for a polygon). Any choice is right, for the fold over the whole
sphere does not change when all is turned; this one makes the strays small.

On an ellipsoid all is stretched along the pole (`core.figure`), which turns directions by no more
than the stretch; a cap then lies between two, and half of what lies between counts as an error.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.figure import stretched_cap
from compass.core.fold import (
    WELL,
    Sides,
    cap_cosine,
    cell_point,
    extreme_fold,
    thin_beside,
    thin_circle,
)
from compass.core.jit import kernel
from compass.core.path import path_state, piece_of, pull_bound

PROVEN, LOST, UNDECIDED = 0, 1, 2

#: Which frame suits the region.
FREE, ABOUT_POLE, WITH_MARS = 0, 1, 2

#: Unsettled intervals that are kept for the user to see.
KEPT = 32

#: Rounding of directions and radii, radians: some 100 roundoffs.
ROUNDING = 2e-14


class MovingCaps(NamedTuple):
    """Caps of satellites on their paths, and where they are to cover.

    Attributes
    ----------
    breaks, paths, errors
        As in `compass.core.path`; errors in m, shape (p, n).
    turns
        Angle of the prime meridian at the breaks, radians, shape (p + 1,).
    frame
        `FREE`, `ABOUT_POLE` or `WITH_MARS`.
    ground
        Radius of the sphere (equatorial, m), the ellipsoid's stretch (1: a sphere), the mask,
        radians, and the band of users, sines of their latitudes on the stretched sphere. On an
        ellipsoid the frame is not `FREE`.
    sides
        Of the region and the band.
    """

    breaks: NDArray[np.float64]
    paths: NDArray[np.float64]
    errors: NDArray[np.float64]
    turns: NDArray[np.float64]
    frame: int
    ground: tuple[float, float, float, float, float]
    sides: Sides


@kernel
def caps_between(caps, pulls, piece, middle, half, u, radius, stray):
    """Fill directions, cap radii and strays about a moment, and the part that cannot shrink.

    Parameters
    ----------
    caps
        The caps.
    pulls
        Bound on the acceleration on this stretch, shape (n,).
    piece, middle, half
        The stretch that holds the interval, and the interval, s.
    u, radius, stray
        Outputs, shapes (n, 3), (n,), (n, 2); the second column is of the error alone.

    Returns
    -------
    bool
        Whether bounds could be had; not if a satellite could come down to the sphere.
    """
    breaks, paths, errors, turns, frame, ground, _ = caps
    sphere, stretch, mask, south, north = ground
    n = paths.shape[1]
    state = np.empty((n, 6))
    spin = np.zeros(3)
    for s in range(n):
        path_state(breaks, paths, piece, s, middle, state[s])
        x, y, z, vx, vy, vz = state[s]
        squared = x * x + y * y + z * z
        spin[0] += (y * vz - z * vy) / squared / n
        spin[1] += (z * vx - x * vz) / squared / n
        spin[2] += (x * vy - y * vx) / squared / n
    angle = 0.0
    if frame != FREE:
        spin[0], spin[1] = 0.0, 0.0
    if frame == WITH_MARS:
        spin[2] = (turns[piece + 1] - turns[piece]) / (breaks[piece + 1] - breaks[piece])
        angle = turns[piece] + spin[2] * (middle - breaks[piece])
    turning = math.sqrt(spin[0] ** 2 + spin[1] ** 2 + spin[2] ** 2)
    ca, sa = math.cos(angle), math.sin(angle)
    rim = sphere * math.cos(mask)
    for s in range(n):
        x, y, z, vx, vy, vz = state[s]
        rho = math.sqrt(x * x + y * y + z * z)
        ux, uy, uz = x / rho, y / rho, z / rho
        climb = ux * vx + uy * vy + uz * vz
        wx = (vx - climb * ux) / rho - (spin[1] * uz - spin[2] * uy)
        wy = (vy - climb * uy) / rho - (spin[2] * ux - spin[0] * uz)
        wz = (vz - climb * uz) / rho - (spin[0] * uy - spin[1] * ux)
        pull = pulls[s]
        speed = math.sqrt(vx * vx + vy * vy + vz * vz) + pull * half
        low = rho - speed * half
        if low <= 0.5 * rho:
            return False
        low = rho - abs(climb) * half - 0.5 * (pull + speed * speed / low) * half * half
        error = errors[piece, s]
        if low - error <= sphere or error > 0.05 * low:
            return False
        rate = speed / low
        climbing = abs(climb) + (pull + speed * rate) * half
        bend = (pull + 2.0 * climbing * rate) / low + turning * rate
        slope = rim / ((low - error) * math.sqrt((low - error) ** 2 - rim * rim))
        u[s, 0], u[s, 1], u[s, 2] = ca * ux + sa * uy, ca * uy - sa * ux, uz
        radius[s] = math.acos(rim / rho) - mask
        # the chord of the meridian over a stretch is off by less than this (curvature 3e-19)
        fixed = 4e-20 * (breaks[piece + 1] - breaks[piece]) ** 2 if frame == WITH_MARS else 0.0
        fixed += 1.001 * error / low + slope * error + ROUNDING
        moving = math.sqrt(wx * wx + wy * wy + wz * wz) * half + 0.5 * bend * half * half
        if stretch == 1.0:
            stray[s, 0], stray[s, 1] = moving + slope * climbing * half + fixed, fixed
            continue
        long = math.sqrt(ux * ux + uy * uy + stretch * stretch * uz * uz)
        u[s, 0], u[s, 1], u[s, 2] = u[s, 0] / long, u[s, 1] / long, stretch * uz / long
        upward = abs(vz) + pull * half
        rate = climbing + (stretch * stretch - 1.0) * upward
        far, off = long * rho, stretch * error
        near, distant = max(low - error, far - rate * half - off), far + rate * half + off
        inner, outer, _, _, _ = stretched_cap(
            sphere,
            stretch,
            mask,
            south,
            north,
            far,
            near,
            distant,
            stretch * z,
            stretch * (upward * half + error),
        )
        slope = sphere / (near * math.sqrt(near * near - sphere * sphere))
        radius[s] = 0.5 * (inner + outer)
        fixed = stretch * (fixed + slope * error) + 0.5 * (outer - inner)
        stray[s, 0], stray[s, 1] = stretch * moving + slope * rate * half + fixed, fixed
    return True


@kernel
def first_loss(caps, k, start, stop, resolution, tolerance, max_nodes):
    """Settle "fold >= k" from `start` on, in time order, up to `stop` or the first loss.

    An interval whose shrunk caps still cover k-fold is proven. Where at the middle of one too few
    caps cover some place even when grown by the paths' errors, coverage is lost by then: what is
    later does not matter any more, and the time before is settled until the loss stands between
    two moments `resolution` apart.

    Parameters
    ----------
    caps
        The caps.
    k
        Fold.
    start, stop, resolution
        Seconds.
    tolerance
        An interval in which no cap moves more than this, radians, or than its error, is not split.
    max_nodes
        Intervals to look at.

    Returns
    -------
    outcome, nodes, proven, lost, point, parts, unsettled
        `PROVEN`, `LOST` or `UNDECIDED`; intervals looked at; up to when all is proven; when
        coverage is surely lost (infinite if it is not) and where; intervals left open and the
        first `KEPT` of them.
    """
    breaks, paths, _, _, _, _, sides = caps
    n = paths.shape[1]
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty((n, 2))
    cosines, pulls = np.empty(n), np.empty(n)
    stack = np.empty((128, 2))
    unsettled, place = np.zeros((KEPT, 2)), np.zeros(3)
    nodes, parts, thin = 0, 0, WELL
    limit, lost, proven = stop, math.inf, start
    piece = piece_of(breaks, start)
    while piece < breaks.size - 1 and breaks[piece] < limit:
        for s in range(n):
            pulls[s] = pull_bound(breaks, paths, piece, s)
        stack[0, 0] = max(start, breaks[piece])
        stack[0, 1] = min(limit, breaks[piece + 1])
        depth = 1 if stack[0, 1] > stack[0, 0] else 0
        while depth > 0:
            depth -= 1
            left, right = stack[depth, 0], min(stack[depth, 1], limit)
            if left >= right:
                continue
            done, closing = False, right == lost and right - left <= resolution
            middle = 0.5 * (left + right)
            half = max(middle - left, right - middle)
            still = middle <= left or middle >= right
            if closing or nodes >= max_nodes:
                still = True
            else:
                nodes += 1
                known = caps_between(caps, pulls, piece, middle, half, u, radius, stray)
                if known:
                    slowest = True
                    for s in range(n):
                        moving = stray[s, 0] - stray[s, 1]
                        slowest = slowest and moving <= max(tolerance, stray[s, 1])
                        cosines[s] = cap_cosine(radius[s], -stray[s, 0])
                    thin = thin_circle(u, cosines, sides, k, thin)
                    done = thin == WELL
                    still = still or slowest
                    if not done:
                        for s in range(n):
                            cosines[s] = cap_cosine(radius[s], stray[s, 1])
                        # where it is thin on the way it may be at the middle; only the last look
                        # at an interval is at all circles
                        fold = k
                        if still or thin_beside(thin, u, cosines, sides, k) != 0:
                            fold, curve, azimuth, width = extreme_fold(
                                u, cosines, sides, True, True, -1
                            )
                        if fold < k:
                            point, fold, found = cell_point(
                                curve, azimuth, width, u, cosines, sides, True
                            )
                            if found and fold < k:
                                lost, limit, depth = middle, middle, 0
                                place[:] = point
                                stack[0, 0], stack[0, 1] = left, middle
                                depth = 1
                                continue
            if done:
                if parts == 0:
                    proven = right
            elif still:
                if not closing:
                    if parts < KEPT:
                        unsettled[parts, 0], unsettled[parts, 1] = left, right
                    parts += 1
            else:
                stack[depth, 0], stack[depth, 1] = middle, right
                stack[depth + 1, 0], stack[depth + 1, 1] = left, middle
                depth += 2
        piece += 1
    if parts > 0:
        proven = min(proven, unsettled[0, 0])
    outcome = LOST if lost < math.inf else (UNDECIDED if parts > 0 else PROVEN)
    return outcome, nodes, proven, lost, place, parts, unsettled


@kernel
def margin_at(u, radius, sides, k, low, high, tolerance):
    """How much all caps may shrink, radians, with the fold still k; between `low` and `high`.

    By halving; the result is on the safe side by less than `tolerance`. Negative where they must
    grow; all of it in a region that has no place.
    """
    cosines, thin = np.empty(radius.size), WELL
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        for s in range(radius.size):
            cosines[s] = cap_cosine(radius[s], -middle)
        thin = thin_circle(u, cosines, sides, k, thin)
        if thin == WELL:
            low = middle
        else:
            high = middle
    return low


@kernel
def margins(caps, k, times, tolerance):
    """`margin_at` many moments, radians, between bounds, shape (t, 2).

    They differ by what lies between an ellipsoid's caps; on a sphere they are one.
    """
    breaks, paths, _, _, _, ground, sides = caps
    n = paths.shape[1]
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty((n, 2))
    pulls, tried = np.zeros(n), np.empty(n)
    least = np.full((times.size, 2), np.nan)
    for j in range(times.size):
        piece = piece_of(breaks, times[j])
        if caps_between(caps, pulls, piece, times[j], 0.0, u, radius, stray):
            for side in range(2):
                vague = 0.0 if ground[1] == 1.0 else (2.0 * side - 1.0)
                for s in range(n):
                    tried[s] = radius[s] + vague * stray[s, 1]
                if side == 1 and vague == 0.0:
                    least[j, 1] = least[j, 0]
                else:
                    least[j, side] = margin_at(u, tried, sides, k, -math.pi, math.pi, tolerance)
    return least


@kernel
def least_margin(caps, k, start, stop, tolerance, max_nodes):
    """Least margin over an interval of time, radians: bounds from below and above.

    Branch and bound: an interval whose caps, shrunk by their strays and the least margin met so
    far but for `tolerance`, still cover k-fold, holds nothing lower that matters. Nor is one split
    in which no cap moves by more than lies between an ellipsoid's caps.

    Returns
    -------
    below, above, nodes
        The least margin is not below the first (but for the paths' errors, which count against
        it) nor above the second.
    """
    breaks, paths, _, _, _, ground, sides = caps
    n = paths.shape[1]
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty((n, 2))
    cosines, pulls = np.empty(n), np.empty(n)
    stack = np.empty((128, 2))
    nodes, below, above, vague, thin = 0, math.pi, math.pi, 0.0, WELL
    piece = piece_of(breaks, start)
    while piece < breaks.size - 1 and breaks[piece] < stop:
        for s in range(n):
            pulls[s] = pull_bound(breaks, paths, piece, s)
        stack[0, 0] = max(start, breaks[piece])
        stack[0, 1] = min(stop, breaks[piece + 1])
        depth = 1 if stack[0, 1] > stack[0, 0] else 0
        while depth > 0:
            depth -= 1
            left, right = stack[depth, 0], stack[depth, 1]
            middle = 0.5 * (left + right)
            half = max(middle - left, right - middle)
            nodes += 1
            known = caps_between(caps, pulls, piece, middle, half, u, radius, stray)
            if known:
                goal, furthest, fixed, slow = above - tolerance, 0.0, 0.0, ground[1] != 1.0
                for s in range(n):
                    furthest = max(furthest, stray[s, 0])
                    fixed = max(fixed, stray[s, 1])
                    slow = slow and stray[s, 0] <= 2.0 * stray[s, 1]
                    cosines[s] = cap_cosine(radius[s], -goal - stray[s, 0])
                thin = thin_circle(u, cosines, sides, k, thin)
                if thin == WELL:
                    below = min(below, goal)
                    continue
                last = slow or half < 1e-3 or nodes >= max_nodes
                for s in range(n):
                    cosines[s] = cap_cosine(radius[s], -above)
                # the circle that is thin somewhen in the interval; all of them only if it is the
                # last look, or the first
                lower = thin_beside(thin, u, cosines, sides, k) == 1
                if last or (above == math.pi and not lower):
                    lower = thin_circle(u, cosines, sides, k, thin) != WELL
                if lower:
                    above = margin_at(u, radius, sides, k, -math.pi, above, 1e-6) + 1e-6
                    vague = 0.0 if ground[1] == 1.0 else fixed
                if last:
                    below = min(below, above - furthest)
                    continue
            elif half < 1e-3 or nodes >= max_nodes:
                return -math.pi, -math.pi, nodes
            stack[depth, 0], stack[depth, 1] = middle, right
            stack[depth + 1, 0], stack[depth + 1, 1] = left, middle
            depth += 2
        piece += 1
    return min(below, above), min(above + vague, math.pi), nodes

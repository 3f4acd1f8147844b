"""When things come into sight and go: roots of a sight function, isolated without sampling.

On an interval of length h with end values fa, fb, end rates ga, gb and ``|f''| <= K``, f has no
root if fa and fb agree in sign and ``min |f| > K h^2 / 8`` (it stays that close to its chord),
and at most one if ``|ga + gb| > K h`` (its rate keeps its sign). Otherwise the interval is
halved. So no root is missed, but for pairs of roots closer than `FINEST`.
"""

import math

import numpy as np

from compass.core.horizon import horizon_clear, horizon_state
from compass.core.jit import kernel
from compass.core.motion import meridian, mover_bounds, mover_state
from compass.core.sight import (
    ELEVATION,
    HORIZON,
    LIMB,
    eclipse_curvature,
    eclipse_sight,
    elevation_curvature,
    elevation_sight,
    limb_curvature,
    limb_sight,
    up_vector,
)

#: Seconds. Windows, and gaps between windows, shorter than this may be missed.
FINEST = 1e-3

#: Seconds. How closely a root is enclosed.
SHARPEST = 1e-6

#: Steps into which the faster of the two motions' turns is cut in looking for a culmination.
STEPS_PER_TURN = 64


@kernel
def sight(kind, numbers, one, two, table, t):
    """Value, rate, and for the bounds: both distances, stretched distances, mutual distance."""
    p, q = mover_state(one, table, t), mover_state(two, table, t)
    rp = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    rq = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    apart = math.sqrt(dx * dx + dy * dy + dz * dz)
    sp, sq = rp, rq
    if kind == ELEVATION:
        angle, rate = meridian(one, t)
        f, g = elevation_sight(one, angle, rate, numbers[0], p, q)
    elif kind == LIMB:
        f, g = limb_sight(numbers[0], numbers[1], numbers[2], p, q)
        excess = numbers[1] * numbers[1] - 1.0
        sp = math.sqrt(rp * rp + excess * p[2] * p[2])
        sq = math.sqrt(rq * rq + excess * q[2] * q[2])
    else:
        f, g = eclipse_sight(numbers[0], numbers[1], numbers[2], p, q)
    return f, g, rp, rq, sp, sq, apart


@kernel
def curvature(kind, numbers, one, two, a, b, h):
    """Bound on ``|f''|`` over an interval with `sight` a and b at its ends."""
    bounds_one, bounds_two = mover_bounds(one, a[2], b[2], h), mover_bounds(two, a[3], b[3], h)
    if kind == ELEVATION:
        rate = 1.00001 * abs(one[9]) / one[7]
        return elevation_curvature(rate, numbers[0], a[6], b[6], h, bounds_one, bounds_two)
    if kind == LIMB:
        ends_p, ends_q = (a[4], b[4]), (a[5], b[5])
        return limb_curvature(
            numbers[0], numbers[1], numbers[2], ends_p, ends_q, h, bounds_one, bounds_two
        )
    return eclipse_curvature(numbers[0], (a[2], b[2]), h, bounds_one, bounds_two)


@kernel
def refine(kind, numbers, one, two, table, low, high, low_inside):
    """Time of the one change of sign between `low` and `high`, to `SHARPEST`: Newton, bracketed."""
    t = 0.5 * (low + high)
    for _ in range(100):
        s = sight(kind, numbers, one, two, table, t)
        if (s[0] >= 0.0) == low_inside:
            low = t
        else:
            high = t
        following = t - s[0] / s[1] if s[1] != 0.0 else 0.5 * (low + high)
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - t) <= SHARPEST or high - low <= SHARPEST:
            return following
        t = following
    return t


@kernel
def crossings(kind, numbers, one, two, table, masks, start, stop):
    """Whether in sight at `start`, and all times at which that changes until `stop`.

    Parameters
    ----------
    kind
        ELEVATION, LIMB, ECLIPSE or HORIZON.
    numbers
        Its parameters: ELEVATION (sine of the mask); LIMB (radius, stretch, scale); ECLIPSE
        (radius, Sun's radius, sign); HORIZON (first row and number of rows in `masks`, largest
        slope, lowest and highest elevation of the profile).
    one, two
        Rows of the movers; the site comes first, or the satellite where the Sun is second.
    table
        States of tabulated movers, shape (rows, 6).
    masks
        Horizon profiles, shape (rows, 2): azimuth and elevation, radians.
    start, stop
        Seconds.
    """
    times = np.empty(32)
    count = 0
    ends = np.empty(80)  # right ends of the intervals not yet settled, the nearest on top
    if kind == HORIZON:
        a = horizon_state(numbers, one, two, table, masks, start)
    else:
        a = sight(kind, numbers, one, two, table, start)
    inside = a[0] >= 0.0
    first_inside = inside
    ta = start
    ends[0] = stop
    top = 0
    while top >= 0:
        tb = ends[top]
        h = tb - ta
        if kind == HORIZON:
            b = horizon_state(numbers, one, two, table, masks, tb)
            settled, single = horizon_clear(numbers, one, two, a, b, h), False
        else:
            b = sight(kind, numbers, one, two, table, tb)
            bound = curvature(kind, numbers, one, two, a, b, h)
            single = abs(a[1] + b[1]) > bound * h
            same = (a[0] >= 0.0) == (b[0] >= 0.0)
            settled = same and min(abs(a[0]), abs(b[0])) > 0.125 * bound * h * h
        if not (settled or single) and h > FINEST:
            top += 1
            ends[top] = ta + 0.5 * h
            continue
        if (b[0] >= 0.0) != inside:
            if count == times.size:
                wider = np.empty(2 * count)
                wider[:count] = times
                times = wider
            if kind == HORIZON:
                times[count] = _halve(numbers, one, two, table, masks, ta, tb, inside)
            else:
                times[count] = refine(kind, numbers, one, two, table, ta, tb, inside)
            count += 1
            inside = not inside
        ta, a = tb, b
        top -= 1
    return first_inside, times[:count]


@kernel
def _halve(numbers, one, two, table, masks, low, high, low_inside):
    """Time of a change of sign of the height over a horizon profile, to `SHARPEST`."""
    while high - low > SHARPEST:
        t = 0.5 * (low + high)
        if (horizon_state(numbers, one, two, table, masks, t)[0] >= 0.0) == low_inside:
            low = t
        else:
            high = t
    return 0.5 * (low + high)


@kernel
def climb(one, two, table, t):
    """Sine of the elevation over a site's level, and its rate."""
    p, q = mover_state(one, table, t), mover_state(two, table, t)
    angle, rate = meridian(one, t)
    ux, uy, uz = up_vector(one, angle)
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    ex, ey, ez = q[3] - p[3], q[4] - p[4], q[5] - p[5]
    apart = math.sqrt(dx * dx + dy * dy + dz * dz)
    sine = (ux * dx + uy * dy + uz * dz) / apart
    sine_rate = (ux * ex + uy * ey + uz * ez + rate * (ux * dy - uy * dx)) / apart
    return sine, sine_rate - sine * (dx * ex + dy * ey + dz * ez) / (apart * apart)


@kernel
def culmination(one, two, table, begin, end, step):
    """Time and elevation (rad) of the highest point over a site between `begin` and `end`.

    The highest of samples `step` apart, then the root of the elevation's rate beside it.
    """
    n = max(math.ceil((end - begin) / step), 2)
    h = (end - begin) / n
    best, highest = 0, -2.0
    for k in range(n + 1):
        sine, _ = climb(one, two, table, begin + k * h)
        if sine > highest:
            best, highest = k, sine
    low, high = begin + max(best - 1, 0) * h, min(begin + min(best + 1, n) * h, end)
    if climb(one, two, table, low)[1] > 0.0 > climb(one, two, table, high)[1]:
        while high - low > SHARPEST:
            t = 0.5 * (low + high)
            if climb(one, two, table, t)[1] > 0.0:
                low = t
            else:
                high = t
        t = 0.5 * (low + high)
    else:
        t = min(begin + best * h, end)
    sine = climb(one, two, table, t)[0]
    return t, math.asin(min(max(sine, -1.0), 1.0))


@kernel
def find_windows(kinds, firsts, seconds, numbers, movers, table, masks, rates, start, stop):
    """Windows of many pairs, one after another.

    Parameters
    ----------
    kinds, firsts, seconds
        Kind of sight and the two movers of each pair, shape (n,).
    numbers
        Parameters of each pair, shape (n, 5), as in `crossings`.
    movers, table, masks
        Rows of all movers, shape (m, WIDTH); their tables and profiles.
    rates
        Angular rate of each mover, rad/s, shape (m,), which sets the step of `culmination`.
    start, stop
        Seconds.

    Returns
    -------
    counts
        Number of windows of each pair, shape (n,).
    windows
        Shape (total, 4): start, end, culmination (s) and its elevation (rad; nan but for sites).
    """
    counts = np.zeros(kinds.size, dtype=np.int64)
    windows = np.empty((64, 4))
    total = 0
    for k in range(kinds.size):
        one, two = movers[firsts[k]], movers[seconds[k]]
        inside, times = crossings(kinds[k], numbers[k], one, two, table, masks, start, stop)
        from_site = kinds[k] == ELEVATION or kinds[k] == HORIZON
        step = 2.0 * math.pi / (STEPS_PER_TURN * (rates[firsts[k]] + rates[seconds[k]]))
        begin = start
        for j in range(times.size + 1):
            end = times[j] if j < times.size else stop
            if inside:
                if total == windows.shape[0]:
                    wider = np.empty((2 * total, 4))
                    wider[:total] = windows
                    windows = wider
                windows[total, 0], windows[total, 1] = begin, end
                windows[total, 2], windows[total, 3] = math.nan, math.nan
                if from_site:
                    t, elevation = culmination(one, two, table, begin, end, step)
                    windows[total, 2], windows[total, 3] = t, elevation
                total += 1
                counts[k] += 1
            begin = end
            inside = not inside
    return counts, windows[:total]

"""The inclination at which a pattern covers with the smallest caps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.certificate import Orbits
from compass.core.jit import kernel
from compass.core.nearest import worst_radius
from compass.core.sort import keep_greatest

#: Witnesses that are kept; then the oldest go.
ROOM = 256

#: What the cosine of a distance to a witness may be off by rounding.
ROUNDING = 1e-12


@kernel
def pattern_radius(
    raan, latitude_argument, inclination, k, start, stop, first, known, tolerance, limit
):
    """Smallest cap radius of a circular pattern at one inclination, and where it is needed.

    The phase stands for time (unit radius, unit rate): `start`, `stop` and `first` are radians;
    the rest as in `worst_radius`.

    Returns
    -------
    least, most, phase, point
        Bracket, infinite above after an early end; when and where `least` is needed; radians.
    """
    n = raan.size
    elements = np.zeros((7, n))
    elements[0] = 1.0
    elements[2] = inclination
    elements[3] = raan
    elements[5] = latitude_argument
    elements[6] = 1.0
    poles = np.empty((n, 3))
    poles[:, 0] = math.sin(inclination) * np.sin(raan)
    poles[:, 1] = -math.sin(inclination) * np.cos(raan)
    poles[:, 2] = math.cos(inclination)
    spin = np.array([poles[:, 0].mean(), poles[:, 1].mean(), poles[:, 2].mean()])
    orbits = Orbits(elements, poles, 1.0)
    least, most, when, point, _ = worst_radius(
        orbits, spin, k, start, stop, first, known, tolerance, limit, 100_000
    )
    return least, most, when, point


class Witnesses(NamedTuple):
    """Places and moments that need large caps, whatever the inclination i.

    ``cosines`` (`ROOM`, 3, n) are A, B, C of the cosine ``A + B cos i + C sin i`` of the distance
    from each to every satellite; ``phases`` (`ROOM`,) the moments; ``many`` (1,) how many there
    have been.
    """

    cosines: NDArray[np.float64]
    phases: NDArray[np.float64]
    many: NDArray[np.int64]


@kernel
def add_witness(witnesses, raan, latitude_argument, phase, point):
    """Add a place, unless it is none, and a moment."""
    if point[0] == 0.0 and point[1] == 0.0 and point[2] == 0.0:
        return
    at = witnesses.many[0] % ROOM
    x, y, z = point
    for s in range(raan.size):
        u = latitude_argument[s] + phase
        node, across = math.cos(raan[s]), math.sin(raan[s])
        witnesses.cosines[at, 0, s] = math.cos(u) * (x * node + y * across)
        witnesses.cosines[at, 1, s] = math.sin(u) * (y * node - x * across)
        witnesses.cosines[at, 2, s] = math.sin(u) * z
    witnesses.phases[at] = phase
    witnesses.many[0] += 1


@kernel
def witnessed(witnesses, low, high, k, enough):
    """Radius that caps need at every inclination in [low, high], and which witness says so.

    Each satellite as near as it comes in that range; the k-th nearest of these. The search ends
    early above `enough`; 0 and -1 without witnesses.
    """
    c_low, s_low, c_high, s_high = math.cos(low), math.sin(low), math.cos(high), math.sin(high)
    best, who, count = 2.0, -1, witnesses.many[0]
    until, nearest = math.cos(min(enough, math.pi)), np.empty(k)
    for back in range(1, min(count, ROOM) + 1):  # the latest first
        at = (count - back) % ROOM
        a, b, c = witnesses.cosines[at]
        nearest[:] = -2.0
        for s in range(a.size):
            near = max(b[s] * c_low + c[s] * s_low, b[s] * c_high + c[s] * s_high)
            if c[s] * c_low > b[s] * s_low and c[s] * c_high < b[s] * s_high:
                near = math.sqrt(b[s] * b[s] + c[s] * c[s])  # it comes nearest in between
            keep_greatest(nearest, a[s] + near)
            if nearest[k - 1] >= best:
                break
        if nearest[k - 1] < best:
            best, who = nearest[k - 1], at
            if best + ROUNDING < until:
                break
    if who < 0:
        return 0.0, who
    return math.acos(min(1.0, max(-1.0, best + ROUNDING))), who


@kernel
def look_at(witnesses, raan, latitude_argument, inclination, k, start, stop, tolerance, limit):
    """`pattern_radius` from what the witnesses know on, to whom where it is needed is added."""
    known, who = witnessed(witnesses, inclination, inclination, k, math.inf)
    first = start if who < 0 else witnesses.phases[who]
    least, most, phase, point = pattern_radius(
        raan, latitude_argument, inclination, k, start, stop, first,
        -1.0 if who < 0 else known, tolerance, limit,
    )  # fmt: skip
    add_witness(witnesses, raan, latitude_argument, phase, point)
    return least, most


@kernel
def best_inclination(raan, latitude_argument, k, start, stop, limit, coarse, fine):
    """Inclination, 0 to pi/2, of the smallest cap radius.

    First branch and bound: places and moments that needed the largest caps at the inclinations
    looked at (`Witnesses`) bound the radius from below at any other; and a satellite moves no
    farther than its inclination changes, so the radius at the middle of a range, less half the
    range, is another bound. Ranges whose bound is above the best value found, or above `limit`,
    are dropped, the rest halved until they are no wider than ``2 coarse``. Then the multiples of
    `fine` about the best one are looked at, the most hopeful first.

    Parameters
    ----------
    raan, latitude_argument
        Of the satellites at phase 0, shape (n,), radians.
    k, start, stop
        Fold; range of phase that decides, radians.
    limit
        Cap radius beyond which a pattern is of no interest, radians.
    coarse, fine
        Radians: the radius found exceeds the least at any inclination by at most ``2 coarse``,
        and is the least of a neighbourhood among multiples of `fine`, which the inclination is.

    Returns
    -------
    inclination, radius
        Radians; infinite radius if the pattern cannot do within `limit`.
    """
    n = raan.size
    witnesses = Witnesses(np.empty((ROOM, 3, n)), np.empty(ROOM), np.zeros(1, np.int64))
    half = math.radians(1.0)
    middles = half * (2.0 * np.arange(45) + 1.0)
    best, best_at = math.inf, 0.0
    while True:
        bounds = np.empty(middles.size)
        # the last ranges compete to 0.001 degree
        tolerance = half / 2.0 if half > coarse else 2e-5
        for c in range(middles.size):
            bounds[c], _ = witnessed(witnesses, middles[c] - half, middles[c] + half, k, math.inf)
        for c in np.argsort(bounds):  # the most hopeful first: what they reach closes others
            enough = min(limit, best)
            low, high = middles[c] - half, middles[c] + half
            if bounds[c] <= enough:
                bounds[c], _ = witnessed(witnesses, low, high, k, enough)
            if bounds[c] > enough:
                continue
            least, most = look_at(
                witnesses, raan, latitude_argument, middles[c], k, start, stop, tolerance,
                enough + half,
            )  # fmt: skip
            told, _ = witnessed(witnesses, low, high, k, math.inf)
            bounds[c] = max(least - half, told)
            if most < best:
                best, best_at = most, middles[c]
        kept = middles[bounds <= min(limit, best)]
        if half <= coarse or kept.size == 0:
            break
        half *= 0.5
        middles = np.empty(2 * kept.size)
        middles[0::2] = kept - half
        middles[1::2] = kept + half
    if kept.size == 0:
        return best_at, math.inf
    return _best_nearby(
        witnesses, raan, latitude_argument, k, start, stop, limit, best_at, 2.0 * half, fine
    )


@kernel
def _best_nearby(witnesses, raan, latitude_argument, k, start, stop, limit, middle, reach, fine):
    """The multiple of `fine` no farther from `middle` than `reach` that needs the smallest caps.

    What the witnesses say of each bounds it from below; the lowest is looked at, which may add a
    witness, until the lowest is one that has been looked at.
    """
    near = round(middle / fine)
    # 90 degrees too, as rounding has them
    first = min(near, math.ceil(max(0.0, middle - reach) / fine - 1e-9))
    last = max(near, math.floor(min(0.5 * math.pi + 1e-9, middle + reach) / fine + 1e-9))
    count = last - first + 1
    bounds, looked = np.empty(count), np.full(count, math.inf)
    for j in range(count):
        bounds[j], _ = witnessed(witnesses, (first + j) * fine, (first + j) * fine, k, math.inf)
    while True:
        at = 0
        for j in range(count):  # of those that are equal the nearest to the middle
            nearer = abs(first + j - near) < abs(first + at - near)
            if bounds[j] < bounds[at] or (bounds[j] == bounds[at] and nearer):
                at = j
        if looked[at] < math.inf:
            return (first + at) * fine, looked[at] if looked[at] <= limit else math.inf
        inclination = (first + at) * fine
        least, most = look_at(
            witnesses, raan, latitude_argument, inclination, k, start, stop, 0.02 * fine,
            looked.min(),
        )  # fmt: skip
        bounds[at], looked[at] = least, most
        for j in range(count):
            if looked[j] == math.inf:
                told, _ = witnessed(witnesses, (first + j) * fine, (first + j) * fine, k, math.inf)
                bounds[j] = max(bounds[j], told)

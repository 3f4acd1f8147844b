"""The inclination at which a pattern covers with the smallest caps."""

import math

import numpy as np

from compass.core.jit import kernel
from compass.core.nearest import worst_radius


@kernel
def pattern_radius(raan, latitude_argument, inclination, k, start, stop, first, tolerance, limit):
    """Smallest cap radius of a circular pattern at one inclination, and where it is needed.

    The phase stands for time (unit radius, unit rate): `start`, `stop` and `first` are radians;
    the rest as in `worst_radius`.

    Returns
    -------
    least, most, phase
        Bracket, infinite above after an early end; when `least` is needed; radians.
    """
    n = raan.size
    orbits = np.zeros((7, n))
    orbits[0] = 1.0
    orbits[2] = inclination
    orbits[3] = raan
    orbits[5] = latitude_argument
    orbits[6] = 1.0
    poles = np.empty((n, 3))
    poles[:, 0] = math.sin(inclination) * np.sin(raan)
    poles[:, 1] = -math.sin(inclination) * np.cos(raan)
    poles[:, 2] = math.cos(inclination)
    spin = np.array([poles[:, 0].mean(), poles[:, 1].mean(), poles[:, 2].mean()])
    least, most, when, _, _ = worst_radius(
        orbits, poles, 1.0, spin, k, start, stop, first, -1.0, tolerance, limit, 100_000
    )
    return least, most, when


@kernel
def best_inclination(raan, latitude_argument, k, start, stop, limit, coarse, fine):
    """Inclination, 0 to pi/2, of the smallest cap radius.

    First branch and bound: a satellite moves no farther than its inclination changes, so the
    radius at the middle of a range of inclinations, less half the range, bounds it there from
    below. Ranges whose bound is above the best value found, or above `limit`, are dropped, the
    rest halved until they are no wider than ``2 coarse``. Then a golden section in the
    neighbourhood of the best one. Each inclination is first looked at in the moment that was the
    worst for the one before: most that fail, fail there.

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
    half = math.radians(1.0)
    middles = half * (2.0 * np.arange(45) + 1.0)
    worst = np.full(45, start)  # the moments to look at first
    best, best_at, best_when = math.inf, 0.0, start
    while True:
        bounds = np.empty(middles.size)
        # the last ranges compete to 0.001 degree
        tolerance = half / 8.0 if half > coarse else 2e-5
        for c in range(middles.size):
            ceiling = min(limit, best) + half
            least, most, worst[c] = pattern_radius(
                raan, latitude_argument, middles[c], k, start, stop, worst[c], tolerance, ceiling
            )
            bounds[c] = least - half
            if most < best:
                best, best_at, best_when = most, middles[c], worst[c]
        order = np.argsort(bounds)  # the most hopeful first: what they reach closes others
        order = order[: np.sum(bounds <= min(limit, best))]
        kept, when = middles[order], worst[order]
        if half <= coarse or kept.size == 0:
            break
        half *= 0.5
        middles, worst = np.empty(2 * kept.size), np.empty(2 * kept.size)
        middles[0::2], worst[0::2] = kept - half, when
        middles[1::2], worst[1::2] = kept + half, when
    if kept.size == 0:
        return best_at, math.inf
    return _golden_section(
        raan,
        latitude_argument,
        k,
        start,
        stop,
        limit,
        max(0.0, best_at - 2.0 * half),
        min(0.5 * math.pi, best_at + 2.0 * half),
        best_when,
        fine,
    )


@kernel
def _golden_section(raan, latitude_argument, k, start, stop, limit, low, high, when, fine):
    """The multiple of `fine` at a local minimum of the cap radius in [low, high].

    Of two inclinations it is enough to know which is the worse: the one looked at last is given
    up once it is worse than the other.
    """
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    tolerance = 0.02 * fine
    left, right = high - golden * (high - low), low + golden * (high - low)
    at_left, _, when = pattern_radius(
        raan, latitude_argument, left, k, start, stop, when, tolerance, math.inf
    )
    at_right, _, when = pattern_radius(
        raan, latitude_argument, right, k, start, stop, when, tolerance, at_left
    )
    while high - low > fine:
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - golden * (high - low)
            at_left, _, when = pattern_radius(
                raan, latitude_argument, left, k, start, stop, when, tolerance, at_right
            )
        else:
            low, left, at_left = left, right, at_right
            right = low + golden * (high - low)
            at_right, _, when = pattern_radius(
                raan, latitude_argument, right, k, start, stop, when, tolerance, at_left
            )
    middle = round(0.5 * (low + high) / fine)
    inclination, radius = 0.0, math.inf
    for step in (middle, middle - 1, middle + 1):
        if 0.0 <= step * fine < 0.5 * math.pi + 1e-9:  # 90 degrees too, as rounding has them
            _, most, when = pattern_radius(
                raan, latitude_argument, step * fine, k, start, stop, when, tolerance, radius
            )
            if most < radius:
                inclination, radius = step * fine, most
    return inclination, radius if radius <= limit else math.inf

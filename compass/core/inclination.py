"""The inclination at which a pattern covers with the smallest caps."""

import math

import numpy as np

from compass.core.jit import kernel
from compass.core.nearest import worst_radius


@kernel
def pattern_radius(raan, latitude_argument, inclination, k, start, stop, tolerance, limit):
    """Smallest cap radius of a circular pattern at one inclination: bracket, radians.

    The phase stands for time (unit radius, unit rate): `start` and `stop` are radians; the rest
    as in `worst_radius`.
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
    least, most, _, _, _ = worst_radius(
        orbits, poles, 1.0, spin, k, start, stop, -1.0, tolerance, limit, 100_000
    )
    return least, most


@kernel
def best_inclination(raan, latitude_argument, k, start, stop, limit, coarse, fine):
    """Inclination, 0 to pi/2, of the smallest cap radius.

    First branch and bound: a satellite moves no farther than its inclination changes, so the
    radius at the middle of a range of inclinations, less half the range, bounds it there from
    below. Ranges whose bound is above the best value found, or above `limit`, are dropped, the
    rest halved until they are no wider than ``2 coarse``. Then a golden section in the
    neighbourhood of the best one.

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
        and lies at a local minimum to `fine` in inclination.

    Returns
    -------
    inclination, radius
        Radians; infinite radius if the pattern cannot do within `limit`.
    """
    half = math.radians(0.5)
    middles = half * (2.0 * np.arange(90) + 1.0)
    best, best_at = math.inf, 0.0
    while True:
        bounds = np.empty(middles.size)
        # the last ranges compete to 0.001 degree
        tolerance = half / 8.0 if half > coarse else 2e-5
        for c in range(middles.size):
            ceiling = min(limit, best) + half
            least, most = pattern_radius(
                raan, latitude_argument, middles[c], k, start, stop, tolerance, ceiling
            )
            bounds[c] = least - half
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
    low, high = max(0.0, best_at - 2.0 * half), min(0.5 * math.pi, best_at + 2.0 * half)
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    left, right = high - golden * (high - low), low + golden * (high - low)
    at_left, _ = pattern_radius(
        raan, latitude_argument, left, k, start, stop, 0.02 * fine, math.inf
    )
    at_right, _ = pattern_radius(
        raan, latitude_argument, right, k, start, stop, 0.02 * fine, math.inf
    )
    while high - low > fine:
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - golden * (high - low)
            at_left, _ = pattern_radius(
                raan, latitude_argument, left, k, start, stop, 0.02 * fine, math.inf
            )
        else:
            low, left, at_left = left, right, at_right
            right = low + golden * (high - low)
            at_right, _ = pattern_radius(
                raan, latitude_argument, right, k, start, stop, 0.02 * fine, math.inf
            )
    inclination = 0.5 * (low + high)
    least, most = pattern_radius(
        raan, latitude_argument, inclination, k, start, stop, 0.02 * fine, math.inf
    )
    if most > limit:
        return inclination, math.inf
    return inclination, most

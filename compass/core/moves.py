"""Which moves of a whole constellation set every satellite in the place of another."""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def _apart(a, b):
    """Distance of two angles on the circle, radians; both lie in [0, 2 pi)."""
    d = abs(a - b)
    return min(d, 2 * math.pi - d)


@kernel
def _first_not_below(ascending, value):
    """Index of the first of ascending numbers that is not below a value; their count if none."""
    low, high = 0, ascending.shape[0]
    while low < high:
        middle = (low + high) // 2
        if ascending[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def _nearest_within(place, lead, order, moved, axis, tolerance, free):
    """The free satellite nearest to a place and how far off, radians; -1 if none is near enough.

    Only satellites whose leading angle lies within the tolerance are looked at: in one stretch of
    the ascending ones, or where the circle closes in two.
    """
    best, least = -1, tolerance
    for turn in (-1, 0, 1):
        centre = moved[axis] + turn * 2 * math.pi
        at = _first_not_below(lead, centre - tolerance)
        while at < lead.shape[0] and lead[at] <= centre + tolerance:
            s = order[at]
            miss = _apart(place[s, 0], moved[0]) + _apart(place[s, 1], moved[1])
            miss += abs(place[s, 2] - moved[2])
            if free[s] and (miss < least or (miss == least and best < 0)):
                best, least = s, miss
            at += 1
    return best, least


@kernel
def verified_moves(place, order, axis, tried, sign, tolerance, image):
    """How far each tried move misses, radians; infinite of one that is none.

    It is none if it sets a satellite where none is within the tolerance that no other took before:
    of satellites that share a place each stands in for one.

    Parameters
    ----------
    place
        Node and argument of latitude, in [0, 2 pi), and inclination, radians, shape (n, 3).
    order
        Satellites by ascending ``place[:, axis]``, shape (n,).
    tried
        Turn, phase and 0 of each move, radians, shape (m, 3): it sets satellite s to
        ``tried + (sign, sign, 1) place[s]``.
    image
        Receives the satellite in whose place satellite s comes to stand, shape (m, n).
    """
    n, m = place.shape[0], tried.shape[0]
    lead = place[order, axis]
    worst = np.zeros(m)
    moved = np.empty(3)
    free = np.empty(n, dtype=np.bool_)
    for j in range(m):
        free[:] = True
        for s in range(n):
            for k in range(2):
                moved[k] = (tried[j, k] + sign * place[s, k]) % (2 * math.pi)
                if moved[k] >= 2 * math.pi:  # the remainder of -1e-17 is 2 pi
                    moved[k] = 0.0
            moved[2] = tried[j, 2] + place[s, 2]
            there, miss = _nearest_within(place, lead, order, moved, axis, tolerance, free)
            if there < 0:
                worst[j] = math.inf
                break
            free[there] = False
            image[j, s] = there
            worst[j] = max(worst[j], miss)
    return worst

"""Many patterns screened in one call: the caps each needs for continuous coverage, exactly."""

import math

import numpy as np

from compass.core.inclination import pattern_radius
from compass.core.jit import kernel


@kernel
def pattern_angles(star, satellites, planes, phasing):
    """Nodes and arguments of latitude of a Walker pattern, radians, shapes (satellites,).

    Plane k has its node at ``2 pi k/p`` (star: ``pi k/p``); its satellite j is at
    ``2 pi j p/t + 2 pi f k/t``.
    """
    raan, latitude_argument = np.empty(satellites), np.empty(satellites)
    per_plane = satellites // planes
    spread = math.pi if star else 2.0 * math.pi
    for k in range(planes):
        for j in range(per_plane):
            s = k * per_plane + j
            raan[s] = k * spread / planes
            turns = j / per_plane + phasing * k / satellites
            latitude_argument[s] = 2.0 * math.pi * (turns - math.floor(turns))
    return raan, latitude_argument


@kernel
def deciding_phases(star, satellites, planes, phasing):
    """First and last phase, radians, between which a pattern shows all it ever shows.

    Turned, delayed, run backwards or seen in the centre the pattern is itself again; see
    `compass.coverage.symmetry`, of which this is the twin for patterns alone.
    """
    steps = satellites // planes if star else satellites // math.gcd(planes, phasing)
    parts = steps if steps % 2 == 0 else 2 * steps
    first = 0.0
    if star:
        first = -phasing * (planes - 1) / (2.0 * satellites)
        first -= math.floor(first * parts) / parts
    return 2.0 * math.pi * first, 2.0 * math.pi * (first + 0.5 / parts)


@kernel
def circles(raan, latitude_argument, inclination, p, q):
    """Unit vectors P and Q, shape (n, 3): satellites are at ``P cos x + Q sin x`` at phase x."""
    ci, si = math.cos(inclination), math.sin(inclination)
    for s in range(raan.size):
        co, so = math.cos(raan[s]), math.sin(raan[s])
        cu, su = math.cos(latitude_argument[s]), math.sin(latitude_argument[s])
        p[s, 0], p[s, 1], p[s, 2] = co * cu - so * ci * su, so * cu + co * ci * su, si * su
        q[s, 0], q[s, 1], q[s, 2] = -so * ci * cu - co * su, co * ci * cu - so * su, si * cu


@kernel
def closest_pair(raan, latitude_argument, inclination):
    """Least angle between two satellites of equal circular orbits at any time, radians.

    With ``u = P cos x + Q sin x`` the cosine of the angle between two of them is
    ``(P.P' + Q.Q')/2 + (P.P' - Q.Q')/2 cos 2x + (P.Q' + Q.P')/2 sin 2x``; pi for one alone.
    """
    n = raan.size
    p, q = np.empty((n, 3)), np.empty((n, 3))
    circles(raan, latitude_argument, inclination, p, q)
    nearest = -1.0
    for a in range(n):
        for b in range(a + 1, n):
            pp = p[a, 0] * p[b, 0] + p[a, 1] * p[b, 1] + p[a, 2] * p[b, 2]
            qq = q[a, 0] * q[b, 0] + q[a, 1] * q[b, 1] + q[a, 2] * q[b, 2]
            pq = p[a, 0] * q[b, 0] + p[a, 1] * q[b, 1] + p[a, 2] * q[b, 2]
            qp = q[a, 0] * p[b, 0] + q[a, 1] * p[b, 1] + q[a, 2] * p[b, 2]
            nearest = max(nearest, 0.5 * (pp + qq) + math.hypot(0.5 * (pp - qq), 0.5 * (pq + qp)))
    return math.acos(min(1.0, max(-1.0, nearest)))


@kernel
def screen_patterns(patterns, cap, fold, reject, tolerance, fine, least, most, closest):
    """Bracket the cap radius that each of m patterns needs for continuous `fold`-fold coverage.

    First to `tolerance`; where `cap` lies inside that bracket, again to `fine`. With `reject`
    the search for a pattern ends at the first moment that refutes `cap`.

    Parameters
    ----------
    patterns
        m `compass.core.patterns.Patterns`.
    cap
        Cap radius that each has, radians, shape (m,); 0 or less where there is none.
    fold
        Satellites to be in view at once.
    reject
        Whether patterns that fail need no margin.
    tolerance, fine
        Radians.
    least, most
        Take the brackets, radians, shape (m,): with less than `least` coverage is not
        continuous (somewhere, some time), with `most` it is. `most` is infinite after an early
        end, both are with fewer satellites than `fold`.
    closest
        Takes the least angle between two satellites at any time, radians, shape (m,).
    """
    star, satellites, planes, phasing, inclination = patterns
    for m in range(satellites.size):
        raan, u = pattern_angles(star[m], satellites[m], planes[m], phasing[m])
        start, stop = deciding_phases(star[m], satellites[m], planes[m], phasing[m])
        limit = cap[m] if reject else math.inf
        low, high, when, _ = pattern_radius(
            raan, u, inclination[m], fold, start, stop, start, -1.0, tolerance, limit
        )
        if low <= cap[m] < high and math.isfinite(high):
            low, high, _, _ = pattern_radius(
                raan, u, inclination[m], fold, start, stop, when, -1.0, fine, limit
            )
        least[m], most[m] = low, high
        closest[m] = closest_pair(raan, u, inclination[m])

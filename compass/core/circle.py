"""Least fold over a circle of latitude, for all time: boxes of longitude and phase, halved.

All orbits have one period, and the planet turns at a rate of its own: the user's longitude (seen
from the node of the elements) and the satellites' phase then take every pair of values, or come
as near to it as one likes. On a box of half-widths hl and ht about such a pair, seen from the user,
a satellite strays from where it stands at the centre by at most
``s = a sqrt((1 + e)/(1 - e)) ht + a (1 + e) hl`` (its fastest pace by mean anomaly, and its
farthest distance), so its direction turns by at most ``delta = asin(s/d)``, d its distance, its
elevation as much, and its azimuth by at most ``asin(sin delta / cos elevation)``. What stands
above the highest point of the profile in that range of azimuths is seen throughout the box.
A box whose centre sees too few refutes the claim.

Directions are good to 1e-13 rad for phases of a revolution; `SLACK` covers that many times over.
"""

import math

import numpy as np

from compass.core.jit import kernel
from compass.core.kepler import eccentric_anomaly

PROVEN, REFUTED, UNDECIDED = 0, 1, 2

#: Radians by which every comparison is made on the safe side.
SLACK = 1e-11

#: Deepest that boxes are halved: far below the smallest that can matter.
DEEPEST = 120


@kernel
def fold_on_circle(orbits, eye, east_north_up, azimuths, elevations, lift, k, span, smallest, most):
    """Whether k satellites stand above a horizon at every longitude and phase.

    Parameters
    ----------
    orbits
        Rows a, e, i, RAAN, argument of periapsis, mean anomaly; shape (6, n), metres and radians.
    eye, east_north_up
        The user at longitude 0 (metres, shape (3,)) and his axes as rows, shape (3, 3).
    azimuths, elevations
        Profile of the horizon: increasing azimuths in [0, 2 pi) and elevations, shape (m,), rad.
    lift
        Added to every elevation of the profile, rad.
    k
        Satellites wanted.
    span
        Phases to look at, from 0, rad.
    smallest
        Boxes no wider than this stay undecided, rad.
    most
        Boxes to look at before giving up.

    Returns
    -------
    outcome, longitude, phase, boxes
        PROVEN, REFUTED at that place and phase (rad), or UNDECIDED there.
    """
    stack = np.empty((DEEPEST, 4))
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = math.pi, 0.5 * span, math.pi, 0.5 * span
    depth, boxes = 1, 0
    undecided_l, undecided_t = math.nan, math.nan
    low, high = elevations.min() + lift, elevations.max() + lift
    while depth > 0:
        depth -= 1
        longitude, phase = stack[depth, 0], stack[depth, 1]
        wide, long = stack[depth, 2], stack[depth, 3]
        boxes += 1
        sure, seen = _counts(
            orbits, eye, east_north_up, azimuths, elevations, lift, low, high, stack[depth]
        )
        if seen < k:
            return REFUTED, longitude, phase, boxes
        if sure >= k:
            continue
        if boxes >= most:
            return UNDECIDED, longitude, phase, boxes
        if max(wide, long) <= 0.5 * smallest or depth + 2 > DEEPEST:
            undecided_l, undecided_t = longitude, phase
            continue
        # halve the longer side
        across = wide >= long
        for side in (-0.5, 0.5):
            stack[depth, 0] = longitude + side * wide if across else longitude
            stack[depth, 1] = phase if across else phase + side * long
            stack[depth, 2] = 0.5 * wide if across else wide
            stack[depth, 3] = long if across else 0.5 * long
            depth += 1
    outcome = PROVEN if math.isnan(undecided_l) else UNDECIDED
    return outcome, undecided_l, undecided_t, boxes


@kernel
def _counts(orbits, eye, east_north_up, azimuths, elevations, lift, low, high, box):
    """Satellites seen surely in all of a box (centre, half-widths), and seen at its centre."""
    sure, seen = 0, 0
    turned_c, turned_s = math.cos(box[0]), math.sin(box[0])
    for s in range(orbits.shape[1]):
        x, y, z = _position(orbits, s, box[1])
        # turned to the longitude of the user, who stays at 0
        dx = turned_c * x + turned_s * y - eye[0]
        dy = turned_c * y - turned_s * x - eye[1]
        dz = z - eye[2]
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        up = east_north_up[2, 0] * dx + east_north_up[2, 1] * dy + east_north_up[2, 2] * dz
        elevation = math.asin(min(max(up / distance, -1.0), 1.0))
        a, e = orbits[0, s], orbits[1, s]
        strays = a * math.sqrt((1.0 + e) / (1.0 - e)) * box[3] + a * (1.0 + e) * box[2]
        delta = math.pi if strays >= distance else math.asin(strays / distance) + SLACK
        if elevation + SLACK < low:
            continue
        if elevation - delta >= high:
            sure += 1
            seen += 1
            continue
        east = east_north_up[0, 0] * dx + east_north_up[0, 1] * dy + east_north_up[0, 2] * dz
        north = east_north_up[1, 0] * dx + east_north_up[1, 1] * dy + east_north_up[1, 2] * dz
        azimuth = math.atan2(east, north)
        here, _ = profile_range(azimuths, elevations, azimuth, 0.0)
        seen += 1 if elevation + SLACK >= here + lift else 0
        level = math.cos(elevation)
        far = delta >= 0.5 * math.pi or math.sin(delta) >= level
        turn = math.pi if far else math.asin(math.sin(delta) / level) + SLACK
        _, top = profile_range(azimuths, elevations, azimuth, turn)
        sure += 1 if elevation - delta >= top + lift else 0
    return sure, seen


@kernel
def _position(orbits, s, phase):
    """Inertial position of satellite s when its mean anomaly has grown by a phase."""
    a, e = orbits[0, s], orbits[1, s]
    anomaly = eccentric_anomaly(orbits[5, s] + phase, e)
    p, q = a * (math.cos(anomaly) - e), a * math.sqrt(1.0 - e * e) * math.sin(anomaly)
    cw, sw = math.cos(orbits[4, s]), math.sin(orbits[4, s])
    u, v = cw * p - sw * q, sw * p + cw * q
    co, so = math.cos(orbits[3, s]), math.sin(orbits[3, s])
    ci, si = math.cos(orbits[2, s]), math.sin(orbits[2, s])
    return co * u - so * ci * v, so * u + co * ci * v, si * v


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

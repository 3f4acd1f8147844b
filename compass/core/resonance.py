"""The slow pushes of a field along circular orbits, and what they cost a pattern to resist.

Over a circle the push along the track is a double series in the argument of latitude u and the
Mars-fixed longitude of the node: ``sum 2 |A_km| cos(k u + m node + arg A_km)``. Its term turns at
``nu = k u' + m node'``, and swings a satellite by ``6 |A_km| / (a nu^2)`` along its track
(``u'' = -3 a_t / a``): little where nu is fast, without end where it is nought, in resonance.
"""

import math

from compass.core.gravity import field_acceleration
from compass.core.jit import fast_kernel, kernel
from compass.core.screen import pattern_angles


@fast_kernel
def along_track(radius, inclination, terms, highest, reference, scale, out):
    """Fill `out` (u, node), shape (n, n), with the push along the track of a circle, m/s^2.

    Parameters
    ----------
    radius, inclination
        m and radians.
    terms, highest, reference, scale
        As `compass.core.gravity.field_acceleration` takes the field.
    out
        Both angles in n equal steps of a turn.
    """
    n = out.shape[0]
    ci, si = math.cos(inclination), math.sin(inclination)
    for i in range(n):
        cu, su = math.cos(2.0 * math.pi * i / n), math.sin(2.0 * math.pi * i / n)
        for j in range(n):
            cn, sn = math.cos(2.0 * math.pi * j / n), math.sin(2.0 * math.pi * j / n)
            px, py, pz = cn * cu - sn * su * ci, sn * cu + cn * su * ci, su * si
            tx, ty, tz = -cn * su - sn * cu * ci, -sn * su + cn * cu * ci, cu * si
            ax, ay, az = field_acceleration(
                radius * px, radius * py, radius * pz, terms, highest, reference, scale
            )
            out[i, j] = ax * tx + ay * ty + az * tz


@kernel
def push_on_patterns(patterns, group, meridian, boxes, swings, waves, pushes, largest):
    """Largest push along the track that a satellite of each pattern must resist, m/s^2.

    Terms are dropped, the strongest first, until what is left swings no satellite by more than
    its box; those dropped are what is to be resisted.

    Parameters
    ----------
    patterns
        m `compass.core.patterns.Patterns`.
    group
        Row of `swings`, `waves` and `pushes` of each, shape (m,).
    meridian
        Angle of the field's x axis at the epoch, radians.
    boxes
        Half width of each pattern's slots along the track, radians; nan where there is none.
    swings
        Of the terms of each group, radians, the largest first, shape (g, w).
    waves, pushes
        k and m of the terms, shape (g, w, 2); twice their complex amplitudes as two real numbers.
    largest
        Takes the result, shape (m,).
    """
    star, satellites, planes, phasing, _ = patterns
    for p in range(satellites.size):
        if not boxes[p] > 0.0:
            largest[p] = math.nan
            continue
        row = swings[group[p]]
        left = row.sum()
        count = 0
        while count < row.size and left > boxes[p]:
            left -= row[count]
            count += 1
        raan, u = pattern_angles(star[p], satellites[p], planes[p], phasing[p])
        worst = 0.0
        for s in range(raan.size):
            total = 0.0
            for w in range(count):
                wave, push = waves[group[p], w], pushes[group[p], w]
                angle = wave[0] * u[s] + wave[1] * (raan[s] - meridian)
                total += push[0] * math.cos(angle) - push[1] * math.sin(angle)
            worst = max(worst, abs(total))
        largest[p] = worst

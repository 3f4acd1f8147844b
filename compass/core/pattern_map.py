"""Many patterns mapped in one call: dilution of precision and counts over area and time."""

import math

import numpy as np

from compass.core.gdop import dops_over
from compass.core.jit import kernel
from compass.core.ranking import nearest_rank, select
from compass.core.screen import circles, deciding_phases, pattern_angles

#: What the columns of its merits are, in order.
FIGURES = ("gdop_p50", "gdop_p95", "gdop_p95_zone", "pdop_p95", "availability", "count_mean")


@kernel
def map_patterns(patterns, radius, sin_mask, epochs, area, zones, columns, pdop_max, merits):
    """Figures of geometry of m patterns over the whole sphere and the phases that decide.

    Parameters
    ----------
    patterns
        m `compass.core.patterns.Patterns`.
    radius
        Of the orbits, in radii of the sphere, shape (m,).
    sin_mask
        Sine of the elevation mask of each, shape (m,).
    epochs
        Moments, evenly spread over `deciding_phases`.
    area
        Unit vectors to places that stand for equal areas, shape (q, 3).
    zones, columns
        Unit vectors to places in rows of latitude from pole to pole, shape (rows * columns, 3),
        and how many there are in a row.
    pdop_max
        Largest PDOP that counts as available.
    merits
        Takes `FIGURES`, shape (m, 6): GDOP not exceeded at 50 and at 95 of 100 places and
        moments, and at 95 of 100 in the zone of latitude where that is worst; PDOP at 95; share
        with PDOP at most `pdop_max`; mean number in view, exact. Percentiles are values that
        occur; inf counts.
    """
    star, satellites, planes, phasing, inclination = patterns
    fold = np.empty((epochs, area.shape[0]), np.int64)
    gdop, pdop = np.empty((epochs, area.shape[0])), np.empty((epochs, area.shape[0]))
    zone_fold = np.empty((epochs, zones.shape[0]), np.int64)
    zone_gdop, zone_pdop = np.empty((epochs, zones.shape[0])), np.empty((epochs, zones.shape[0]))
    half, most = nearest_rank(gdop.size, 50), nearest_rank(gdop.size, 95)
    for m in range(satellites.size):
        n = satellites[m]
        raan, u = pattern_angles(star[m], n, planes[m], phasing[m])
        first, last = deciding_phases(star[m], n, planes[m], phasing[m])
        p, q, r = np.empty((n, 3)), np.empty((n, 3)), np.empty((epochs, n, 3))
        circles(raan, u, inclination[m], p, q)
        for k in range(epochs):
            phase = first + (last - first) * (k + 0.5) / epochs
            c, s = radius[m] * math.cos(phase), radius[m] * math.sin(phase)
            for i in range(n):
                for axis in range(3):
                    r[k, i, axis] = c * p[i, axis] + s * q[i, axis]
        dops_over(r, area, 1.0, sin_mask[m], fold, gdop, pdop)
        dops_over(r, zones, 1.0, sin_mask[m], zone_fold, zone_gdop, zone_pdop)
        values = gdop.ravel()
        merits[m, 0] = select(values, half)
        merits[m, 1] = select(values[half:], most - half)  # the rest is smaller
        merits[m, 2] = worst_zone(zone_gdop, columns)
        merits[m, 4] = (pdop.size - count_above(pdop.ravel(), pdop_max)) / pdop.size
        merits[m, 3] = select(pdop.ravel(), most)
        # as many as there are, each over the part of the sphere that its cap has
        cap = math.acos(math.sqrt(1.0 - sin_mask[m] ** 2) / radius[m]) - math.asin(sin_mask[m])
        merits[m, 5] = n * 0.5 * (1.0 - math.cos(cap))


@kernel
def worst_zone(values, columns):
    """Largest 95th percentile of a zone of latitude, north and south together.

    Where it is seen in the centre or run backwards, a pattern has north and south exchanged: in
    the time that decides only both together show all there is.

    Parameters
    ----------
    values
        At every moment in rows from pole to pole, shape (t, rows * columns).
    columns
        Places in a row.
    """
    moments, places = values.shape
    zone = np.empty((moments, 2, columns))
    rank = nearest_rank(zone.size, 95)
    worst = 0.0
    for row in range((places // columns + 1) // 2):
        south, north = row * columns, places - (row + 1) * columns
        for t in range(moments):
            for c in range(columns):
                zone[t, 0, c], zone[t, 1, c] = values[t, south + c], values[t, north + c]
        # most zones are not the worst: then too few of their values are larger
        if count_above(zone.ravel(), worst) >= zone.size - rank:
            worst = select(zone.ravel(), rank)
    return worst


@kernel
def count_above(values, limit):
    """How many values are larger than a limit."""
    count = 0
    for value in values:
        count += value > limit
    return count

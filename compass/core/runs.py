"""Which cells of a latitude row see a satellite, as runs of neighbouring columns.

A row has m equally spaced columns, the first at longitude ``lon0``, going once around. A run
``[first, stop)`` may have ``stop > m``: it goes on at column 0.
"""

import math

from compass.core.jit import kernel

TWO_PI = 2.0 * math.pi

#: Below this reach rounding (1e-16 / reach, under a square root) could move an end of the interval
#: by more than a column of 0.05 degree.
FLAT = 1e-8


@kernel
def cap_run(ux, uy, uz, out, longitude, cos_cap, sin_lat, cos_lat, cos_lon, sin_lon, lon0):
    """Columns inside a cap: none, all, or one run.

    A column is inside if ``u . p >= cos(lambda)``. On a row this is an interval of longitude
    about the satellite's, of half-width ``acos((cos lambda - u_z sin lat) / (|u_xy| cos lat))``;
    its two ends are settled by the inequality itself, so the run is equal to testing every
    column. Where u . p changes by less than 1e-8 along the row (a satellite or the row at a pole)
    the row is taken whole or not at all.

    Parameters
    ----------
    ux, uy, uz
        Unit vector to the satellite.
    out, longitude
        Its distance ``|u_xy|`` from the axis and its longitude.
    cos_cap
        Cosine of the cap's radius.
    sin_lat, cos_lat
        Of the row.
    cos_lon, sin_lon
        Of the columns, shape (m,).
    lon0
        Longitude of column 0, radians.

    Returns
    -------
    first, stop
        The run; (0, 0) if it is empty.
    """
    m = cos_lon.size
    offset = cos_cap - uz * sin_lat
    reach = out * cos_lat
    if offset > reach + 1e-14:
        return 0, 0
    if offset < -reach - 1e-14 or (reach < FLAT and offset <= 0.0):
        return 0, m
    if reach < FLAT:
        return 0, 0
    half = math.acos(min(max(offset / reach, -1.0), 1.0))
    step = TWO_PI / m
    centre = (longitude - lon0) / step
    first = int(math.ceil(centre - half / step))
    last = int(math.floor(centre + half / step))
    # With reach >= 1e-8 the ends are good to 2e-4 rad, less than a column: at most one column
    # to settle on either side.
    first -= 1
    while first <= last and not _inside(
        ux, uy, uz, cos_cap, sin_lat, cos_lat, cos_lon, sin_lon, first
    ):
        first += 1
    last += 1
    while last >= first and not _inside(
        ux, uy, uz, cos_cap, sin_lat, cos_lat, cos_lon, sin_lon, last
    ):
        last -= 1
    if last < first:
        return 0, 0
    if first < 0:
        first, last = first + m, last + m
    return first, first + min(last - first + 1, m)


@kernel
def _inside(ux, uy, uz, cos_cap, sin_lat, cos_lat, cos_lon, sin_lon, column):
    m = cos_lon.size
    k = column + m if column < 0 else (column - m if column >= m else column)
    return (ux * cos_lon[k] + uy * sin_lon[k]) * cos_lat + uz * sin_lat >= cos_cap


@kernel
def horizon_runs(rx, ry, rz, sin_lat, cos_lat, cos_lon, sin_lon, azimuths, elevations, runs):
    """Columns that see a satellite above an azimuth-dependent mask; every column is tested.

    Parameters
    ----------
    rx, ry, rz
        Satellite position in units of the sphere's radius.
    sin_lat, cos_lat, cos_lon, sin_lon
        Of the row and of its columns.
    azimuths, elevations
        The mask, radians; clockwise from north, increasing, linear between, periodic.
    runs
        Filled with (first, stop), shape (k, 2) with k at least m/2 + 1.

    Returns
    -------
    int
        Number of runs.
    """
    m = cos_lon.size
    found = 0
    previous = False
    for k in range(m):
        out = rx * cos_lon[k] + ry * sin_lon[k]  # away from the axis, at this longitude
        east = ry * cos_lon[k] - rx * sin_lon[k]
        north = rz * cos_lat - out * sin_lat
        up = out * cos_lat + rz * sin_lat - 1.0
        elevation = math.atan2(up, math.sqrt(east * east + north * north))
        seen = elevation >= mask_at(math.atan2(east, north), azimuths, elevations)
        if seen and not previous:
            runs[found, 0] = k
            found += 1
        if seen:
            runs[found - 1, 1] = k + 1
        previous = seen
    return found


@kernel
def mask_at(azimuth, azimuths, elevations):
    """Mask elevation at an azimuth in (-2 pi, 2 pi), by periodic linear interpolation."""
    n = azimuths.size
    a = azimuth if azimuth >= 0.0 else azimuth + TWO_PI
    k = 0
    while k < n and azimuths[k] <= a:
        k += 1
    left, right = (k - 1) % n, k % n
    gap = azimuths[right] - azimuths[left]
    if gap <= 0.0:
        gap += TWO_PI
    ahead = a - azimuths[left]
    if ahead < 0.0:
        ahead += TWO_PI
    return elevations[left] + (elevations[right] - elevations[left]) * ahead / gap

"""Which cells of a latitude row see a satellite, as runs of neighbouring columns.

A row has m equally spaced columns, the first at longitude ``lon0``, going once around. A run
``[first, stop)`` may have ``stop > m``: it goes on at column 0.

How a user stands in a row is the same in each column but for the turn about the axis. Five numbers
say it, lengths in units of the equatorial radius: cosine and sine of the latitude of the user's up,
distance from the axis and height over the equator of the user's place, and the square of its
distance from the centre. On the ground of a sphere the first four are twice the same two.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import kernel

Array = NDArray[np.float64]

TWO_PI = 2.0 * math.pi

#: What an array that describes a row holds.
UP_OUT, UP_Z, OUT, HIGH, SQUARE = range(5)

#: Cosine of the half angle of antennas that reach all around.
ALL_AROUND = -1.0

#: Below this reach rounding (1e-16 / reach, under a square root) could move an end of the interval
#: by more than a column of 0.05 degree.
FLAT = 1e-8


class Row(NamedTuple):
    """The users of one latitude row, and the mask about each of them.

    `azimuths`, `elevations`: the mask, radians; constant with one azimuth. `place` (5,): how a user
    stands in the row. `cos_lon`, `sin_lon` (m,) of the columns; `lon0`: longitude of column 0.
    `cos_beam`: cosine of the half angle of the satellites' antennas about the way down, or
    `ALL_AROUND`.
    """

    azimuths: Array
    elevations: Array
    place: Array
    cos_lon: Array
    sin_lon: Array
    lon0: float
    cos_beam: float


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
def is_one_run(row):
    """Whether the columns that see a satellite are one run: over a level horizon, in no beam."""
    return row.azimuths.size == 1 and row.elevations[0] >= 0.0 and row.cos_beam <= ALL_AROUND


@kernel
def most_runs(satellites, row):
    """Runs that the columns of a row which see satellites may make, of all of them together."""
    return satellites if is_one_run(row) else satellites * (row.cos_lon.size // 2 + 1)


@kernel
def sight_runs(rx, ry, rz, cos_cap, row, runs):
    """Columns of a row that see a satellite above the mask, in its beam.

    Parameters
    ----------
    rx, ry, rz
        Satellite position in units of the equatorial radius.
    cos_cap
        Cosine of the cap's radius, which a constant mask and the ground of a sphere have.
    row
        Its users, see `Row`.
    runs
        Filled with (first, stop), shape (k, 2): k at least 1, m/2 + 1 unless `is_one_run`.

    Returns
    -------
    int
        Number of runs.
    """
    place, cos_lon, sin_lon, lon0 = row.place, row.cos_lon, row.sin_lon, row.lon0
    if not is_one_run(row):
        return horizon_runs(rx, ry, rz, row, runs)
    away, longitude = math.sqrt(rx * rx + ry * ry), math.atan2(ry, rx)
    w = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz)
    if place[UP_OUT] == place[OUT] and place[UP_Z] == place[HIGH]:
        runs[0, 0], runs[0, 1] = cap_run(
            rx * w, ry * w, rz * w, away * w, longitude, cos_cap,
            place[UP_Z], place[UP_OUT], cos_lon, sin_lon, lon0,
        )  # fmt: skip
        return 1
    least = least_out(away * away + rz * rz, rz, math.sin(row.elevations[0]), place)
    runs[0, 0], runs[0, 1] = cap_run(
        rx * w, ry * w, 0.0, away * w, longitude, least * w, 0.0, 1.0, cos_lon, sin_lon, lon0
    )
    return 1


@kernel
def least_out(square, rz, sin_mask, row):
    """How far from the axis, along a user's meridian, a satellite must be to stand at the mask.

    With the user's place p and up n, and o the component of r in the direction of the meridian,
    the height over the horizon ``t = (r - p) . n`` grows with o and the distance
    ``d^2 = r^2 + p^2 - 2 r_z p_z - 2 p_o o`` falls: seen is ``t >= sin(mask) d``, from one o on.
    There ``t^2 + 2 k t = sin^2(mask) d_0^2`` with ``k = sin^2(mask) p_o/n_o`` and d_0 the distance
    at t = 0. Infinite if no o will do.

    Parameters
    ----------
    square, rz
        Square of the satellite's distance from the centre; its height over the equator.
    sin_mask
        Sine of the mask, not below 0.
    row
        How a user stands in it, shape (5,), away from the poles.
    """
    slant = row[OUT] / row[UP_OUT]
    level = rz * row[UP_Z] - (row[OUT] * row[UP_OUT] + row[HIGH] * row[UP_Z])
    apart = square + row[SQUARE] - 2.0 * rz * row[HIGH] + 2.0 * slant * level
    k, right = sin_mask * sin_mask * slant, sin_mask * sin_mask * apart
    if right < 0.0:
        return math.inf
    height = right / (k + math.sqrt(k * k + right)) if right > 0.0 else 0.0
    return (height - level) / row[UP_OUT]


@kernel
def horizon_runs(rx, ry, rz, row, runs):
    """Columns that see a satellite above any mask, in its beam; every column is tested.

    Parameters
    ----------
    rx, ry, rz
        Satellite position in units of the equatorial radius.
    row
        Its users. The mask is clockwise from north, increasing, linear between, periodic; below 0
        for users who look down, not below the limb: Mars hides no one who stands above it.
    runs
        Filled with (first, stop), shape (k, 2) with k at least m/2 + 1.

    Returns
    -------
    int
        Number of runs.
    """
    place, cos_lon, sin_lon = row.place, row.cos_lon, row.sin_lon
    m = cos_lon.size
    total = 0
    previous = False
    up_out, up_z, high = place[UP_OUT], place[UP_Z], rz - place[HIGH]
    beamed = row.cos_beam > ALL_AROUND
    reach = row.cos_beam * math.sqrt(rx * rx + ry * ry + rz * rz)
    for k in range(m):
        # away from the axis, at this longitude, beyond the user
        out = rx * cos_lon[k] + ry * sin_lon[k] - place[OUT]
        east = ry * cos_lon[k] - rx * sin_lon[k]
        north = high * up_out - out * up_z
        up = out * up_out + high * up_z
        elevation = math.atan2(up, math.sqrt(east * east + north * north))
        seen = elevation >= mask_at(math.atan2(east, north), row.azimuths, row.elevations)
        if seen and beamed:  # the satellite's way down and its line to the user, r . (r - p)
            along = (out + place[OUT]) * out + east * east + rz * high
            seen = along >= reach * math.sqrt(out * out + east * east + high * high)
        if seen and not previous:
            runs[total, 0] = k
            total += 1
        if seen:
            runs[total - 1, 1] = k + 1
        previous = seen
    return total


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

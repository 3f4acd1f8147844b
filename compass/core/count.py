"""Satellite counts on latitude rows."""

import math

from compass.core.jit import kernel
from compass.core.runs import cap_run


@kernel
def count_rows(u, cos_cap, sin_lat, cos_lat, cos_lon, sin_lon, lon0, out):
    """Number of satellites in view in every cell of some rows, at every epoch, constant mask.

    Each cap meets a row in one interval of longitude, so a row costs one arc cosine a
    satellite and one increment a cell in view.

    Parameters
    ----------
    u
        Unit vectors to the satellites, Mars-fixed, shape (epoch, satellite, 3).
    cos_cap
        Cosines of the cap radii, shape (epoch, satellite).
    sin_lat, cos_lat
        Of the rows, shape (row,).
    cos_lon, sin_lon
        Of the columns, shape (column,).
    lon0
        Longitude of column 0, radians.
    out
        Filled; shape (epoch, row, column), int16.
    """
    m = cos_lon.size
    out[:] = 0
    for t in range(u.shape[0]):
        for s in range(u.shape[1]):
            ux, uy, uz = u[t, s, 0], u[t, s, 1], u[t, s, 2]
            away, longitude = math.sqrt(ux * ux + uy * uy), math.atan2(uy, ux)
            for i in range(sin_lat.size):
                first, stop = cap_run(
                    ux, uy, uz, away, longitude, cos_cap[t, s],
                    sin_lat[i], cos_lat[i], cos_lon, sin_lon, lon0,
                )  # fmt: skip
                _increment(out[t, i, first : min(stop, m)])
                _increment(out[t, i, : max(stop - m, 0)])


@kernel
def _increment(cells):
    # a slice of its own from index 0, so that the compiler need not think of negative indices
    # and fills whole vector registers
    for j in range(cells.size):
        cells[j] += 1

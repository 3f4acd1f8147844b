"""Satellite counts on latitude rows."""

import numpy as np

from compass.core.jit import kernel
from compass.core.runs import cap_runs


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
    runs = np.empty((1, 2), np.int64)
    m = cos_lon.size
    for t in range(u.shape[0]):
        for i in range(sin_lat.size):
            row = out[t, i]
            row[:] = 0
            for s in range(u.shape[1]):
                if not cap_runs(
                    u[t, s, 0],
                    u[t, s, 1],
                    u[t, s, 2],
                    cos_cap[t, s],
                    sin_lat[i],
                    cos_lat[i],
                    cos_lon,
                    sin_lon,
                    lon0,
                    runs,
                ):
                    continue
                first, stop = runs[0, 0], runs[0, 1]
                for j in range(first, min(stop, m)):
                    row[j] += 1
                for j in range(stop - m):
                    row[j] += 1

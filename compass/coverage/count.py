"""Satellite counts on a grid over time."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from compass.core.count import count_rows
from compass.cores import cores
from compass.coverage.grid import Grid
from compass.coverage.view import View
from compass.errors import ArgumentError

#: Pieces of work: enough to share among threads, few enough that handing out costs nothing.
PARTS = 8


def count_map(view: View, grid: Grid, workers: int | None = None) -> NDArray[np.int16]:
    """Number of satellites in view, shape (epoch, row, column): constant mask, sphere.

    Parameters
    ----------
    view
        The constellation at some epochs.
    grid
        Where.
    workers
        Threads; by default one a core. The result does not depend on it.

    Raises
    ------
    ArgumentError
        The mask changes with azimuth, or the grid lies on an ellipsoid: `coverage_map` takes
        both.
    """
    if view.azimuths.size > 1:
        raise ArgumentError("count_map: the mask changes with azimuth; use coverage_map")
    if grid.polar != 1:
        raise ArgumentError("count_map: cells on an ellipsoid; use coverage_map")
    longitude, latitude = grid.longitude, grid.latitude
    cos_lon, sin_lon = np.cos(longitude), np.sin(longitude)
    u, out = view.directions, np.empty((view.times.size, grid.rows, grid.columns), np.int16)

    def fill(part: slice) -> None:
        count_rows(
            u[part],
            view.cos_cap[part],
            np.sin(latitude),
            np.cos(latitude),
            cos_lon,
            sin_lon,
            longitude[0],
            out[part],
        )

    edges = np.linspace(0, view.times.size, min(PARTS, view.times.size) + 1).astype(int)
    with ThreadPoolExecutor(cores(workers)) as pool:
        list(pool.map(fill, map(slice, edges[:-1], edges[1:])))
    return out

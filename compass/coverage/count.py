"""Satellite counts on a grid over time."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from compass.core.count import count_rows
from compass.coverage.grid import Grid
from compass.coverage.view import View
from compass.errors import ArgumentError


def count_map(view: View, grid: Grid, workers: int | None = None) -> NDArray[np.int16]:
    """Number of satellites in view, shape (epoch, row, column); constant mask.

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
        The mask changes with azimuth; `coverage_map` takes such a mask.
    """
    if view.azimuths.size > 1:
        raise ArgumentError("count_map: the mask changes with azimuth; use coverage_map")
    longitude, latitude = grid.longitude, grid.latitude
    cos_lon, sin_lon = np.cos(longitude), np.sin(longitude)
    u, out = view.directions, np.empty((view.times.size, grid.rows, grid.columns), np.int16)

    def fill(t: int) -> None:
        count_rows(
            u[t : t + 1],
            view.cos_cap[t : t + 1],
            np.sin(latitude),
            np.cos(latitude),
            cos_lon,
            sin_lon,
            longitude[0],
            out[t : t + 1],
        )

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(fill, range(view.times.size)))
    return out

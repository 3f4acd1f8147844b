"""Error maps: how well a user anywhere is told where and when it is, in metres."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.core.error import Ranges, empty_error_histograms, error_map_row
from compass.core.ranking import histogram_quantile
from compass.coverage.grid import Grid
from compass.coverage.maps import CELL_PERCENTILES, nearest_ranks
from compass.coverage.rows import Part, Rows, by_threads, gathered
from compass.coverage.view import View
from compass.errors import ArgumentError
from compass.signal.ranges import RangeErrors

if TYPE_CHECKING:
    import xarray as xr

#: Order of the errors in every array and table, with what they are.
ERRORS = {
    "error_horizontal_m": "horizontal error, root of the east and north variances",
    "error_vertical_m": "vertical error",
    "error_position_m": "position error, root of the three variances",
    "error_time_m": "error of the user's time as length",
}
PERCENTILES = (50, 90, 95, 99)


def error_map(
    view: View,
    grid: Grid,
    ranges: RangeErrors,
    *,
    limit: float = 30.0,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
    by: Rows | None = None,
) -> "xr.Dataset":
    """Errors of fixes in each cell over time, and over the whole sphere; one sigma, metres.

    Infinite with fewer than four satellites in view or singular geometry; infinities count.

    Parameters
    ----------
    view
        The constellation at the epochs, each with weight 1/epochs.
    grid
        Cells.
    ranges
        Errors of the ranges at the same epochs.
    limit
        An error counts as within if it is at most this, metres.
    workers, progress, by
        As of `compass.coverage.maps.coverage_map`.

    Returns
    -------
    xarray.Dataset
        Over (percentile, lat, lon): ``error_horizontal_m``, ``error_vertical_m``,
        ``error_position_m``, ``error_time_m``; over (error, lat, lon): ``error_share``; global:
        ``cells_error`` over (error, global_percentile), ``cells_error_share`` over error,
        ``cells_fix_share``. How well cells and epochs tell these is not known: see
        `compass.coverage.drawn`.

    Raises
    ------
    ArgumentError
        A limit that is not positive.
    """
    if not limit > 0:
        raise ArgumentError(f"error_max_m = {limit:g}: must be positive")
    do = by or by_threads(workers, progress)
    work = partial(error_rows, view, grid, ranges, limit)
    total = empty_error_histograms()

    def add(histograms: NDArray[np.float64]) -> None:
        total[:] += histograms

    cells = gathered(do("errors", work, grid), grid, add)
    weight = grid.cell_share * grid.columns
    return _dataset(cells["percentiles"], cells["share"], total, weight / weight.sum(), limit)


def error_rows(
    view: View, grid: Grid, ranges: RangeErrors, limit: float, rows: Sequence[int]
) -> Part:
    """Errors of some rows over time, and their histograms."""
    shape, epochs = (len(rows), grid.columns), view.times.size
    share = np.empty((len(ERRORS), *shape), np.float32)
    percentiles = np.empty((len(ERRORS), len(CELL_PERCENTILES), *shape), np.float32)
    users, cell_share = view.rows(grid), grid.cell_share
    worth = Ranges(ranges.forms, ranges.sun, ranges.lit, ranges.numbers)
    ranks, histograms = nearest_ranks(epochs), empty_error_histograms()
    errors = np.empty((len(ERRORS), grid.columns, epochs), np.float32)
    good = np.empty((len(ERRORS), grid.columns))
    for k, i in enumerate(rows):
        error_map_row(
            view.r,
            view.cos_cap,
            users[i],
            worth,
            limit,
            cell_share[i] / epochs,
            good,
            errors,
            histograms,
        )
        share[:, k] = good
        errors.sort(axis=-1)
        percentiles[:, :, k] = np.moveaxis(errors[..., ranks], -1, 1)
    return Part({"percentiles": percentiles, "share": share}, (histograms,))


def _dataset(
    percentiles: NDArray[np.float32],
    share: NDArray[np.float32],
    total: NDArray[np.float64],
    row_weight: NDArray[np.float64],
    limit: float,
) -> "xr.Dataset":
    """Name, describe and summarise."""
    import xarray as xr

    quantiles = [[histogram_quantile(h, q / 100) for q in PERCENTILES] for h in total]
    by_row = share.mean(axis=2, dtype=np.float64)
    over_all = by_row @ row_weight
    data: dict[str, tuple] = {
        name: (
            ("percentile", "lat", "lon"),
            percentiles[k],
            _attrs(f"{text}, one sigma, percentile over time (nearest rank, inf counts)", "m"),
        )
        for k, (name, text) in enumerate(ERRORS.items())
    }
    within = f"with an error of one sigma of at most {limit:g} m"
    data |= {
        "error_share": (("error", "lat", "lon"), share, _attrs(f"share of time {within}")),
        "cells_error": (
            ("error", "global_percentile"),
            quantiles,
            _attrs("percentile over area and time, one sigma", "m"),
        ),
        "cells_fix_share": (
            (),
            finite_share(total[0]),
            _attrs("share of area and time with a fix"),
        ),
        "cells_error_share": ("error", over_all, _attrs(f"share of area and time {within}")),
    }
    coords = {
        "percentile": ("percentile", list(CELL_PERCENTILES), {"units": "percent"}),
        "global_percentile": ("global_percentile", list(PERCENTILES), {"units": "percent"}),
        "error": ("error", list(ERRORS)),
    }
    return xr.Dataset(data, coords, {"error_limit_m": limit})


def finite_share(histogram: NDArray[np.float64]) -> float:
    """Share of what was added to a histogram that is not infinite."""
    return float(1.0 - histogram[-1] / histogram.sum())


def _attrs(long_name: str, units: str = "1") -> dict[str, str]:
    return {"units": units, "long_name": long_name}

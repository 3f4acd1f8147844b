"""Protection maps: how far a fix may be off unnoticed, anywhere, should a satellite fail."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.core.error import Ranges
from compass.core.integrity import (
    FACTOR,
    RISK,
    Promise,
    empty_level_histograms,
    levels_over_time,
    protection_row,
)
from compass.core.ranking import histogram_quantile
from compass.coverage.errors import PERCENTILES, finite_share
from compass.coverage.grid import Grid
from compass.coverage.maps import CELL_PERCENTILES, nearest_ranks
from compass.coverage.moving import Mover, Sights, heard_by
from compass.coverage.rows import Part, Rows, by_threads, gathered
from compass.coverage.view import View
from compass.design import Design
from compass.errors import ArgumentError
from compass.integrity import Integrity
from compass.signal.ranges import RangeErrors
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr

#: Order of the levels in every array and table.
LEVELS = {
    "protection_horizontal_m": "horizontal protection level",
    "protection_vertical_m": "vertical protection level",
}
#: Shares of area and time, in the kernel's order.
SHARES = ("detectable", "horizontal", "vertical", "both")


def promise_numbers(integrity: Integrity, satellites: int) -> NDArray[np.float64]:
    """Numbers of a promise as `compass.core.integrity` takes them.

    Thresholds share the false alarms among the tests of all satellites of a direction:
    ``K = Q^-1(P_FA,q / (2 n))``, n the largest number in view there can be.
    """
    from statistics import NormalDist

    numbers = np.zeros(FACTOR + 3)
    numbers[0], numbers[1] = integrity.fault, integrity.bias
    for axis, share in enumerate((0.5 * integrity.horizontal,) * 2 + (1.0 - integrity.horizontal,)):
        numbers[RISK + axis] = share * integrity.hazard
        tests = 2.0 * max(satellites, 1)
        numbers[FACTOR + axis] = -NormalDist().inv_cdf(share * integrity.alarm / tests)
    return numbers


def promise_of(integrity: Integrity, satellites: int) -> Promise:
    """What users of so many satellites are promised, as kernels take it."""
    return Promise(
        promise_numbers(integrity, satellites),
        np.array([integrity.unmonitored(n) for n in range(satellites + 1)]) / integrity.hazard,
        np.array([integrity.alert_horizontal, integrity.alert_vertical]),
    )


def levels_along(
    design: Design, mover: Mover, sights: Sights
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.bool_]]:
    """Protection levels of a user at every epoch, m, and whether a fault can be detected.

    By `LEVELS`; infinite where there is none.
    """
    assert design.integrity is not None
    levels = np.empty((len(mover.r), len(LEVELS)))
    able = np.empty(len(mover.r), dtype=bool)
    levels_over_time(
        np.ascontiguousarray(mover.r / design.figure.equatorial_radius),
        np.ascontiguousarray(mover.axes),
        sights.r,
        sights.seen,
        heard_by(mover, sights),
        promise_of(design.integrity, sights.r.shape[1]),
        levels,
        able,
    )
    return dict(zip(LEVELS, levels.T, strict=True)), able


def protection_map(
    view: View,
    grid: Grid,
    ranges: RangeErrors,
    integrity: Integrity,
    *,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
    by: Rows | None = None,
) -> "xr.Dataset":
    """Protection levels in each cell over time, and over the whole sphere, metres.

    By solution separation for one faulty satellite (`compass.core.integrity`). Infinite with fewer
    than five satellites in view, with a range that the others cannot check, and where two faults
    at once use up the whole risk; infinities count.

    Parameters
    ----------
    view, grid, ranges, workers, progress, by
        As of `compass.coverage.errors.error_map`.
    integrity
        What is promised.

    Returns
    -------
    xarray.Dataset
        Over (percentile, lat, lon): ``protection_horizontal_m``, ``protection_vertical_m``; over
        (lat, lon): ``detection_share``, ``protection_share``; global: ``cells_protection`` over
        (level, global_percentile), ``cells_protection_share`` over protected,
        ``cells_level_share``.

    Raises
    ------
    ArgumentError
        Fewer than five satellites.
    """
    import xarray as xr

    count = view.r.shape[1]
    if count < 5:
        raise ArgumentError(
            f"integrity: {counted(count, 'satellite')}; a fault is noticed with five in view "
            "or more"
        )
    do = by or by_threads(workers, progress)
    work = partial(protection_rows, view, grid, ranges, integrity)
    histograms, total = empty_level_histograms(), np.zeros(len(SHARES))

    def add(levels: NDArray[np.float64], shares: NDArray[np.float64]) -> None:
        histograms[:] += levels
        total[:] += shares

    cells = gathered(do("protection", work, grid), grid, add)
    percentiles, shares = cells["percentiles"], cells["shares"]
    by_cell = ("lat", "lon")
    data: dict[str, tuple] = {
        name: (
            ("percentile", *by_cell),
            percentiles[k],
            {"units": "m", "long_name": f"{text}, percentile over time (nearest rank)"},
        )
        for k, (name, text) in enumerate(LEVELS.items())
    }
    limits = f"{integrity.alert_horizontal:g} m and {integrity.alert_vertical:g} m"
    data |= {
        "detection_share": (
            by_cell,
            shares[0],
            {"units": "1", "long_name": "share of time in which one fault can be detected"},
        ),
        "protection_share": (
            by_cell,
            shares[1],
            {"units": "1", "long_name": f"share of time with levels within {limits}"},
        ),
        "cells_protection": (
            ("level", "global_percentile"),
            np.array([[histogram_quantile(h, q / 100) for q in PERCENTILES] for h in histograms]),
            {"units": "m", "long_name": "percentile over area and time"},
        ),
        "cells_level_share": (
            (),
            finite_share(histograms[0]),
            {"units": "1", "long_name": "share of area and time with protection levels"},
        ),
        "cells_protection_share": (
            "protected",
            total,
            {"units": "1", "long_name": f"share of area and time; levels within {limits}"},
        ),
    }
    coords = {
        "percentile": ("percentile", list(CELL_PERCENTILES), {"units": "percent"}),
        "global_percentile": ("global_percentile", list(PERCENTILES), {"units": "percent"}),
        "level": ("level", list(LEVELS)),
        "protected": ("protected", list(SHARES)),
    }
    return xr.Dataset(data, coords)


def protection_rows(
    view: View, grid: Grid, ranges: RangeErrors, integrity: Integrity, rows: Sequence[int]
) -> Part:
    """Protection levels of some rows over time, with their histograms and shares."""
    epochs, count = view.r.shape[:2]
    shape = (len(rows), grid.columns)
    percentiles = np.empty((2, len(CELL_PERCENTILES), *shape), np.float32)
    shares = np.empty((2, *shape), np.float32)
    users, cell_share = view.rows(grid), grid.cell_share
    worth = Ranges(ranges.forms, ranges.sun, ranges.lit, ranges.numbers)
    ranks = nearest_ranks(epochs)
    promise = promise_of(integrity, count)
    histograms, total = empty_level_histograms(), np.zeros(len(SHARES))
    levels = np.empty((2, grid.columns, epochs), np.float32)
    within = np.empty((2, grid.columns))
    for k, i in enumerate(rows):
        protection_row(
            view.r,
            view.cos_cap,
            users[i],
            worth,
            promise,
            cell_share[i] / epochs,
            levels,
            within,
            histograms,
            total,
        )
        shares[:, k] = within
        levels.sort(axis=-1)
        percentiles[:, :, k] = np.moveaxis(levels[..., ranks], -1, 1)
    return Part({"percentiles": percentiles, "shares": shares}, (histograms, total))

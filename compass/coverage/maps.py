"""Coverage maps: counts, dilution of precision and gaps over the sphere and a period."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.core.coverage_map import Cells, Tallies, empty_tallies, map_row
from compass.core.ranking import histogram_quantile, nearest_rank
from compass.coverage.gaps import Gaps
from compass.coverage.grid import Grid
from compass.coverage.rows import Part, Rows, by_threads, gathered
from compass.coverage.view import View
from compass.design import PDOP_MAX
from compass.errors import ArgumentError, whole_number

if TYPE_CHECKING:
    import xarray as xr

#: Order of the dilutions of precision in every array and table.
DOPS = ("gdop", "pdop", "hdop", "vdop", "tdop")
LONG_NAMES = {
    "gdop": "geometric dilution of precision",
    "pdop": "position dilution of precision",
    "hdop": "horizontal dilution of precision",
    "vdop": "vertical dilution of precision",
    "tdop": "time dilution of precision",
}
CELL_PERCENTILES = (50, 95)
#: Per-cell shares are kept up to this fold; the global ones have no limit.
MAX_FOLD_KEPT = 16


def coverage_map(
    view: View,
    grid: Grid,
    *,
    fold: int = 4,
    gaps: Gaps | None = None,
    pdop_threshold: float = PDOP_MAX,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
    by: Rows | None = None,
) -> "xr.Dataset":
    """Everything a map says about each cell, zone and epoch, and about the whole sphere.

    The epochs of `view` are taken as equally spaced over the time that counts, each with weight
    1/epochs.
    A dilution of precision is infinite with fewer than four satellites in view or with singular
    geometry; infinities count in every percentile and against availability.

    Parameters
    ----------
    view
        The constellation at the epochs.
    grid
        Cells; areas are exact, so global and zonal numbers are area- and time-weighted.
    fold
        Satellites wanted at once.
    gaps
        Of the same grid and fold, to be told beside the rest.
    pdop_threshold
        A cell is available while ``PDOP <= pdop_threshold``.
    workers
        Threads; by default one a core. The numbers do not depend on it.
    progress
        Called with the number of rows just finished.
    by
        Who does the rows, if not threads of this machine.

    Returns
    -------
    xarray.Dataset
        Over (lat, lon): ``count_min``, ``count_mean``, ``count_max``, ``fold_share`` (by fold),
        ``gdop`` ... ``tdop`` (by percentile, nearest rank), ``availability``, and with `gaps`
        ``longest_gap``, ``mean_gap``, ``mean_response_time``; over lat: ``fold_share_lat``; over
        time: ``count_min_time``, ``count_mean_time``, ``count_max_time``; global: ``cells_dop``
        (dop, global_percentile; relative error at most 4.9e-4), ``cells_fold_share``,
        ``cells_count_mean``, ``cells_availability``.

    Raises
    ------
    ArgumentError
        `fold` below 1 or a threshold that is not positive.
    """
    whole_number("fold", fold, 1)
    if not pdop_threshold > 0:
        raise ArgumentError(f"pdop_threshold = {pdop_threshold}: must be positive")
    do = by or by_threads(workers, progress)
    work = partial(count_rows, view, grid, pdop_threshold)
    totals = empty_tallies(view.r.shape[1], view.times.size)

    def add(
        dop: NDArray[np.float64], counts: NDArray[np.float64], by_epoch: NDArray[np.float64]
    ) -> None:
        totals.dop[:] += dop
        totals.counts[:] += counts
        low, mean, high = totals.by_epoch
        np.minimum(low, by_epoch[0], out=low)
        mean += by_epoch[1] * view.times.size
        np.maximum(high, by_epoch[2], out=high)

    cells = gathered(do("counts", work, grid), grid, add)
    return _dataset(view, grid, fold, gaps, cells, totals, pdop_threshold)


def count_rows(view: View, grid: Grid, pdop_threshold: float, rows: Sequence[int]) -> Part:
    """Counts and dilutions of precision of some rows over time, and their tallies."""
    epochs, satellites = view.r.shape[:2]
    shape = (len(rows), grid.columns)
    kept = min(satellites, MAX_FOLD_KEPT)
    found: dict[str, NDArray] = {
        "count_min": np.empty(shape, np.int16),
        "count_mean": np.empty(shape, np.float32),
        "count_max": np.empty(shape, np.int16),
        "availability": np.empty(shape, np.float32),
        "fold_share": np.empty((kept, *shape), np.float32),
        "dop": np.empty((len(DOPS), len(CELL_PERCENTILES), *shape), np.float32),
    }
    users, cell_share, ranks = view.rows(grid), grid.cell_share, nearest_ranks(epochs)
    tallies = empty_tallies(satellites, epochs)
    dop = np.empty((len(DOPS), grid.columns, epochs), np.float32)
    for k, i in enumerate(rows):
        cells = Cells(
            found["count_min"][k],
            found["count_mean"][k],
            found["count_max"][k],
            found["fold_share"][:, k],
            found["availability"][k],
        )
        map_row(
            view.r,
            view.cos_cap,
            users[i],
            pdop_threshold,
            cell_share[i] / epochs,
            cells,
            dop,
            tallies,
        )
        dop.sort(axis=-1)
        found["dop"][:, :, k] = np.moveaxis(dop[..., ranks], -1, 1)
    return Part(found, tuple(tallies))


def nearest_ranks(epochs: int) -> NDArray[np.int64]:
    """Places of `CELL_PERCENTILES` among sorted values, one an epoch."""
    return np.array([nearest_rank(epochs, percent) for percent in CELL_PERCENTILES])


def _dataset(
    view: View,
    grid: Grid,
    fold: int,
    gaps: Gaps | None,
    cells: dict[str, NDArray],
    totals: Tallies,
    pdop_threshold: float,
) -> "xr.Dataset":
    """Name, describe and summarise."""
    import xarray as xr

    weight, share = grid.cell_share, cells["fold_share"]
    by_cell = ("lat", "lon")
    global_percentiles = [50, 90, 95, 99]
    quantiles = [
        [histogram_quantile(row, q / 100) for q in global_percentiles] for row in totals.dop
    ]
    share_of_count = totals.counts / totals.counts.sum()
    at_least = share_of_count[::-1].cumsum()[::-1]
    zone = share.mean(axis=2, dtype=np.float64)  # (fold, lat)
    data: dict[str, tuple] = {
        "count_min": (by_cell, cells["count_min"], _attrs("smallest satellite count")),
        "count_mean": (by_cell, cells["count_mean"], _attrs("mean satellite count")),
        "count_max": (by_cell, cells["count_max"], _attrs("largest satellite count")),
        "fold_share": (
            ("fold", *by_cell),
            share,
            _attrs("share of time with at least this many satellites in view"),
        ),
        "availability": (
            by_cell,
            cells["availability"],
            _attrs(f"share of time with PDOP at most {pdop_threshold:g}"),
        ),
    }
    for k, dop in enumerate(DOPS):
        data[dop] = (
            ("percentile", *by_cell),
            cells["dop"][k],
            _attrs(f"{LONG_NAMES[dop]}, percentile over time (nearest rank, inf counts)"),
        )
    if gaps is not None:
        for name, (seconds, text) in {
            "longest_gap": (gaps.longest, "longest time with too few satellites"),
            "mean_gap": (gaps.mean, "mean time with too few satellites, a gap"),
            "mean_response_time": (
                gaps.response,
                "mean wait from a random moment for the satellites wanted",
            ),
        }.items():
            data[name] = (by_cell, seconds, _attrs(text, "s"))
    data |= {
        "fold_share_lat": (
            ("fold", "lat"),
            zone,
            _attrs("share of longitude and time with at least this many in view"),
        ),
        "count_min_time": ("time", totals.by_epoch[0], _attrs("smallest count on the sphere")),
        "count_mean_time": ("time", totals.by_epoch[1], _attrs("mean count on the sphere")),
        "count_max_time": ("time", totals.by_epoch[2], _attrs("largest count on the sphere")),
        "cells_dop": (
            ("dop", "global_percentile"),
            np.array(quantiles),
            _attrs("percentile over area and time, from bins 9.8e-4 wide"),
        ),
        "cells_fold_share": (
            "global_fold",
            at_least,
            _attrs("share of area and time with at least this many in view"),
        ),
        "cells_count_mean": (
            (),
            float(share_of_count @ np.arange(share_of_count.size)),
            _attrs("mean satellite count over area and time"),
        ),
        "cells_availability": (
            (),
            float(weight @ cells["availability"].sum(axis=1, dtype=np.float64)),
            _attrs(f"share of area and time with PDOP at most {pdop_threshold:g}"),
        ),
        "cell_share": ("lat", weight, _attrs("share of the surface in one cell of the row")),
    }
    coords = {
        "lat": (
            "lat",
            np.degrees(grid.latitude),
            {
                "units": "degrees_north",
                "standard_name": "latitude",
                "long_name": "planetocentric latitude",
            },
        ),
        "lon": (
            "lon",
            np.degrees(grid.longitude),
            {
                "units": "degrees_east",
                "standard_name": "longitude",
                "long_name": "east longitude",
            },
        ),
        "time": (
            "time",
            view.times,
            {"units": "s", "long_name": "time after the epoch of the orbits"},
        ),
        "fold": ("fold", np.arange(1, len(share) + 1), _attrs("satellites in view at once")),
        "percentile": ("percentile", list(CELL_PERCENTILES), {"units": "percent"}),
        "global_percentile": ("global_percentile", global_percentiles, {"units": "percent"}),
        "global_fold": (
            "global_fold",
            np.arange(at_least.size),
            _attrs("satellites in view at once"),
        ),
        "dop": ("dop", list(DOPS)),
    }
    attrs = {
        "wanted_fold": fold,
        "pdop_threshold": pdop_threshold,
        "epochs": view.times.size,
        "grid": grid.title,
    }
    if gaps is not None:
        attrs |= {"gap_step_s": gaps.step, "gap_span_repeats": int(gaps.ring)}
    made, coordinates = (
        {
            name: xr.Variable(one[0], np.asarray(one[1]), dict(*one[2:]), fastpath=True)
            for name, one in some.items()
        }
        for some in (data, coords)
    )  # arrays as they are: else xarray imports Dask to see whether they are its
    return xr.Dataset(made, coordinates, attrs)


def _attrs(long_name: str, units: str = "1") -> dict[str, str]:
    return {"units": units, "long_name": long_name}

"""Coverage maps: counts, dilution of precision and gaps over the sphere and a period."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import takewhile
from threading import Event
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from compass.core.coverage_map import Cells, Tallies, empty_tallies, map_row
from compass.core.ranking import histogram_quantile, nearest_rank
from compass.cores import cores
from compass.coverage.gaps import Gaps
from compass.coverage.grid import Grid
from compass.coverage.view import View
from compass.design import PDOP_MAX
from compass.errors import ArgumentError, whole_number

if TYPE_CHECKING:
    import xarray as xr

Found = TypeVar("Found")

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
#: Pieces of work, the same for any number of threads, so that sums come out the same.
BLOCKS = 32


def coverage_map(
    view: View,
    grid: Grid,
    *,
    fold: int = 4,
    gaps: Gaps | None = None,
    pdop_threshold: float = PDOP_MAX,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
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

    Returns
    -------
    xarray.Dataset
        Over (lat, lon): ``count_min``, ``count_mean``, ``count_max``, ``fold_share`` (by fold),
        ``gdop`` ... ``tdop`` (by percentile, nearest rank), ``availability``, and with `gaps`
        ``longest_gap``, ``mean_gap``, ``mean_response_time``; over lat: ``fold_share_lat``; over
        time: ``count_min_time``, ``count_mean_time``, ``count_max_time``; global: ``global_dop``
        (dop, global_percentile; relative error at most 4.9e-4), ``global_fold_share``,
        ``global_count_mean``, ``global_availability``.

    Raises
    ------
    ArgumentError
        `fold` below 1 or a threshold that is not positive.
    """
    whole_number("fold", fold, 1)
    if not pdop_threshold > 0:
        raise ArgumentError(f"pdop_threshold = {pdop_threshold}: must be positive")
    cells = _Cells(view, grid, fold, gaps)
    users, cell_share, epochs = view.rows(grid), grid.cell_share, view.times.size
    ranks = nearest_ranks(epochs)

    def one_block(rows: Iterable[int]) -> Tallies:
        tallies = empty_tallies(view.r.shape[1], epochs)
        dop = np.empty((len(DOPS), grid.columns, epochs), np.float32)
        for i in rows:
            map_row(
                view.r,
                view.cos_cap,
                users[i],
                pdop_threshold,
                cell_share[i] / epochs,
                cells.row(i),
                dop,
                tallies,
            )
            dop.sort(axis=-1)
            cells.percentiles[:, :, i] = np.moveaxis(dop[..., ranks], -1, 1)
        return tallies

    totals = empty_tallies(view.r.shape[1], epochs)
    for tallies in by_blocks(grid, one_block, workers, progress):
        totals.dop[:] += tallies.dop
        totals.counts[:] += tallies.counts
        low, mean, high = totals.by_epoch
        np.minimum(low, tallies.by_epoch[0], out=low)
        mean += tallies.by_epoch[1] * epochs
        np.maximum(high, tallies.by_epoch[2], out=high)
    return cells.dataset(totals, pdop_threshold)


def nearest_ranks(epochs: int) -> NDArray[np.int64]:
    """Places of `CELL_PERCENTILES` among sorted values, one an epoch."""
    return np.array([nearest_rank(epochs, percent) for percent in CELL_PERCENTILES])


def by_blocks(
    grid: Grid,
    one_block: Callable[[Iterable[int]], Found],
    workers: int | None,
    progress: Callable[[int], None],
) -> Iterator[Found]:
    """What is found of each block of a grid's rows, in order.

    Added up so, sums are the same for any number of threads. Who goes away before the end waits
    for the rows at work and no more.
    """
    blocks = np.array_split(np.arange(grid.rows), min(BLOCKS, grid.rows))
    left = Event()

    def rows_wanted(block: NDArray[np.int64]) -> Iterator[int]:
        return takewhile(lambda _: not left.is_set(), block)

    with ThreadPoolExecutor(cores(workers)) as pool:
        try:
            found = pool.map(lambda block: one_block(rows_wanted(block)), blocks)
            for block, part in zip(blocks, found, strict=True):
                yield part
                progress(block.size)
        finally:
            left.set()


class _Cells:
    """The arrays that the row kernel fills, and the dataset made of them."""

    def __init__(self, view: View, grid: Grid, fold: int, gaps: Gaps | None) -> None:
        self.view, self.grid, self.fold, self.gaps = view, grid, fold, gaps
        shape = (grid.rows, grid.columns)
        self.kept = min(view.r.shape[1], MAX_FOLD_KEPT)
        self.count_min = np.empty(shape, np.int16)
        self.count_mean = np.empty(shape, np.float32)
        self.count_max = np.empty(shape, np.int16)
        self.availability = np.empty(shape, np.float32)
        self.share = np.empty((self.kept, *shape), np.float32)
        self.percentiles = np.empty((len(DOPS), len(CELL_PERCENTILES), *shape), np.float32)

    def row(self, i: int) -> Cells:
        """The cells of a row, for the kernel to fill."""
        return Cells(
            self.count_min[i],
            self.count_mean[i],
            self.count_max[i],
            self.share[:, i],
            self.availability[i],
        )

    def dataset(self, totals: Tallies, pdop_threshold: float) -> "xr.Dataset":
        """Name, describe and summarise."""
        import xarray as xr

        grid, weight = self.grid, self.grid.cell_share
        by_cell = ("lat", "lon")
        global_percentiles = [50, 90, 95, 99]
        quantiles = [
            [histogram_quantile(row, q / 100) for q in global_percentiles] for row in totals.dop
        ]
        share_of_count = totals.counts / totals.counts.sum()
        at_least = share_of_count[::-1].cumsum()[::-1]
        zone = self.share.mean(axis=2, dtype=np.float64)  # (fold, lat)
        data: dict[str, tuple] = {
            "count_min": (by_cell, self.count_min, _attrs("smallest satellite count")),
            "count_mean": (by_cell, self.count_mean, _attrs("mean satellite count")),
            "count_max": (by_cell, self.count_max, _attrs("largest satellite count")),
            "fold_share": (
                ("fold", *by_cell),
                self.share,
                _attrs("share of time with at least this many satellites in view"),
            ),
            "availability": (
                by_cell,
                self.availability,
                _attrs(f"share of time with PDOP at most {pdop_threshold:g}"),
            ),
        }
        for k, dop in enumerate(DOPS):
            data[dop] = (
                ("percentile", *by_cell),
                self.percentiles[k],
                _attrs(f"{LONG_NAMES[dop]}, percentile over time (nearest rank, inf counts)"),
            )
        if self.gaps is not None:
            for name, (seconds, text) in {
                "longest_gap": (self.gaps.longest, "longest time with too few satellites"),
                "mean_gap": (self.gaps.mean, "mean time with too few satellites, a gap"),
                "mean_response_time": (
                    self.gaps.response,
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
            "global_dop": (
                ("dop", "global_percentile"),
                np.array(quantiles),
                _attrs("percentile over area and time of the samples, from bins 9.8e-4 wide"),
            ),
            "global_fold_share": (
                "global_fold",
                at_least,
                _attrs("share of area and time with at least this many in view"),
            ),
            "global_count_mean": (
                (),
                float(share_of_count @ np.arange(share_of_count.size)),
                _attrs("mean satellite count over area and time"),
            ),
            "global_availability": (
                (),
                float(weight @ self.availability.sum(axis=1, dtype=np.float64)),
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
                self.view.times,
                {"units": "s", "long_name": "time after the epoch of the orbits"},
            ),
            "fold": ("fold", np.arange(1, self.kept + 1), _attrs("satellites in view at once")),
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
            "wanted_fold": self.fold,
            "pdop_threshold": pdop_threshold,
            "epochs": self.view.times.size,
            "grid": f"{grid.kind}, {grid.rows} by {grid.columns} cells",
        }
        if self.gaps is not None:
            attrs |= {"gap_step_s": self.gaps.step, "gap_span_repeats": int(self.gaps.ring)}
        return xr.Dataset(data, coords, attrs)


def _attrs(long_name: str, units: str = "1") -> dict[str, str]:
    return {"units": units, "long_name": long_name}

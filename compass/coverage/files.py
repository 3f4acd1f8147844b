"""Coverage maps as CF netCDF files that other programs read."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from compass.core.dop import dop_over_time
from compass.coverage.grid import Grid
from compass.coverage.maps import DOPS, LONG_NAMES
from compass.coverage.view import View
from compass.frames import Figure, mars_crs
from compass.saving import netcdf_file, put_dataset

if TYPE_CHECKING:
    import h5netcdf
    import xarray as xr


def write_map(
    dataset: "xr.Dataset",
    path: Path,
    figure: Figure,
    *,
    series: tuple[View, Grid] | None = None,
    progress: Callable[[int], None] = lambda rows: None,
) -> None:
    """Write a map with Mars as its grid mapping; a killed run leaves no partial file.

    Parameters
    ----------
    dataset
        From `coverage_map`, attributes completed by the caller (title, source, history, ...).
    path
        Where to.
    figure
        Reference figure, which the grid lies on.
    series
        With the view and the grid of the map, also ``count_series`` and ``gdop_series`` ...
        over (time, lat, lon), computed again row by row so that memory stays small.
    progress
        Called with the number of rows of the series just written.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    mapped = with_grid_mapping(dataset, figure)
    compression = {
        name: {"zlib": True, "complevel": 1} for name, v in mapped.data_vars.items() if v.ndim >= 2
    }
    with netcdf_file(path) as file:
        put_dataset(file, mapped, encoding=compression)
        if series is not None:
            _append_series(file, *series, progress)


def with_grid_mapping(dataset: "xr.Dataset", figure: Figure) -> "xr.Dataset":
    """Return the map with the grid-mapping variable ``mars`` and the convention's attributes."""
    import xarray as xr

    crs = mars_crs(figure.name)
    # of a planetocentric system pyproj tells the text alone
    mapping = crs.to_cf() | {
        "grid_mapping_name": "latitude_longitude",
        "semi_major_axis": figure.equatorial_radius,
        "semi_minor_axis": figure.polar_radius,
        "longitude_of_prime_meridian": 0.0,
        "geographic_crs_name": crs.name,
    }
    mapped = dataset.assign(mars=xr.DataArray(np.int32(0), attrs=mapping))
    for variable in mapped.data_vars.values():
        if {"lat", "lon"} <= set(variable.dims):
            variable.attrs["grid_mapping"] = "mars"
    return mapped


def _append_series(
    file: "h5netcdf.File", view: View, grid: Grid, progress: Callable[[int], None]
) -> None:
    """Add counts and DOPs of every epoch, a row at a time."""
    epochs, m = view.times.size, grid.columns
    counts, dops = np.empty((epochs, m), np.int16), np.empty((epochs, len(DOPS), m))
    dims = ("time", "lat", "lon")
    chunks = (epochs, 1, m)
    options = {"chunks": chunks, "compression": "gzip", "compression_opts": 1}
    variables = [file.create_variable("count_series", dims, np.int16, **options)]
    variables[0].attrs["long_name"] = "satellite count"
    for name in DOPS:
        variables.append(file.create_variable(f"{name}_series", dims, np.float32, **options))
        variables[-1].attrs["long_name"] = LONG_NAMES[name]
    for variable in variables:
        variable.attrs["units"] = "1"
        variable.attrs["grid_mapping"] = "mars"
    for i, row in enumerate(view.rows(grid)):
        dop_over_time(view.r, view.cos_cap, row, counts, dops)
        variables[0][:, i, :] = counts
        for k, variable in enumerate(variables[1:]):
            variable[:, i, :] = dops[:, k]
        progress(1)

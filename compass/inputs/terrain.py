"""Terrain files: digital elevation grids in netCDF or GeoTIFF."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError
from compass.frames import FIGURES, Figure, planetocentric_latitude
from compass.terrain import Terrain

if TYPE_CHECKING:
    import xarray as xr

#: Metres in the units a grid's heights may have.
_METRES = {"m": 1.0, "meter": 1.0, "metre": 1.0, "meters": 1.0, "metres": 1.0, "km": 1e3}

_LATITUDES = ("latitude", "lat", "y")
_LONGITUDES = ("longitude", "lon", "x")

#: Heights that Mars has over any of its figures, m, with room: from Hellas at -8.2 km, or a pole
#: 20 km below the sphere, to Olympus Mons at 21.3 km.
LOWEST, HIGHEST = -25e3, 30e3

#: Nodes that a grid may have: 24 bytes each are held.
MOST_NODES = 100_000_000


def read_terrain(
    path: str | Path,
    figure: Figure = FIGURES["iau-ellipsoid"],
    *,
    variable: str | None = None,
    latitude_kind: str = "planetocentric",
) -> Terrain:
    """Read heights over a figure of Mars from a netCDF or GeoTIFF file.

    Parameters
    ----------
    path
        ``.nc`` or ``.nc4``: a variable over latitude and longitude in degrees, with a CF name
        or called ``lat`` and ``lon``; ``.tif`` or ``.tiff``: the first band, in any coordinate
        reference system of Mars (needs rasterio).
    figure
        What the heights stand on. Grids over the areoid are taken as they are: it leaves the
        ellipsoid by kilometres, but so slowly that horizons do not feel it.
    variable
        Name of the heights in a netCDF file that has several.
    latitude_kind
        ``planetocentric`` or ``planetographic``, for netCDF.

    Raises
    ------
    ArgumentError
        Missing or unreadable file, no grid, units that are not of length, coordinates that are
        none, heights that Mars has not, more than 100 million nodes.
    """
    path = Path(path)
    if not path.is_file():
        raise ArgumentError(f"{path}: no such file; give a netCDF or GeoTIFF grid of heights")
    if latitude_kind not in ("planetocentric", "planetographic"):
        raise ArgumentError(
            f"latitude_kind = {latitude_kind!r}: allowed planetocentric, planetographic"
        )
    if path.suffix.lower() in (".tif", ".tiff"):
        return _geotiff(path, figure)
    if path.suffix.lower() in (".nc", ".nc4"):
        return _netcdf(path, figure, variable, latitude_kind)
    raise ArgumentError(f"{path}: unknown kind of terrain; allowed .nc, .nc4, .tif, .tiff")


def _netcdf(path: Path, figure: Figure, variable: str | None, kind: str) -> Terrain:
    import xarray as xr

    try:
        dataset = xr.open_dataset(path, engine="h5netcdf")
    except (OSError, ValueError) as error:
        raise ArgumentError(f"{path}: cannot be read as netCDF-4: {error}") from error
    with dataset:
        heights = _heights(dataset, variable, path)
        latitude = _axis(heights, _LATITUDES, "latitude", path)
        longitude = _axis(heights, _LONGITUDES, "longitude", path)
        heights = heights.transpose(str(latitude.dims[0]), str(longitude.dims[0]))
        scale = _METRES.get(str(heights.attrs.get("units", "")).lower())
        if scale is None:
            raise ArgumentError(
                f"{path}: {heights.name}: units = {heights.attrs.get('units')!r}; allowed m and km"
            )
        _check_size(path, heights.size)
        lat, lon = np.radians(_latitudes(latitude, path)), np.radians(_longitudes(longitude, path))
        values = heights.values.astype(float) * scale
    if kind == "planetographic":
        lat = planetocentric_latitude(lat, figure)
    _check_heights(path, values)
    grids = np.meshgrid(lat, lon, indexing="ij")
    return Terrain(
        latitude=grids[0],
        longitude=grids[1],
        height=values,
        figure=figure,
        label=str(path),
        closed=_closes(lon),
    )


def _heights(dataset: "xr.Dataset", variable: str | None, path: Path) -> "xr.DataArray":
    """Return the variable that holds the heights."""
    grids = [str(name) for name, data in dataset.data_vars.items() if data.ndim == 2]
    if variable is None and len(grids) == 1:
        variable = grids[0]
    if variable not in grids:
        named = "needs a variable" if variable is None else f"variable = {variable!r}"
        raise ArgumentError(
            f"{path}: {named}: its grids of latitude and longitude are {', '.join(grids) or 'none'}"
        )
    return dataset[variable]


def _axis(
    heights: "xr.DataArray", names: tuple[str, ...], standard: str, path: Path
) -> "xr.DataArray":
    """Return the coordinate that is a latitude or longitude by its CF name or its own."""
    for name in heights.dims:
        axis = heights.coords.get(name)
        if axis is None or axis.size < 2:
            continue
        if axis.attrs.get("standard_name") == standard or str(name).lower() in names:
            return axis
    raise ArgumentError(
        f"{path}: {heights.name}: no coordinate {standard} in degrees, of two values or more"
    )


def _latitudes(axis: "xr.DataArray", path: Path) -> NDArray[np.float64]:
    """Values of a coordinate, which must be degrees north, in one order."""
    values = _degrees(axis, path, -90.0, 90.0)
    _check_order(axis, path, np.diff(values))
    return values


def _longitudes(axis: "xr.DataArray", path: Path) -> NDArray[np.float64]:
    """Values of a coordinate, which must be degrees east, in one order.

    They may go on from 180 with -180, or from 360 with 0.
    """
    values = _degrees(axis, path, -360.0, 720.0)
    steps = np.diff(values)
    _check_order(axis, path, steps - 360.0 * np.round(steps / 360.0))
    return values


def _degrees(axis: "xr.DataArray", path: Path, least: float, most: float) -> NDArray[np.float64]:
    """Values of a coordinate, which must be degrees north or east in a range, all known."""
    units = str(axis.attrs.get("units", "degrees")).lower()
    values = axis.values.astype(float)
    if not units.startswith("deg") or units.endswith(("west", "south")):
        raise ArgumentError(
            f"{path}: {axis.name}: units = {axis.attrs['units']!r}; allowed degrees north and "
            "degrees east; turn the grid's coordinate into these"
        )
    known = values[np.isfinite(values)]
    if known.size < values.size or not least <= known.min() <= known.max() <= most:
        span = f"{known.min():g} to {known.max():g}" if known.size else "unknown"
        raise ArgumentError(
            f"{path}: {axis.name} = {span}: allowed {least:g} to {most:g} degrees, none unknown"
        )
    return values


def _check_order(axis: "xr.DataArray", path: Path, steps: NDArray[np.float64]) -> None:
    if not (np.all(steps > 0) or np.all(steps < 0)):
        raise ArgumentError(
            f"{path}: {axis.name}: neither rises nor falls all along; sort the grid by it"
        )


def _check_heights(path: Path, heights: NDArray[np.float64]) -> None:
    """Refuse heights that Mars has not: radii, or marks of what is unknown, undeclared."""
    known = heights[np.isfinite(heights)]
    if not known.size:
        raise ArgumentError(f"{path}: no height is known")
    low, high = known.min(), known.max()
    if low < LOWEST or high > HIGHEST:
        raise ArgumentError(
            f"{path}: heights from {low / 1e3:.6g} to {high / 1e3:.6g} km: allowed "
            f"{LOWEST / 1e3:g} to {HIGHEST / 1e3:g} km over the figure; declare what stands for an "
            "unknown height (nodata of GeoTIFF, _FillValue of netCDF), and give no radii"
        )


def _geotiff(path: Path, figure: Figure) -> Terrain:
    try:
        import rasterio
    except ImportError as error:
        raise ArgumentError(
            f'{path}: GeoTIFF needs rasterio; pip install "compass-mars[terrain]", or give netCDF'
        ) from error
    try:
        with warnings.catch_warnings():
            # said below, as a fault of the file
            warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
            raster = rasterio.open(path)
        with raster:
            _check_size(path, raster.width * raster.height)
            heights = raster.read(1, masked=True).astype(float).filled(np.nan)
            unit, crs, a = raster.units[0], raster.crs, raster.transform
    except rasterio.errors.RasterioError as error:
        raise ArgumentError(f"{path}: cannot be read as GeoTIFF: {error}") from error
    if crs is None:
        raise ArgumentError(f"{path}: has no coordinate reference system; assign one of Mars")
    if (a.a, a.b, a.c, a.d, abs(a.e), a.f) == (1, 0, 0, 0, 1, 0):
        raise ArgumentError(f"{path}: says not where on Mars it lies; give it its transform")
    scale = _METRES.get((unit or "m").lower())
    if scale is None:
        raise ArgumentError(f"{path}: first band in {unit!r}; allowed m and km")
    columns, rows = np.meshgrid(np.arange(heights.shape[1]), np.arange(heights.shape[0]))
    # the middle of each pixel
    x = a.a * (columns + 0.5) + a.b * (rows + 0.5) + a.c
    y = a.d * (columns + 0.5) + a.e * (rows + 0.5) + a.f
    longitude, latitude = _latitude_longitude(path, crs.to_wkt(), x, y, figure)
    known = np.isfinite(latitude)
    heights = np.where(known, heights, np.nan)
    _check_heights(path, heights * scale)
    closed = bool(known[0].all()) and _closes(longitude[0])
    return Terrain(
        latitude=latitude,
        longitude=longitude,
        height=heights * scale,
        figure=figure,
        label=str(path),
        closed=closed,
    )


def _latitude_longitude(
    path: Path, wkt: str, x: NDArray[np.float64], y: NDArray[np.float64], figure: Figure
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """East longitude and planetocentric latitude, radians, of points in a CRS of Mars.

    On a sphere every latitude is planetocentric: it is kept, not moved from figure to figure as
    if it were the direction of the normal.
    """
    from pyproj import CRS, Transformer

    crs = CRS.from_wkt(wkt)
    body, geographic = crs.ellipsoid, crs.geodetic_crs
    if body is None or geographic is None or not 3.36e6 < body.semi_major_metre < 3.41e6:
        raise ArgumentError(f"{path}: coordinate reference system {crs.name!r} is not one of Mars")
    if any(axis.direction == "west" for axis in geographic.axis_info):
        raise ArgumentError(
            f"{path}: coordinate reference system {crs.name!r} counts longitudes to the west; "
            "give one that counts to the east"
        )
    forward = Transformer.from_crs(crs, geographic, always_xy=True)
    longitude, latitude = (np.radians(angle) for angle in forward.transform(x, y))
    latitude = np.where(np.isfinite(latitude), latitude, np.nan)
    centric = any("planetocentric" in axis.name.lower() for axis in geographic.axis_info)
    if body.semi_major_metre != body.semi_minor_metre and not centric:
        latitude = planetocentric_latitude(latitude, figure)
    return longitude, latitude


def _closes(longitude: NDArray[np.float64]) -> bool:
    """Whether the next column after the last, a step further, is the first, once around Mars."""
    step = longitude[1] - longitude[0]
    around = abs(longitude[-1] - longitude[0] + step)
    return bool(abs(around - 2 * np.pi) < 0.01 * abs(step))


def _check_size(path: Path, nodes: int) -> None:
    if nodes > MOST_NODES:
        raise ArgumentError(
            f"{path}: {nodes} nodes; at most {MOST_NODES} fit: cut out the surroundings of the "
            "sites, some 500 km around them"
        )

"""Grids of heights in netCDF and GeoTIFF, written here by their own libraries."""

import warnings

import numpy as np
import pytest
import xarray as xr

from compass.errors import ArgumentError
from compass.frames import FIGURES, planetocentric_latitude
from compass.inputs.terrain import read_terrain

LAT, LON = np.array([10.0, 11.0, 12.0]), np.array([70.0, 70.5, 71.0, 71.5])
HEIGHT = np.arange(12.0).reshape(3, 4)
ELLIPSOID = FIGURES["iau-ellipsoid"]


def netcdf(path, names=("lat", "lon"), units="m", dims=None, **more):
    grid = xr.DataArray(HEIGHT, coords=dict(zip(names, (LAT, LON), strict=True)), dims=names)
    grid.attrs.update({"units": units} if units else {})
    xr.Dataset({"height": grid.transpose(*(dims or names)), **more}).to_netcdf(
        path, engine="h5netcdf"
    )
    return path


@pytest.mark.parametrize("names", [("lat", "lon"), ("latitude", "longitude"), ("y", "x")])
def test_netcdf_by_any_usual_name_in_any_order(tmp_path, names):
    read = read_terrain(netcdf(tmp_path / "a.nc", names, dims=names[::-1]))
    assert np.array_equal(read.height, HEIGHT)
    assert np.allclose(np.degrees(read.latitude), LAT[:, None])
    assert np.allclose(np.degrees(read.longitude), LON)
    assert read.figure is ELLIPSOID and not read.closed


def test_netcdf_in_kilometres_and_planetographic_latitudes(tmp_path):
    path = netcdf(tmp_path / "a.nc", units="km")
    read = read_terrain(path, latitude_kind="planetographic")
    assert np.array_equal(read.height, HEIGHT * 1e3)
    assert np.allclose(read.latitude[:, 0], planetocentric_latitude(np.radians(LAT), ELLIPSOID))


def test_netcdf_around_mars_closes(tmp_path):
    lon = np.arange(0, 360, 30.0)
    xr.Dataset(
        {"z": (("lat", "lon"), np.zeros((3, 12)), {"units": "m"})}, {"lat": LAT, "lon": lon}
    ).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    assert read_terrain(tmp_path / "a.nc").closed


def geotiff(path, crs, west, north, size, heights=HEIGHT, unit="m", **more):
    import rasterio

    rows, columns = heights.shape
    with rasterio.open(
        path, "w", driver="GTiff", width=columns, height=rows, count=1, dtype="float64",
        crs=crs, transform=rasterio.Affine(size, 0, west, 0, -size, north), **more
    ) as raster:  # fmt: skip
        raster.write(heights[np.newaxis])
        raster.units = (unit,)
    return path


def crs(code):
    from pyproj import CRS

    return CRS.from_authority("IAU_2015", code).to_wkt()


def test_geotiff_in_degrees_of_the_sphere_keeps_its_latitudes(tmp_path):
    path = geotiff(tmp_path / "a.tif", crs(49900), 70.0, 12.5, 0.5)
    read = read_terrain(path)
    assert np.allclose(np.degrees(read.latitude[:, 0]), [12.25, 11.75, 11.25])
    assert np.allclose(np.degrees(read.longitude[0]), [70.25, 70.75, 71.25, 71.75])
    assert np.array_equal(read.height, HEIGHT)


def test_geotiff_in_metres_on_the_equirectangular_sphere(tmp_path):
    degree = np.radians(1.0) * 3396190.0
    path = geotiff(tmp_path / "a.tif", crs(49910), 70 * degree, 12.5 * degree, 0.5 * degree)
    read = read_terrain(path)
    assert np.allclose(np.degrees(read.latitude[:, 0]), [12.25, 11.75, 11.25], atol=1e-6)
    assert np.allclose(np.degrees(read.longitude[0]), [70.25, 70.75, 71.25, 71.75], atol=1e-6)


def test_geotiff_of_the_ellipsoid_gives_planetographic_latitudes_that_are_turned(tmp_path):
    from pyproj import CRS

    graphic = CRS.from_proj4("+proj=longlat +a=3396190 +b=3376200 +no_defs").to_wkt()
    read = read_terrain(geotiff(tmp_path / "a.tif", graphic, 70.0, 12.5, 0.5))
    wanted = planetocentric_latitude(np.radians([12.25, 11.75, 11.25]), ELLIPSOID)
    assert np.allclose(read.latitude[:, 0], wanted, atol=1e-9)


def test_geotiff_with_holes_and_in_kilometres(tmp_path):
    path = geotiff(tmp_path / "a.tif", crs(49900), 70, 12, 0.5, unit="km", nodata=5.0)
    read = read_terrain(path)
    assert np.isnan(read.height[1, 1]) and np.isfinite(read.height).sum() == 11
    assert read.height[0, 3] == 3000.0


def refused(path, match, **options):
    with pytest.raises(ArgumentError, match=match):
        read_terrain(path, **options)


def test_bad_files_are_told(tmp_path):
    refused(tmp_path / "none.nc", "no such file; give a netCDF or GeoTIFF grid")
    text = tmp_path / "a.nc"
    text.write_text("no netCDF")
    refused(text, "cannot be read as netCDF-4")
    for name in ("b.tif", "b.asc"):
        (tmp_path / name).write_text("nothing")
    refused(tmp_path / "b.tif", "cannot be read as GeoTIFF")
    refused(tmp_path / "b.asc", "unknown kind of terrain; allowed .nc, .nc4, .tif, .tiff")
    good = netcdf(tmp_path / "c.nc")
    refused(good, "latitude_kind = 'other': allowed planetocentric", latitude_kind="other")
    refused(good, "variable = 'z': its grids of latitude and longitude are height", variable="z")
    refused(netcdf(tmp_path / "d.nc", units=None), r"height: units = None; allowed m and km")
    refused(netcdf(tmp_path / "e.nc", ("lat", "q")), "no coordinate longitude in degrees")
    two = netcdf(tmp_path / "f.nc", other=(("lat", "lon"), HEIGHT))
    refused(two, "needs a variable: its grids of latitude and longitude are height, other")


def grid(path, lat=LAT, lon=LON, heights=HEIGHT, units=None):
    coords = {
        name: (name, values, {"units": units[name]} if units and name in units else {})
        for name, values in (("lat", lat), ("lon", lon))
    }
    made = xr.Dataset({"z": (("lat", "lon"), heights, {"units": "m"})}, coords)
    made.to_netcdf(path, engine="h5netcdf")
    return path


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"lon": "degrees_west"}, "lon: units = 'degrees_west'; allowed degrees north and degr"),
        ({"lat": "radian"}, "lat: units = 'radian'"),
        ({"lat": "m"}, "lat: units = 'm'"),
    ],
)
def test_coordinates_in_other_units_are_told(tmp_path, given, match):
    refused(grid(tmp_path / "a.nc", units=given), match)


@pytest.mark.parametrize(
    ("axes", "match"),
    [
        ({"lat": LAT + 80}, "lat = 90 to 92: allowed -90 to 90 degrees"),
        ({"lon": LON * np.r_[1, np.nan, 1, 1]}, "none unknown"),
        ({"lon": LON[[0, 2, 1, 3]]}, "lon: neither rises nor falls all along; sort the grid"),
        ({"lat": LAT[[0, 0, 1]]}, "lat: neither rises nor falls"),
        ({"heights": HEIGHT - 32768}, "heights from -32.768 to -32.757 km: allowed -25 to 30 km"),
        ({"heights": HEIGHT + 3396190.0}, "and give no radii"),
        ({"heights": HEIGHT * np.nan}, "no height is known"),
    ],
)
def test_coordinates_and_heights_that_are_none_are_told(tmp_path, axes, match):
    refused(grid(tmp_path / "a.nc", **axes), match)


def test_longitudes_go_on_across_the_antimeridian_and_zero_and_either_way(tmp_path):
    for lon in ([179.0, 179.5, -180.0, -179.5], [359.0, 359.5, 0.0, 0.5], LON[::-1]):
        read = read_terrain(grid(tmp_path / "a.nc", lat=LAT[::-1], lon=np.array(lon)))
        assert np.allclose(np.degrees(read.longitude[0]), lon)


def test_a_mark_of_the_unknown_that_is_not_declared_is_told(tmp_path):
    holed = np.where(HEIGHT == 5.0, -32768.0, HEIGHT)
    refused(geotiff(tmp_path / "a.tif", crs(49900), 70, 12, 0.5, heights=holed), "declare what st")
    declared = geotiff(tmp_path / "b.tif", crs(49900), 70, 12, 0.5, heights=holed, nodata=-32768.0)
    assert np.isnan(read_terrain(declared).height[1, 1])


def test_geotiffs_that_are_not_of_mars_are_told(tmp_path, monkeypatch):
    refused(geotiff(tmp_path / "a.tif", None, 3, 3, 1), "has no coordinate reference system")
    refused(geotiff(tmp_path / "b.tif", "EPSG:4326", 3, 3, 1), "'WGS 84' is not one of Mars")
    path = geotiff(tmp_path / "c.tif", crs(49900), 3, 3, 1, unit="ft")
    bare = tmp_path / "d.tif"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of rasterio, while it writes what is wrong on purpose
        geotiff(bare, crs(49900), 0, 0, 1)
    refused(bare, "says not where on Mars it lies")
    refused(path, "first band in 'ft'; allowed m and km")
    monkeypatch.setattr("compass.inputs.terrain.MOST_NODES", 5)
    refused(path, "12 nodes; at most 5 fit: cut out the surroundings")


def test_longitudes_counted_to_the_west_are_told(tmp_path):
    from compass.inputs.terrain import _latitude_longitude

    with pytest.raises(ArgumentError, match="counts longitudes to the west"):
        _latitude_longitude("a.tif", crs(49901), LAT, LON[:3], ELLIPSOID)


def test_geotiff_without_rasterio_says_what_to_install(tmp_path, monkeypatch):
    import sys

    path = tmp_path / "a.tif"
    path.write_bytes(b"")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    refused(path, r'GeoTIFF needs rasterio; pip install "compass-mars\[terrain\]", or give')

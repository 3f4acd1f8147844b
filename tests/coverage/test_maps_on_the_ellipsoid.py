"""Maps on the ellipsoid: against sites, which have their own code, and against quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from compass.core.runs import OUT, UP_OUT, least_out
from compass.coverage.count import count_map
from compass.coverage.files import write_map
from compass.coverage.grid import area_south_of, latitude_of_area, make_grid
from compass.coverage.maps import DOPS, coverage_map
from compass.coverage.site import site_coverage
from compass.coverage.view import view
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import walker_delta
from compass.sites import Mask, Site

FIGURE = FIGURES["iau-ellipsoid"]
R, POLAR = FIGURE.equatorial_radius, FIGURE.polar_radius / FIGURE.equatorial_radius


def inclined():
    return walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)


def sites(grid, mask):
    for i, j in np.ndindex(grid.rows, grid.columns):
        place = float(grid.latitude[i]), float(grid.longitude[j])
        yield i, j, Site("cell", *place, mask=mask, figure=FIGURE)


@pytest.mark.parametrize(
    "mask",
    [
        Mask(),
        Mask.constant(np.radians(35.129)),
        Mask(tuple(np.radians([0, 90, 180, 270])), tuple(np.radians([5.0, 25, 5, 15]))),
    ],
    ids=["none", "constant", "by azimuth"],
)
def test_every_cell_is_the_site_there(mask):
    grid, times = make_grid("equal-angle", 30, POLAR), np.array([0.0, 9000.0, 31000.0])
    made = coverage_map(view(inclined(), times, R, mask), grid)
    for i, j, site in sites(grid, mask):
        alone, cell = site_coverage(inclined(), site, times), made.isel(lat=i, lon=j)
        assert int(cell.count_min) == int(alone["count"].min())
        assert int(cell.count_max) == int(alone["count"].max())
        assert float(cell.count_mean) == pytest.approx(float(alone["count"].mean()), rel=1e-6)
        for name in DOPS:
            ranked = np.sort(alone[name].values)
            found = cell[name].sel(percentile=[50, 95]).values
            # single precision in the file, and rounding by condition
            np.testing.assert_allclose(found, ranked[1:], rtol=1e-6)


def test_the_sphere_would_have_said_otherwise():
    """A ring over the equator, seen from 44.95 N at the edge of a mask of 35.129 degrees."""
    ring = walker_delta(24, 1, 0, inclination_deg=0, orbit="areosynchronous")
    mask, times = Mask.constant(np.radians(35.129)), np.linspace(0, 3000, 7)
    least = {}
    for name, polar in (("sphere", 1.0), ("ellipsoid", POLAR)):
        grid = make_grid("equal-angle", 0.1, polar)
        row = int(np.argmin(np.abs(grid.latitude - np.radians(44.95))))
        assert np.degrees(grid.latitude[row]) == pytest.approx(44.95)
        seen = view(ring, times, R, mask)
        narrow = type(grid)(grid.kind, grid.latitude_edges[row : row + 2], grid.columns, polar)
        least[name] = int(coverage_map(seen, narrow, fold=2).count_min.min())
    assert least == {"sphere": 2, "ellipsoid": 1}


@given(
    st.floats(1.05, 9.0),
    st.floats(-1.57, 1.57),
    st.floats(-1.5, 1.5),
    st.floats(0.0, 1.4),
    st.floats(0.5, 0.999),
)
@settings(max_examples=200)
def test_from_the_least_out_on_a_satellite_is_seen(distance, declination, latitude, mask, polar):
    """The closed form against elevations along all of a row, on figures flatter than Mars's."""
    edges = np.array([latitude - 1e-3, latitude + 1e-3])
    row = type(make_grid("equal-angle", 90))("equal-angle", edges, 1, polar).places[0]
    rz, away = distance * np.sin(declination), distance * np.cos(declination)
    least = least_out(distance**2, rz, np.sin(mask), row)
    out = np.linspace(-away, away, 41)
    across = np.sqrt(np.maximum(away**2 - out**2, 0.0))
    sight = np.stack([out - row[OUT], across, np.full(41, rz - row[OUT + 1])])
    up = sight[0] * row[UP_OUT] + sight[2] * row[UP_OUT + 1]
    sine = up / np.linalg.norm(sight, axis=0)
    clear = np.abs(sine - np.sin(mask)) > 1e-9
    assert np.array_equal((out >= least)[clear], (sine >= np.sin(mask))[clear])


@pytest.mark.parametrize("kind", ["equal-angle", "equal-area"])
def test_cells_share_the_ellipsoid_as_quadrature_does(kind):
    grid = make_grid(kind, 15, POLAR)

    def strip(g):  # of the surface, by reduced latitude
        return np.cos(g) * np.sqrt(np.sin(g) ** 2 + (POLAR * np.cos(g)) ** 2)

    reduced = np.arctan2(np.sin(grid.latitude_edges), POLAR * np.cos(grid.latitude_edges))
    areas = [quad(strip, *pair)[0] for pair in np.stack([reduced[:-1], reduced[1:]], axis=-1)]
    expected = np.array(areas) / sum(areas) / grid.columns
    np.testing.assert_allclose(grid.cell_share, expected, rtol=1e-9)
    if kind == "equal-area":
        np.testing.assert_allclose(grid.cell_share, 1 / (grid.rows * grid.columns), rtol=1e-9)


@given(st.floats(-1.0, 1.0), st.floats(0.1, 1.0))
def test_latitude_of_an_area_is_the_inverse(area, polar):
    latitude = latitude_of_area(area, polar)
    assert area_south_of(latitude, polar) == pytest.approx(area, abs=1e-12)


def test_a_figure_next_to_the_sphere_maps_as_the_sphere():
    times, mask = np.array([0.0, 9000.0]), Mask.constant(0.2)
    seen = view(inclined(), times, R, mask)
    sphere = coverage_map(seen, make_grid("equal-angle", 15))
    nearly = coverage_map(seen, make_grid("equal-angle", 15, 1 - 1e-13))
    alike = (sphere.count_max == nearly.count_max) & (sphere.count_min == nearly.count_min)
    assert alike.mean() > 0.9  # all but centres on a rim
    for name in DOPS:
        one, other = (d[name].values[:, alike.values] for d in (sphere, nearly))
        np.testing.assert_allclose(one, other, rtol=1e-5)


def test_counts_alone_are_refused_and_the_file_names_the_figure(tmp_path):
    import xarray as xr
    from pyproj import CRS

    grid = make_grid("equal-angle", 30, POLAR)
    seen = view(inclined(), [0.0, 9000.0], R)
    with pytest.raises(ArgumentError, match="cells on an ellipsoid; use coverage_map"):
        count_map(seen, grid)
    write_map(coverage_map(seen, grid), tmp_path / "m.nc", FIGURE, series=(seen, grid))
    with xr.open_dataset(tmp_path / "m.nc", engine="h5netcdf") as back:
        figure = CRS.from_cf(back.mars.attrs).ellipsoid
        assert figure.semi_minor_metre == pytest.approx(FIGURE.polar_radius)
        np.testing.assert_array_equal(back.count_series.max("time"), back.count_max)
        np.testing.assert_allclose(back.gdop_series.max("time"), back.gdop.sel(percentile=95))

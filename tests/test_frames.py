from datetime import datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer

from compass import frames

ELLIPSOID = frames.FIGURES["iau-ellipsoid"]
latitudes = st.floats(-np.pi / 2, np.pi / 2)
longitudes = st.floats(-np.pi + 1e-9, np.pi)


@pytest.mark.parametrize("year", [1990, 2000, 2026, 2040])
def test_rotation_of_mars_equals_another_program(year):
    brahe = pytest.importorskip("brahe")
    when = datetime(year, 5, 6, 7, 8, 9)
    theirs = brahe.rotation_icrf_to_body_fixed_iau(
        499, brahe.Epoch.from_datetime(year, 5, 6, 7, 8, 9.0, 0.0, brahe.TDB)
    )
    seconds = frames.seconds_past_j2000(when)
    inertial = frames.mci_from_icrf(seconds)
    ours = frames.mcmf_from_mci(inertial.T, frames.prime_meridian_angle(seconds)).T
    # W grows by 351 deg a day: over 40 years 5e6 deg, rounded to 1e-9 deg
    assert np.abs(ours - theirs).max() < 2e-11


def test_inertial_axes_are_right_handed_and_orthonormal():
    m = frames.mci_from_icrf(1e8)
    np.testing.assert_allclose(m @ m.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(m) == pytest.approx(1.0)
    ra, dec = frames.spin_pole(1e8)
    np.testing.assert_allclose(m[2], frames.direction(dec, ra), atol=1e-15)


@given(latitudes, longitudes)
def test_direction_and_back(lat, lon):
    back_lat, back_lon = frames.latitude_longitude(frames.direction(lat, lon))
    assert back_lat == pytest.approx(lat, abs=2e-8)  # asin-like near the pole: sqrt(eps)
    if abs(lat) < 1.57:
        assert back_lon == pytest.approx(lon, abs=1e-12)


@given(latitudes)
def test_planetographic_and_back(lat):
    graphic = frames.planetographic_latitude(lat, ELLIPSOID)
    assert frames.planetocentric_latitude(graphic, ELLIPSOID) == pytest.approx(lat, abs=1e-12)
    assert abs(graphic) >= abs(lat) - 1e-15


def test_planetographic_latitude_equals_pyproj():
    to_graphic = Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        "+step +inv +proj=geoc +a=3396190 +b=3376200 "
        "+step +proj=unitconvert +xy_in=rad +xy_out=deg"
    )
    _, graphic = to_graphic.transform(10.0, 45.0)
    ours = np.degrees(frames.planetographic_latitude(np.radians(45.0), ELLIPSOID))
    assert ours == pytest.approx(graphic, abs=1e-9)


@given(latitudes, longitudes)
def test_local_axes_are_orthonormal_and_east_is_level(lat, lon):
    enu = frames.east_north_up(lat, lon)
    np.testing.assert_allclose(enu @ enu.T, np.eye(3), atol=1e-14)
    assert enu[0, 2] == 0.0
    assert enu[1, 2] >= 0.0


@pytest.mark.parametrize("name", list(frames.FIGURES))
def test_crs_has_the_radius_of_its_figure(name):
    crs = frames.mars_crs(name)
    assert crs.ellipsoid.semi_major_metre == frames.FIGURES[name].equatorial_radius
    assert crs.ellipsoid.semi_minor_metre == frames.FIGURES[name].polar_radius
    assert crs.axis_info[1].direction == "east"


def test_world_map_keeps_areas():
    transformer = Transformer.from_crs(frames.mars_crs(), frames.map_crs(), always_xy=True)
    radius = frames.FIGURES["iau-sphere"].equatorial_radius

    def mapped_area(lat):
        lon, edge = np.linspace(-1, 1, 201), np.full(201, 1.0)
        outline_lon = np.concatenate([lon, edge, lon[::-1], -edge])
        lats = np.linspace(lat - 1, lat + 1, 201)
        outline_lat = np.concatenate(
            [np.full(201, lats[0]), lats, np.full(201, lats[-1]), lats[::-1]]
        )
        x, y = transformer.transform(outline_lon, outline_lat)
        return 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))

    for lat in (0.0, 40.0, 75.0):
        low, high = np.radians([lat - 1, lat + 1])
        true = radius**2 * np.radians(2.0) * (np.sin(high) - np.sin(low))
        assert mapped_area(lat) == pytest.approx(true, rel=1e-4)

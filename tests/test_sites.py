import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer

from compass import Mask, Site
from compass.errors import ArgumentError
from compass.frames import FIGURES


def test_position_on_the_ellipsoid_equals_pyproj():
    ellipsoid = FIGURES["iau-ellipsoid"]
    site = Site("x", np.radians(40.0), np.radians(-100.0), 3000.0, figure=ellipsoid)
    geocentric = "+proj=geocent +a=3396190 +b=3376200 +units=m"
    graphic = Transformer.from_crs("+proj=longlat +a=3396190 +b=3376200", geocentric)
    up = np.degrees(np.arctan((3396190 / 3376200) ** 2 * np.tan(np.radians(40.0))))
    np.testing.assert_allclose(
        site.r_mcmf, graphic.transform(-100.0, up, 3000.0), rtol=0, atol=1e-6
    )


def test_straight_up_is_the_zenith():
    site = Site("x", 0.7, 1.0, figure=FIGURES["iau-ellipsoid"])
    elevation, _ = site.elevation_azimuth(site.r_mcmf + 1e6 * site.enu_mcmf[2])
    assert elevation == pytest.approx(np.pi / 2, abs=1e-7)


@pytest.mark.parametrize(
    ("east", "north", "azimuth"), [(0, 1, 0), (1, 0, 90), (0, -1, 180), (-1, 0, 270)]
)
def test_azimuth_is_clockwise_from_north(east, north, azimuth):
    site = Site("x", 0.3, -2.0)
    point = site.r_mcmf + 1e5 * (east * site.enu_mcmf[0] + north * site.enu_mcmf[1])
    elevation, found = site.elevation_azimuth(point)
    assert np.degrees(found) % 360 == pytest.approx(azimuth, abs=1e-9)
    assert elevation == pytest.approx(0.0, abs=1e-9)


def test_horizon_hides_only_where_it_stands():
    mask = Mask(tuple(np.radians([0.0, 90.0, 180.0, 270.0])), tuple(np.radians([0, 30, 0, 0])))
    site = Site("x", 0.0, 0.0, mask=mask)
    level = np.radians(20.0)

    def at(azimuth):
        east, north, up = site.enu_mcmf
        a = np.radians(azimuth)
        flat = np.cos(level) * (np.sin(a) * east + np.cos(a) * north)
        return site.r_mcmf + 1e6 * (flat + np.sin(level) * up)

    assert not site.sees(at(90.0))
    assert site.sees(at(270.0))
    assert site.sees(at(20.0))
    assert not site.sees(at(70.0))


@given(st.floats(0, 2 * np.pi))
def test_mask_is_periodic(azimuth):
    mask = Mask((1.0, 3.0), (0.1, 0.4))
    assert mask.at(azimuth) == pytest.approx(mask.at(azimuth + 2 * np.pi), abs=1e-9)
    assert 0.1 - 1e-12 <= mask.at(azimuth) <= 0.4 + 1e-12
    assert (mask.lowest, mask.highest, mask.is_constant) == (0.1, 0.4, False)


@pytest.mark.parametrize(
    ("azimuth", "elevation", "message"),
    [
        ((), (), "at least one"),
        ((0.0, 1.0), (0.1,), "2 azimuths and 1 elevations"),
        ((1.0, 0.5), (0.1, 0.1), "increase"),
        ((0.0, 7.0), (0.1, 0.1), "increase"),
        ((0.0,), (1.6,), "below 90"),
        ((0.0,), (float("nan"),), "below 90"),
    ],
)
def test_impossible_masks_are_refused(azimuth, elevation, message):
    with pytest.raises(ArgumentError, match=message):
        Mask(azimuth, elevation)

"""Regions: what they contain, and exact fold restricted to them."""

import numpy as np
import pytest

from compass.coverage.fold import fold_extremes
from compass.coverage.region import GLOBE, convex_polygon, latitude_band, read_region
from compass.errors import ArgumentError
from compass.frames import direction

CAPS = np.random.default_rng(5).normal(size=(8, 3))


def places(n=6000):
    p = np.random.default_rng(2).normal(size=(n, 3))
    return p / np.linalg.norm(p, axis=1, keepdims=True)


@pytest.mark.parametrize(
    "text",
    [
        "lat:-20:35",
        "lat:50:90",
        "lat:-90:-10",
        "polygon:0,0;0,60;50,30",
        "polygon:-10,170;-10,-150;40,-160;30,175",
        "polygon:30,175;40,-160;-10,-150;-10,170",
    ],
)
@pytest.mark.parametrize("radius", [0.7, 1.3])
def test_extremes_in_a_region_against_samples(text, radius):
    region = read_region(text)
    found = fold_extremes(CAPS, radius, region)
    inside = places()[region.contains(places())]
    assert len(inside) > 50
    u = CAPS / np.linalg.norm(CAPS, axis=1, keepdims=True)
    fold = (inside @ u.T >= np.cos(radius)).sum(axis=1)
    assert (found.least, found.greatest) == (found.least_reached, found.greatest_reached)
    assert found.least <= fold.min()
    assert found.greatest >= fold.max()
    for place, value in ((found.least_place, found.least), (found.greatest_place, found.greatest)):
        assert region.contains(place)
        assert (u @ place >= np.cos(radius)).sum() == value


def test_a_region_inside_one_cell():
    found = fold_extremes([[0, 0, 1.0]], 1.0, latitude_band(np.radians(80), np.pi / 2))
    assert (found.least, found.greatest) == (1, 1)
    far = fold_extremes([[0, 0, 1.0]], 1.0, latitude_band(-np.pi / 2, np.radians(-80)))
    assert (far.least, far.greatest) == (0, 0)


def test_the_whole_band_is_the_globe():
    assert latitude_band(-np.pi / 2, np.pi / 2).is_globe
    assert GLOBE.contains(places()).all()


def test_contains_band_and_polygon():
    band = read_region("lat:-20:35")
    assert band.contains(direction(np.radians([-20.1, -19.9, 34.9, 35.1]), 1.0)).tolist() == [
        False,
        True,
        True,
        False,
    ]
    assert not band.is_mirrored
    assert read_region("lat:-20:20").is_mirrored
    octant = read_region("polygon:0,0;0,90;90,0")
    assert octant.contains(direction(np.radians(30), np.radians([10, 80, 100]))).tolist() == [
        True,
        True,
        False,
    ]
    assert octant.mars_fixed
    assert not octant.is_mirrored


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lat:10", "cannot be read"),
        ("lat:40:10", "southern one first"),
        ("lat:-100:10", "between -90 and 90"),
        ("lat:nan:10", "between -90 and 90"),
        ("polygon:0,0;0,10", "polygon of 2 corners: allowed 3 to 1000"),
        ("polygon:0,0;0,10;x,1", "cannot be read"),
        ("polygon:0,0;0,10;95,1", "between -90 and 90"),
        ("polygon:0,0;0,0;10,0", "corners 1 and 2 are one place"),
        ("polygon:0,0;0,20;5,10;20,10", "not convex"),
        ("polygon:0,0;0,20;20,20;10,10", "not convex"),
        ("circle:1", "unknown kind"),
    ],
)
def test_wrong_regions_are_refused(text, message):
    with pytest.raises(ArgumentError, match=message):
        read_region(text)


def test_a_star_of_five_points_is_not_convex():
    turns = np.radians(np.arange(5) * 144)
    with pytest.raises(ArgumentError, match="not convex"):
        convex_polygon(np.radians(20 * np.sin(turns)), np.radians(20 * np.cos(turns)))

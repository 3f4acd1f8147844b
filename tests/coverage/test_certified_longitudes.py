"""Polygons for ever: widths against dense longitudes, shares against a law and random points."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from compass.coverage.certified_longitudes import weighed_share, widths
from compass.coverage.certified_share import certified_share
from compass.coverage.certified_worst import certified_always
from compass.coverage.region import convex_polygon
from compass.errors import ArgumentError
from compass.frames import FIGURES, direction, planetocentric_latitude
from compass.orbits import walker_delta
from compass.sites import Mask
from tests.coverage.test_certified_share import on_the_globe, sampled

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]
OCTANT = convex_polygon([0.0, 0.0, math.pi / 2], [0.0, math.pi / 2, 0.0])
TRIANGLE = convex_polygon([0.0, 0.0, 1.0], [0.0, 1.5, 0.7])
ROUND_THE_POLE = convex_polygon([0.9, 0.7, 1.0], [0.0, 2.0, 4.2])


@given(
    st.lists(st.tuples(st.floats(-1.4, 1.4), st.floats(-3.1, 3.1)), min_size=3, max_size=3),
    st.floats(-1.5, 1.4),
    st.floats(1e-3, 0.1),
    st.sampled_from([SPHERE, ELLIPSOID]),
)
def test_widths_hold_those_of_every_latitude_of_a_belt(corners, south, wide, figure):
    try:
        region = convex_polygon(*np.transpose(corners))
    except ArgumentError:
        assume(False)
    e2 = 1.0 - (figure.polar_radius / figure.equatorial_radius) ** 2
    least, most = widths(region.normals, e2, np.array([south, south + wide]))
    longitudes = np.linspace(0.0, 2 * np.pi, 2000, endpoint=False)
    for part in (0.0, 0.3, 1.0):
        latitude = planetocentric_latitude(south + part * wide, figure)
        inside = region.contains(direction(np.full(longitudes.size, latitude), longitudes))
        width, error = 2 * np.pi * inside.mean(), 6 * 2 * np.pi / longitudes.size
        assert least[0] - error <= width <= most[0] + error


def law(south, north, near, seconds, boxes):
    """A share that falls with the sine of latitude, as near as asked for, in a hundred boxes a belt."""
    low = high = 1.0 - 0.5 * (math.sin(south) + math.sin(north))
    if boxes < 100 or seconds <= 0.0:
        return 0.0, 1.0, 0, "boxes" if seconds > 0.0 else "time"
    return max(low - 0.4 * near, 0.0), min(high + 0.5 * near, 1.0), 100, ""


@cache
def truth():
    """The triangle's share under that law, by a dense grid."""
    latitude = (np.arange(1500) + 0.5) / 1500 * TRIANGLE.latitudes()[1]
    longitude = np.linspace(0.0, 1.5, 1500)
    inside = TRIANGLE.contains(direction(latitude[:, np.newaxis], longitude)).mean(axis=1)
    area = inside * np.cos(latitude)
    return float((area * (1.0 - np.sin(latitude))).sum() / area.sum())


def bounds(width, **ends):
    """Bounds of the share of the triangle under that law."""
    wanted = {"budget_s": 60.0, "budget_boxes": 1e6, "level": None, "progress": lambda _: None}
    latitudes = TRIANGLE.latitudes()
    found = weighed_share(TRIANGLE.normals, 0.0, latitudes, law, width, **(wanted | ends))
    assert found[0] - 1e-4 <= truth() <= found[1] + 1e-4
    return found


@pytest.mark.parametrize("width", [0.3, 1e-2, 3e-3])
def test_bounds_hold_the_share_of_a_law_and_come_near(width):
    low, high, boxes, stopped = bounds(width)
    assert high - low <= width and not stopped and boxes


def test_what_ends_early_says_why_and_keeps_what_it_has():
    low, high, _, stopped = bounds(1e-4, budget_boxes=1e9)
    assert stopped == "resolution" and high - low < 2e-3
    low, high, boxes, stopped = bounds(1e-5, budget_boxes=2000)
    assert stopped == "boxes" and boxes <= 2000 and high - low < 0.12
    assert bounds(1e-5, budget_s=0.0)[2:] == (0, "time")
    low, high, _, stopped = bounds(1e-5, level=truth() + 0.05)
    assert high < truth() + 0.05 and not stopped


def test_a_polygon_needs_no_span_and_without_boxes_all_is_possible():
    pattern = walker_delta(9, 3, 1, inclination_deg=50, radius_km=12000)
    found = certified_share(pattern, 6.0, place=OCTANT, budget_boxes=0)
    assert (found.low, found.high, found.stopped) == (0.0, 1.0, "boxes")
    assert found.scope.startswith("for all time")


@pytest.mark.slow
@pytest.mark.parametrize("region", [OCTANT, ROUND_THE_POLE])
def test_shares_of_polygons_for_ever_meet_random_points(region):
    pattern, figure = walker_delta(15, 5, 1, inclination_deg=55, radius_km=20427), SPHERE
    options = {"mask": 0.1, "place": region, "figure": figure}
    found = certified_share(pattern, 4.0, width=1e-2, **options)
    generator = np.random.default_rng(5)
    places = on_the_globe(generator, 20_000)
    places = places[region.contains(direction(*places.T))][:1500]
    times = generator.uniform(0.0, 1e9, len(places))
    share, error = sampled(
        pattern, 4.0, "pdop", figure, Mask.constant(0.1), places, times
    )  # fmt: skip
    assert found.width <= 1e-2
    assert found.low - 4 * error <= share <= found.high + 4 * error
    # always is a claim about all its latitudes
    assert certified_always(pattern, 4.0, **options).outcome == "refuted"

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass import from_elements, rosette, walker_delta, walker_star
from compass.errors import ArgumentError
from compass.orbits import positions_mci
from compass.orbits.rosette import walker_phasing

SHELL = {"inclination": 0.8, "radius": 2e7}


def places(constellation, times=(0.0, 5000.0)):
    """Positions, sorted so that the order of the satellites does not matter."""
    r = positions_mci(constellation, times).reshape(constellation.size, -1)
    return r[np.lexsort(np.round(r, 1).T)]


def ballard(n, p, m, times=(0.0, 5000.0)):
    """Ballard's definition as he writes it: RAAN 2 pi i / P, phase m RAAN, i = 0 ... N-1."""
    i = np.arange(n)
    raan = 2 * np.pi * i / p
    return places(from_elements(2e7, 0, 0.8, raan, 0, float(m) * raan), times)


@pytest.mark.parametrize(
    ("n", "p", "m"),
    [(5, 5, 1), (8, 8, 6), (12, 3, Fraction(1, 4)), (12, 3, Fraction(7, 4)), (15, 3, Fraction(4, 5)),
     (14, 7, Fraction(11, 2)), (6, 3, Fraction(5, 2))],
)  # fmt: skip
def test_rosette_is_ballards_definition_and_walkers_pattern(n, p, m):
    made = places(rosette(n, p, m, **SHELL))
    np.testing.assert_allclose(made, ballard(n, p, m), atol=1e-3)
    f = walker_phasing(n, p, m)
    assert f == (m * n / p) % p
    np.testing.assert_allclose(made, places(walker_delta(n, p, f, **SHELL)), atol=1e-3)


def test_both_multipliers_of_a_fractional_rosette_are_one_pattern():
    one, other = (places(rosette(12, 3, m, **SHELL)) for m in ("1/4", "7/4"))
    np.testing.assert_allclose(one, other, atol=1e-3)


@pytest.mark.parametrize(
    ("n", "p", "m", "message"),
    [
        (12, 3, "1/3", "multiples of planes/satellites = 1/4"),
        (12, 3, "1/2", "share a place"),
        (12, 5, 1, "do not divide"),
        (12, 3, 0, "share a place"),
    ],
)
def test_impossible_rosettes_are_refused(n, p, m, message):
    with pytest.raises(ArgumentError, match=message):
        rosette(n, p, m, **SHELL)


@given(st.integers(1, 6), st.integers(1, 6), st.data())
def test_delta_phasing_is_modulo_planes(planes, per_plane, data):
    f = data.draw(st.integers(0, planes - 1))
    t = planes * per_plane
    one, other = (places(walker_delta(t, planes, g, **SHELL)) for g in (f, f + planes))
    np.testing.assert_allclose(one, other, atol=1e-3)


@given(st.integers(1, 6), st.integers(1, 6), st.data())
def test_delta_goes_into_itself_when_turned_by_a_plane(planes, per_plane, data):
    f = data.draw(st.integers(0, planes - 1))
    c = walker_delta(planes * per_plane, planes, f, **SHELL)
    turned = from_elements(
        c.semi_major_axis, 0, c.inclination, c.raan + 2 * np.pi / planes, 0,
        c.mean_anomaly + 2 * np.pi * f / c.size,
    )  # fmt: skip
    np.testing.assert_allclose(places(turned), places(c), atol=1e-3)


def test_star_spreads_its_nodes_over_half_the_equator():
    c = walker_star(66, 6, 3, inclination=1.5, radius=2e7)
    assert np.degrees(np.unique(c.raan)) == pytest.approx([0, 30, 60, 90, 120, 150])
    assert c.pattern.notation == "85.9437°: 66/6/3"


def test_seed_pattern_is_the_published_one():
    c = walker_delta(15, 5, 1, inclination=np.radians(45), radius=20427e3)
    assert np.degrees(np.unique(np.round(c.raan, 9))) == pytest.approx([0, 72, 144, 216, 288])
    assert np.degrees(c.mean_anomaly[:6]) == pytest.approx([0, 120, 240, 24, 144, 264])
    assert c.satellite_names[3] == "P2S1"
    assert c.is_circular


def test_uneven_planes_are_refused_with_the_remedy():
    with pytest.raises(
        ArgumentError, match="15 satellites do not divide into 4 planes; use one of 1, 3, 5, 15"
    ):
        walker_delta(15, 4, 1, **SHELL)
    with pytest.raises(ArgumentError, match="at least 1"):
        walker_delta(0, 4, 1, **SHELL)


def test_losing_satellites():
    c = walker_delta(15, 5, 1, **SHELL)
    left = c.without([0, 14])
    assert left.size == 13
    assert left.satellite_names == c.satellite_names[1:14]
    assert left.pattern is None


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ((-1.0, 0, 0, 0, 0, 0), "must be positive"),
        ((2e7, 1.0, 0, 0, 0, 0), "allowed 0 up to below 1"),
        ((2e7, np.nan, 0, 0, 0, 0), "finite"),
    ],
)
def test_impossible_elements_are_refused(elements, message):
    with pytest.raises(ArgumentError, match=message):
        from_elements(*elements)


def test_names_must_be_as_many_as_satellites():
    with pytest.raises(ArgumentError, match="2 names for 1 satellites"):
        from_elements(2e7, 0, 0, 0, 0, 0, satellite_names=["a", "b"])

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass import from_elements, rosette, schema, walker_delta, walker_star
from compass.errors import ArgumentError, DesignError
from compass.frames import FIGURES
from compass.inputs.design import read_design_text
from compass.orbits import keplerian, positions_mci
from compass.orbits.constellation import ELEMENTS, from_pattern
from compass.orbits.kinds import KINDS, kind_of, walker_phasing

SHELL = {"inclination_deg": 45.0, "radius_km": 2e4}


def places(constellation, times=(0.0, 5000.0)):
    """Positions, sorted so that the order of the satellites does not matter."""
    r = positions_mci(constellation, times).reshape(constellation.size, -1)
    return r[np.lexsort(np.round(r, 1).T)]


def ballard(n, p, m, times=(0.0, 5000.0)):
    """Ballard's definition as he writes it: RAAN 2 pi i / P, phase m RAAN, i = 0 ... N-1."""
    i = np.arange(n)
    raan = 2 * np.pi * i / p
    return places(keplerian(2e7, 0, np.pi / 4, raan, 0, float(m) * raan), times)


@pytest.mark.parametrize(
    ("n", "p", "m"),
    [(5, 5, 1), (8, 8, 6), (12, 3, Fraction(1, 4)), (12, 3, Fraction(7, 4)), (15, 3, Fraction(4, 5)),
     (14, 7, Fraction(11, 2)), (6, 3, Fraction(5, 2))],
)  # fmt: skip
def test_rosette_is_ballards_definition_and_walkers_pattern(n, p, m):
    made = places(rosette(n, p, m, **SHELL))
    np.testing.assert_allclose(made, ballard(n, p, m), rtol=0, atol=1e-3)
    f = walker_phasing(n, p, m)
    assert f == (m * n / p) % p
    np.testing.assert_allclose(made, places(walker_delta(n, p, f, **SHELL)), rtol=0, atol=1e-3)


def test_both_multipliers_of_a_fractional_rosette_are_one_pattern():
    one, other = (places(rosette(12, 3, m, **SHELL)) for m in ("1/4", "7/4"))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-3)


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
def test_delta_goes_into_itself_when_turned_by_a_plane(planes, per_plane, data):
    f = data.draw(st.integers(0, planes - 1))
    c = walker_delta(planes * per_plane, planes, f, **SHELL)
    turned = keplerian(
        c.semi_major_axis, 0, c.inclination, c.raan + 2 * np.pi / planes, 0,
        c.mean_anomaly + 2 * np.pi * f / c.size,
    )  # fmt: skip
    np.testing.assert_allclose(places(turned), places(c), rtol=0, atol=1e-3)


def test_star_spreads_its_nodes_over_half_the_equator():
    c = walker_star(66, 6, 3, inclination_deg=85.9, radius_km=20000)
    assert np.degrees(np.unique(c.raan)) == pytest.approx([0, 30, 60, 90, 120, 150])
    assert c.pattern.notation == "85.9°: 66/6/3"


def test_seed_pattern_is_the_published_one():
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    assert np.degrees(np.unique(np.round(c.raan, 9))) == pytest.approx([0, 72, 144, 216, 288])
    assert np.degrees(c.mean_anomaly[:6]) == pytest.approx([0, 120, 240, 24, 144, 264])
    assert c.satellite_names[3] == "P2S1"
    assert c.is_circular


def test_uneven_planes_are_refused_with_the_remedy():
    with pytest.raises(
        ArgumentError, match="15 satellites do not divide into 4 planes; use one of 1, 3, 5, 15"
    ):
        walker_delta(15, 4, 1, **SHELL)
    with pytest.raises(ArgumentError, match="satellites = 0: must be a whole number from 1"):
        walker_delta(0, 4, 1, **SHELL)


def test_losing_satellites():
    c = walker_delta(15, 5, 1, **SHELL)
    left = c.without([0, 14])
    assert left.size == 13
    assert left.satellite_names == c.satellite_names[1:14]
    assert left.pattern is None
    for lost, told in ([99], "lost = 99: allowed 0 to 14"), ([0, -1], "lost = -1: allowed 0 to 14"):
        with pytest.raises(ArgumentError, match=told):
            c.without(lost)
    nobody = c.without(range(15))
    assert nobody.size == 0 and nobody.pattern is None
    with pytest.raises(ArgumentError, match="lost = 0: there are no satellites"):
        nobody.without([0])


@given(
    make=st.sampled_from([walker_delta, walker_star]),
    planes=st.integers(1, 7),
    per_plane=st.integers(1, 5),
    data=st.data(),
)
def test_the_pattern_is_found_in_the_elements_alone(make, planes, per_plane, data):
    f = data.draw(st.integers(0, planes - 1))
    node, phase = (data.draw(st.floats(0, 359.9)) for _ in range(2))
    made = make(planes * per_plane, planes, f, **SHELL, raan_deg=node, phase_deg=phase)
    c = keplerian(*(getattr(made, name) for name in ELEMENTS))
    found = c.pattern
    assert (found.satellites, found.planes, found.phasing) == (planes * per_plane, planes, f)
    assert found.kind == ("walker-star" if make is walker_star and planes > 1 else "walker-delta")
    assert np.degrees([found.raan, found.phase]) == pytest.approx([node, phase], abs=1e-9)
    assert found.deviation < 1e-13
    again = from_pattern(found, 2e7)
    for name in ELEMENTS:
        np.testing.assert_allclose(getattr(again, name), getattr(c, name), atol=1e-12)


@given(
    element=st.sampled_from(["raan", "mean_anomaly", "inclination"]),
    which=st.integers(0, 14),
    size=st.floats(2e-8, 3.0),
)
def test_one_satellite_out_of_place_and_there_is_no_pattern(element, which, size):
    c = walker_delta(15, 5, 1, **SHELL)
    values = getattr(c, element).copy()
    values[which] += size
    assert dataclasses.replace(c, **{element: values}).pattern is None


def test_what_is_no_pattern_of_circles_has_none():
    c = walker_delta(6, 3, 1, **SHELL)
    assert dataclasses.replace(c, eccentricity=np.full(6, 0.1)).pattern is None
    assert dataclasses.replace(c, semi_major_axis=np.arange(6) + 2e7).pattern is None
    moved = dataclasses.replace(c, raan=c.raan + 1e-12 * np.arange(6))
    assert moved.pattern.deviation == pytest.approx(5e-12, rel=1e-3)


def test_constellations_compare_and_hash_by_value():
    one, same = (walker_delta(6, 3, 1, **SHELL) for _ in range(2))
    assert one == same and hash(one) == hash(same) and len({one, same}) == 1
    assert one != walker_delta(6, 3, 2, **SHELL) and one != "6/3/1"
    with pytest.raises(ValueError, match="read-only"):
        one.raan[0] = 1.0
    angles = np.array(one.raan)
    copied = dataclasses.replace(one, raan=angles)
    angles[0] = 5.0
    assert copied == one


def test_constellations_join():
    one = walker_delta(3, 1, 0, **SHELL)
    other = from_elements(
        semi_major_axis_km=9000, inclination_deg=[10, 20], satellite_names=["a", "b"]
    )
    both = one + other
    assert (
        both.size == 5 and both.satellite_names[-1] == "b" and both.name.endswith("+ constellation")
    )
    assert np.array_equal(both.semi_major_axis[3:], [9e6, 9e6])
    with pytest.raises(ArgumentError, match=r"called .*P1S1; give each constellation its own name"):
        one + one
    twice = one + dataclasses.replace(one, name="again")
    assert twice.satellite_names[3] == "again P1S1" and twice.size == 6
    with pytest.raises(ArgumentError, match="different epochs or gravitational"):
        one + dataclasses.replace(other, epoch=5.0)
    with pytest.raises(ArgumentError, match="int: only constellations join by"):
        one + 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"inclination_deg": 45},
            "exactly one of radius_km, altitude_km, orbit and repeat; found none",
        ),
        ({"inclination_deg": 45, "radius_km": 1e4, "orbit": "x"}, "found radius_km and orbit"),
        (
            {"inclination_deg": 45, "orbit": "synchronous"},
            "orbit = 'synchronous': allowed areosync",
        ),
        ({"inclination_deg": 45, "repeat": (1, 0)}, "must be two whole numbers from 1 to 1000"),
        ({"inclination_deg": 45, "repeat": (99, 1)}, "so many revolutions need a radius of 954.5"),
        ({"inclination_deg": 45, "radius_km": 3000}, r"radius_km = 3000: is not above.*3396.19 km"),
        ({"inclination_deg": 45, "altitude_km": -5}, "altitude_km = -5: .* must be more than 0 km"),
        ({"inclination_deg": 45, "radius_km": np.nan}, "radius_km = nan: must be a finite number"),
        ({"inclination_deg": 181, "radius_km": 1e4}, "inclination_deg = 181: allowed 0 to 180"),
        (
            {"inclination_deg": np.nan, "radius_km": 1e4},
            "inclination_deg = nan: must be a finite number",
        ),
    ],
)
def test_impossible_orbits_are_refused_in_degrees_and_kilometres(options, message):
    with pytest.raises(ArgumentError, match=message):
        walker_delta(3, 1, 0, **options)


def test_elements_in_degrees_and_kilometres():
    c = from_elements(semi_major_axis_km=2e4, eccentricity=0.1, inclination_deg=[0, 90])
    assert c.semi_major_axis[1] == 2e7 and c.inclination[1] == np.pi / 2
    with pytest.raises(ArgumentError, match="periapsis radius 3000 km is not above the surface"):
        from_elements(semi_major_axis_km=6e3, eccentricity=0.5, inclination_deg=0)
    with pytest.raises(ArgumentError, match="inclination_deg = -1: allowed 0 to 180 degrees"):
        from_elements(semi_major_axis_km=6e3, inclination_deg=[0, -1])


def test_altitudes_count_from_the_figure():
    one = walker_delta(1, 1, 0, inclination_deg=0, altitude_km=1000)
    assert one.semi_major_axis[0] == pytest.approx(4396.19e3)
    kelly = FIGURES["kelly2018-sphere"]
    other = walker_delta(1, 1, 0, inclination_deg=0, altitude_km=1000, figure=kelly)
    assert other.semi_major_axis[0] == pytest.approx(4396.2e3)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_kind_is_written_and_read_and_says_what_it_takes(kind):
    assert kind_of(kind.name) is kind and kind.title and kind.node_spread > 0
    text = 'name = "x"\n[constellation]\n' + f'pattern = "{kind.name}"\norbit = "areosynchronous"\n'
    tables = schema("design").to_dict()["$defs"].values()
    (table,) = [
        t for t in tables if t.get("properties", {}).get("pattern", {}).get("const") == kind.name
    ]
    assert table["description"] == f"{kind.title}."
    given_values = {"satellites": 6, "planes": 3, "phasing": 1, "multiplier": '"1/2"'}
    for parameter in kind.parameters:
        assert parameter.meaning and parameter.unit in ("1", "deg")
        value = given_values.get(parameter.name, 10.5)
        assert isinstance(value, int) or parameter.form != "whole"
        told = table["properties"][parameter.name]
        assert told["description"] == parameter.meaning
        assert told.get("minimum") == parameter.least and told.get("maximum") == parameter.most
        assert (parameter.name in table["required"]) == (parameter.default is None)
        text += f"{parameter.name} = {value}\n"
    assert kind.third in [parameter.name for parameter in kind.parameters]
    c = read_design_text(text).constellation
    assert (c.pattern.satellites, c.pattern.planes, c.pattern.phasing) == (6, 3, 1)
    assert c.pattern.node_spread == kind.node_spread
    assert np.degrees(c.pattern.phase) == pytest.approx(10.5)
    with pytest.raises(
        ArgumentError, match="pattern = 'other': allowed walker-delta, walker-star, ro"
    ):
        kind_of("other")


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
        keplerian(*elements)


def test_names_must_be_as_many_as_satellites():
    with pytest.raises(ArgumentError, match="2 names for 1 satellite"):
        keplerian(2e7, 0, 0, 0, 0, 0, satellite_names=["a", "b"])


@pytest.mark.parametrize("phasing", [-1, 5, 7])
@pytest.mark.parametrize("make", [walker_delta, walker_star])
def test_a_phasing_is_refused_as_files_refuse_it(make, phasing):
    """One rule and one sentence for a design file and for Python."""
    text = (
        'name = "x"\n[constellation]\npattern = "walker-delta"\nsatellites = 15\nplanes = 5\n'
        f"phasing = {phasing}\ninclination_deg = 45\nradius_km = 20428\n"
    )
    with pytest.raises(ArgumentError, match=f"write {phasing % 5}") as by_python:
        make(15, 5, phasing, inclination_deg=45, radius_km=20428)
    with pytest.raises(DesignError, match="phasing") as by_file:
        read_design_text(text)
    if phasing >= 0:
        assert str(by_file.value).endswith(str(by_python.value))

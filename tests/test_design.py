"""A design is what it holds: made in Python without a file, equal by value."""

from dataclasses import replace

import pytest

import compass
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.inputs import read_design_text

TEXT = """name = "Three"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 3
phasing = 1
inclination_deg = 50
altitude_km = 17000
raan_deg = 12
"""


def three():
    return compass.walker_delta(
        3, 3, 1, inclination_deg=50, altitude_km=17000, raan_deg=12, name="Three"
    )


def test_a_design_of_python_is_the_one_of_a_file():
    read, made = read_design_text(TEXT), compass.Design(three())
    assert replace(read, text="") == made
    assert hash(replace(read, text="")) == hash(made)
    assert made.digest != read.digest


def test_designs_differ_by_any_value():
    made = compass.Design(three())
    moved = compass.walker_delta(
        3, 3, 1, inclination_deg=50, altitude_km=17000, raan_deg=12.1, name="Three"
    )
    others = [replace(made, constellation=moved), replace(made, fold=3), replace(made, name="x")]
    assert len({made, *others}) == 4


def test_site_and_design_agree_on_the_figure():
    assert compass.Site("x", 0.0, 0.0).figure == compass.Design(three()).figure


def test_a_figure_goes_by_its_name_too():
    pattern = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    assert compass.Design(pattern, figure="kelly2018-sphere").figure is FIGURES["kelly2018-sphere"]
    with pytest.raises(ArgumentError, match="figure = 'moon': not known; allowed iau-sphere"):
        compass.Design(pattern, figure="moon")


def test_orbits_and_sites_take_a_figures_name_too():
    by_name = compass.walker_delta(
        3, 3, 1, inclination_deg=50, altitude_km=17000, figure="kelly2018-sphere"
    )
    assert by_name.semi_major_axis[0] == FIGURES["kelly2018-sphere"].equatorial_radius + 17e6
    assert compass.Site("x", 0.0, 0.0, figure="iau-ellipsoid").figure is FIGURES["iau-ellipsoid"]
    moon = {"figure": "moon", "inclination_deg": 50}
    for make in (
        lambda: compass.walker_delta(3, 3, 1, altitude_km=17000, **moon),
        lambda: compass.from_elements(semi_major_axis_km=9000, **moon),
        lambda: compass.Site("x", 0.0, 0.0, figure="moon"),
    ):
        with pytest.raises(ArgumentError, match="figure = 'moon': not known; allowed iau-sphere"):
            make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: compass.Site("Gale", -4.6, 137.4), "latitude = -4.6 rad: .* Site.of takes deg"),
        (
            lambda: compass.Site.of("x", latitude_deg=91, longitude_deg=0),
            "latitude_deg = 91: allowed -90 to 90",
        ),
        (
            lambda: compass.Site.of("x", latitude_deg=0, longitude_deg=0, height_km=3396),
            "height_km = 3396: allowed -10 to 30",
        ),
        (lambda: compass.Mask.of([5, 12]), "mask_deg = .5, 12.: must be an elevation, or pairs"),
        (lambda: compass.Mask.of([(0, 5), (1,)]), "must be an elevation, or pairs of azimuth"),
        (lambda: compass.Mask.of("low"), "mask_deg = low: must be an elevation, or pairs"),
        (lambda: compass.Mask.of(90), "elevations .90.0. deg; allowed 0 up to below 90"),
        (lambda: compass.Requirement.of("r"), "requirement r: asks for nothing; add fold or one"),
        (
            lambda: compass.Requirement.of("r", edop_at_most=3),
            "edop_at_most: unknown; allowed pdop",
        ),
        (lambda: compass.Requirement.of("r", pdop_at_most=0.5), "pdop_at_most = 0.5: allowed 1 to"),
        (lambda: compass.Requirement.of("r", fold=4, share=97), "share = 97: allowed above 0 to 1"),
    ],
)
def test_what_cannot_be_is_refused_with_its_unit(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


def test_stations_and_requirements_of_python_are_those_of_a_file():
    table = """
[coverage]
mask_deg = 5
[[station]]
name = "Gale"
latitude_deg = -4.6
longitude_deg = 137.4
height_km = -4
horizon_deg = [[0, 5], [180, 12]]
[[requirement]]
name = "work"
sites = ["Gale"]
mask_deg = 10
pdop_at_most = 6
share = 0.9
"""
    horizon = [(0, 5), (180, 12)]
    gale = compass.Site.of(
        "Gale", latitude_deg=-4.6, longitude_deg=137.4, height_km=-4, mask_deg=horizon
    )
    work = compass.Requirement.of("work", sites=[gale], mask_deg=10, pdop_at_most=6, share=0.9)
    made = compass.Design(three(), mask=compass.Mask.of(5), stations=[gale], requirements=[work])
    assert hash(made) == hash(replace(made, stations=(gale,)))  # lists will do
    assert replace(read_design_text(TEXT + table), text="") == made


def test_a_number_of_a_design_is_varied_by_its_key_in_files():
    """As if it had been written so: laid out anew by the constructor, the rest as it was."""
    made = compass.Design(three(), "Mine", fold=2, paper="kelly2018", stations=[
        compass.Site.of("x", latitude_deg=1, longitude_deg=2)
    ])  # fmt: skip
    moved = made.varied(inclination_deg=40, mask_deg=5)
    assert moved.constellation == compass.walker_delta(
        3, 3, 1, inclination_deg=40, altitude_km=17000, raan_deg=12,
        name="Three, inclination 40 deg",
    )  # fmt: skip
    assert moved.mask == compass.Mask.of(5) and moved.fold == 2 and moved.stations == made.stations
    assert moved.name == "Mine, inclination 40 deg" and moved.paper is None
    assert made.varied(fold=3, mask_deg=0) == replace(made, fold=3)
    higher = made.varied(orbit="areosynchronous", planes=1, phasing=0).constellation
    assert higher.repeat == (1, 1) and higher.pattern.planes == 1
    unnamed = compass.Design(compass.walker_delta(3, 3, 1, inclination_deg=50, radius_km=2e4))
    assert unnamed.varied(radius_km=21000).name == unnamed.name == "50°: 3/3/1"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"inclination": 40}, "inclination: unknown; did you mean inclination_deg?"),
        ({"colour": 1}, "colour: unknown; allowed satellites, planes, phasing"),
        ({"planes": 2}, "3 satellites do not divide into 2 planes"),
        ({"inclination_deg": "40"}, "inclination_deg = '40': must be a finite number"),
        ({"radius_km": 2e7}, "radius_km = 2e.07: allowed up to 1e.06 km"),
        ({"mask_deg": 95}, "elevations .* allowed 0 up to below 90"),
        ({"fold": 1.5}, "fold = 1.5: must be a whole number from 1 on"),
    ],
)
def test_what_cannot_be_varied_is_refused(changes, message):
    with pytest.raises(ArgumentError, match=message):
        compass.Design(three()).varied(**changes)


def test_orbits_of_their_own_have_no_number_to_vary():
    single = compass.from_elements(semi_major_axis_km=9000, eccentricity=0.1, inclination_deg=1)
    with pytest.raises(ArgumentError, match="radius_km: the orbits of constellation form no patt"):
        compass.Design(single).varied(radius_km=9500)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"mask": 5}, r"mask = 5: must be a Mask; make it of degrees, Mask.of\(5\)"),
        ({"fold": 0}, "fold = 0: must be a whole number from 1 on"),
        ({"fold": "4"}, "fold = '4': must be a whole number"),
        ({"stations": ["Gale=1,2"]}, "stations = 'Gale=1,2': must be a Site"),
        ({"requirements": [4]}, "requirements = 4: must be a Requirement"),
    ],
)
def test_a_design_refuses_what_it_cannot_hold(fields, message):
    with pytest.raises(ArgumentError, match=message):
        compass.Design(three(), **fields)
    with pytest.raises(ArgumentError, match="constellation = 'x': must be a Constellation"):
        compass.Design("x")


def test_things_say_in_a_line_what_they_are(designs):
    pattern = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    words = "walker-delta 45°: 15/5/1, 15 satellites in 5 planes at 20427 km"
    assert repr(pattern) == f"Constellation {words}"
    assert repr(pattern.without([0])) == (
        "Constellation 45°: 15/5/1: 14 satellites on orbits of their own, 20427 to 20427 km from "
        "the centre"
    )
    assert pattern.without(range(15)).words == "0 satellites"
    gale = compass.Site.of("Gale", latitude_deg=-4.6, longitude_deg=137.4, mask_deg=10)
    mask = compass.Mask.of([(0, 5), (180, 12)])
    assert repr(compass.Design(pattern, "Mine", mask=mask, stations=[gale])) == (
        f"Design Mine: {words}; 4 wanted in view above 5 to 12 deg, two-body motion, IAU 2015 "
        "sphere, 1 station"
    )
    assert repr(gale).startswith("Site Gale: 4.6° S, 137.4° E, height 0 km")
    for read, name in ((compass.read_scenario, "landing"), (compass.read_study, "study-small")):
        line = repr(read(designs / f"{name}.toml"))
        assert "\n" not in line and "array" not in line and len(line) < 200


def test_a_design_of_python_has_the_text_of_a_file():
    """What a result was made from stands in it, and tells one design from another."""
    one, other = (compass.Design(three(), name) for name in ("one", "other"))
    shown, again = compass.show(one).design, compass.show(other).design
    assert shown.digest != again.digest and read_design_text(shown.text) == replace(
        shown, constellation=replace(shown.constellation, name="one")
    )
    heavier = compass.Design(replace(three(), gm=4e13))  # which no file can say
    assert compass.show(heavier).design.text == ""


def test_only_constellations_join(designs):
    design = compass.read_design(designs / "compass-15-5-1.toml")
    with pytest.raises(ArgumentError, match=r"designs do not add, .*\(one\.constellation \+ other"):
        design + design
    with pytest.raises(ArgumentError, match=r"\+ Design: only constellations join by \+; .*\.cons"):
        three() + design
    with pytest.raises(ArgumentError, match=r"Three \+ int: only constellations join"):
        three() + 3


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"satellite_names": ()}, "satellite_names: 0 names for 3 satellites"),
        ({"satellite_names": ("a", "b", "c", "d")}, "satellite_names: 4 names for 3 satellites"),
        ({"raan": [0.0, 1.0]}, r"raan: shape \(2,\) for 3 satellites"),
        ({"inclination": 0.5}, r"inclination: shape \(\) for 3 satellites"),
        ({"mean_anomaly": [0.0, 1.0, float("nan")]}, "mean_anomaly = nan"),
        ({"eccentricity": [0.0, 0.0, 1.0]}, "eccentricity = 1.0: allowed 0 up to below 1"),
        ({"semi_major_axis": [2e7, 2e7, -2e7]}, "semi_major_axis = -20000000.0 m"),
    ],
)
def test_a_constellation_that_is_replaced_in_part_is_checked_like_any(changes, message):
    with pytest.raises(ArgumentError, match=message):
        replace(three(), **changes)
    assert replace(three(), satellite_names=("a", "b", "c")) != three()

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
        (lambda: compass.Requirement.of("r", pdop_at_most=0.5), "pdop_at_most = 0.5: allowed from"),
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

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

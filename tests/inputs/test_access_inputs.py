"""The tables of a design that concern access."""

import numpy as np
import pytest

from compass.bodies import SOLAR_DAY
from compass.errors import DesignError
from compass.inputs import read_design, read_design_text

BASE = """
name = "n"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 1
phasing = 0
inclination_deg = 0
orbit = "areosynchronous"
"""


def test_what_is_left_out_has_a_default():
    design = read_design_text(BASE)
    assert design.access.moons == ()
    assert not design.access.earth
    assert not design.access.crosslinks
    assert design.access_duration == 10 * SOLAR_DAY.value
    assert design.conjunction == pytest.approx(np.radians(2.0))
    assert design.radios == ()


def test_tables_become_things():
    design = read_design("designs/areostationary-relay.toml")
    assert design.access.earth
    assert design.access.crosslinks
    assert design.access.atmosphere_height == 80e3
    assert design.access_duration == 30 * SOLAR_DAY.value
    uhf, x_band = design.radios
    assert uhf.between == ("station", "satellite")
    assert uhf.frequency == 401.6e6
    assert x_band.required == 50.0
    assert read_design("designs/compass-15-5-1.toml").access.moons == ("phobos", "deimos")


def test_all_faults_come_together():
    text = (
        BASE
        + """
[access]
moons = ["luna"]
duration_sols = 0
[[station]]
name = "a"
latitude_deg = 91
longitude_deg = 0
horizon_deg = [[0, 8, 3], [60, 3]]
[[station]]
name = "a"
latitude_deg = 1
longitude_deg = 0
[[link]]
between = ["station"]
frequency_mhz = 400
eirp_dbw = 1
g_over_t_db_per_k = 1
"""
    )
    with pytest.raises(DesignError, match=r"access.moons\[1\] = 'luna'") as caught:
        read_design_text(text)
    said = "\n".join(caught.value.faults)
    for part in (
        "access.duration_sols = 0: must be above 0",
        "station[1].latitude_deg = 91: must be at most 90",
        "station[1].horizon_deg[1] = [0, 8, 3]",
        "station[2].name = 'a': used twice",
        "link[1].between",
    ):
        assert part in said


def test_a_moon_named_twice_is_refused():
    with pytest.raises(DesignError, match="names a moon twice"):
        read_design_text(BASE + '[access]\nmoons = ["phobos", "phobos"]\n')
    with pytest.raises(DesignError, match=r"access.duration_sols = 1000000000.0"):
        read_design_text(BASE + "[access]\nduration_sols = 1e9\n")

"""The true anomaly, against the place that the mean one leads to, in files and Python alike."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compass
from compass.errors import ArgumentError, DesignError
from compass.inputs import read_design_text
from compass.orbits import positions_mci
from compass.orbits.anomaly import mean_of_true

FILE = """name = "one"
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "S01"
semi_major_axis_km = 20000
eccentricity = {e!r}
inclination_deg = 30
argument_of_periapsis_deg = 50
"""


@given(st.floats(0, 0.8), st.floats(-360, 360))
def test_the_satellite_stands_at_its_true_anomaly(e, true_deg):
    c = compass.from_elements(
        semi_major_axis_km=20000, eccentricity=e, inclination_deg=30,
        argument_of_periapsis_deg=50, true_anomaly_deg=true_deg, name="one",
    )  # fmt: skip
    r = positions_mci(c, [0.0])[0, 0]
    u = np.radians(50 + true_deg)
    expected = np.array([np.cos(u), np.sin(u) * np.cos(np.pi / 6), np.sin(u) * np.sin(np.pi / 6)])
    assert r / np.linalg.norm(r) == pytest.approx(expected, abs=1e-12)
    read = read_design_text(FILE.format(e=e) + f"true_anomaly_deg = {true_deg!r}\n")
    assert read.constellation == c


@given(st.floats(0, 0.95), st.floats(-20, 20), st.floats(1e-6, 1))
def test_it_rises_with_the_mean_one_through_every_revolution(e, true, further):
    assert mean_of_true(true, e) < mean_of_true(true + further, e)
    assert mean_of_true(true + 2 * np.pi, e) - mean_of_true(true, e) == pytest.approx(2 * np.pi)


def test_one_anomaly_is_enough():
    both = "mean_anomaly_deg = 1\ntrue_anomaly_deg = 1\n"
    with pytest.raises(DesignError, match="has both mean_anomaly_deg and true_anomaly_deg"):
        read_design_text(FILE.format(e=0.1) + both)
    with pytest.raises(ArgumentError, match="has both mean_anomaly_deg and true_anomaly_deg"):
        compass.from_elements(
            semi_major_axis_km=2e4, inclination_deg=1, mean_anomaly_deg=1, true_anomaly_deg=1
        )

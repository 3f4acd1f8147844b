"""Cost proxies against limits, textbook numbers, vectors and the secular rates themselves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.bodies import MARS_GM
from compass.design import Launching
from compass.inputs.study_models import CostTable
from compass.orbits.deployment import WEIGHED, deploy_by_drift
from compass.study.candidates import ROW, make_constellation
from compass.study.cost import cost_figures, hohmann, node_change

R = 3396.19e3


def test_hohmann_of_the_textbook():
    # Vallado 2013, example 6-1: 191.34411 km to 35781.34857 km about the Earth, 3.935224 km/s
    earth, radius = 3.986004418e14, 6378.1363e3
    dv = hohmann(radius + 191344.11, radius + 35781348.57, earth)
    assert dv == pytest.approx(3935.224, abs=0.01)


def test_hohmann_limits():
    assert hohmann(4e6, 4e6) == 0.0
    escape = (np.sqrt(2) - 1) * np.sqrt(MARS_GM.value / 4e6)
    assert hohmann(4e6, 1e15) == pytest.approx(escape, rel=1e-3)
    small = hohmann(4e6, 4e6 * (1 + 1e-6))  # first order: n da / 2
    assert small == pytest.approx(0.5e-6 * np.sqrt(MARS_GM.value / 4e6), rel=1e-4)


@given(st.floats(3.5e6, 1e8), st.floats(3.5e6, 1e8))
def test_hohmann_either_way_costs_the_same(a, b):
    assert hohmann(a, b) == pytest.approx(hohmann(b, a), rel=1e-9, abs=1e-9)


@given(st.floats(0, np.pi), st.floats(-np.pi, np.pi))
def test_node_change_is_the_difference_of_velocities(inclination, turn):
    # at the common line of both planes the velocities are v (pole x line)
    def pole(raan):
        return np.array(
            [
                np.sin(inclination) * np.sin(raan),
                -np.sin(inclination) * np.cos(raan),
                np.cos(inclination),
            ]
        )

    a, b = pole(0.0), pole(turn)
    line = np.cross(a, b)
    norm = np.linalg.norm(line)
    if norm < 1e-7:  # one plane, or opposite senses in one
        return
    speed = np.sqrt(MARS_GM.value / 1e7)
    change = speed * np.linalg.norm(np.cross(a - b, line / norm))
    assert node_change(1e7, inclination, turn) == pytest.approx(change, rel=1e-6, abs=1e-3)


def test_node_change_limits():
    assert node_change(1e7, 0.0, 1.0) == 0.0
    assert node_change(1e7, np.pi / 2, np.pi) == pytest.approx(2 * np.sqrt(MARS_GM.value / 1e7))


def test_sums_over_satellites_one_by_one():
    kinds = [(0, 12, 4, 1), (1, 12, 4, 1), (0, 5, 5, 2), (1, 6, 3, 0), (0, 3, 1, 0)]
    rows = np.array([(*k, 50.0, 12870.0, 0.0) for k in kinds], ROW)
    found = cost_figures(rows, CostTable.model_validate({}), R)
    for k, row in enumerate(rows):
        c = make_constellation(row)
        turns = np.where(c.raan > np.pi, c.raan - 2 * np.pi, c.raan)
        each = node_change(12870e3, np.radians(50), turns)
        transfer = hohmann(R + 400e3, 12870e3)
        assert found["delta_v_total_m_s"][k] == pytest.approx((each + transfer).sum())
        assert found["delta_v_planes_m_s"][k] == pytest.approx(each.max())
    assert found["satellites"].tolist() == [12, 12, 5, 6, 3]


@pytest.mark.parametrize(
    ("kind", "launching"),
    [
        ((0, 15, 5, 1), Launching()),
        ((0, 15, 5, 1), Launching(satellites_a_launch=7, longest_wait=1e9)),
        ((0, 12, 3, 1), Launching(satellites_a_launch=1)),
        ((1, 12, 6, 1), Launching(waiting=(2e6, 3e7), longest_wait=4e7)),
        ((0, 12, 12, 1), Launching(longest_wait=1e5)),
    ],
)
def test_waiting_for_planes_costs_what_deploying_one_design_does(kind, launching):
    """`deploy_by_drift` goes through planes one by one."""
    rows = np.array([(*kind, i, 20427.7, 0.0) for i in (45.0, 63.0, 130.0)], ROW)
    found = cost_figures(rows, CostTable.model_validate({}), R, launching)
    for k, row in enumerate(rows):
        c = make_constellation(row)
        waiting = R + np.linspace(*launching.waiting, WEIGHED)
        each = launching.satellites_a_launch or c.size
        known = deploy_by_drift(c, R + launching.launched, waiting, each)
        best = known.cheapest(launching.longest_wait)
        if best is None:
            assert np.isnan(found["delta_v_deploy_m_s"][k])
            assert np.isnan(found["wait_days"][k])
        else:
            assert found["delta_v_deploy_m_s"][k] == pytest.approx(known.delta_v[best], rel=1e-12)
            assert found["wait_days"][k] * 86400 == pytest.approx(known.waits[best], rel=1e-9)

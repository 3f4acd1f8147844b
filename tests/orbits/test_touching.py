"""Ellipses that touch real orbits."""

import numpy as np
import pytest

import compass
from compass.coverage.lasting import least_margins
from compass.coverage.margin import highest_mask
from compass.coverage.symmetry import shortest_span
from compass.errors import ArgumentError, DesignError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import mci_from_icrf
from compass.inputs.scenario import read_scenario
from compass.orbits import states_mci
from compass.orbits.constellation import keplerian
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion
from compass.orbits.touching import touching

OBLATE = Motion(
    "numerical", ForceModel(built_in_field().truncated(2, 0), False, False, 0.0, "none")
)


def circle():
    return keplerian(9e6, 0.0, 0.7, 0.3, 0.0, [0.0, 2.0], epoch=9e8)


def test_an_ellipse_stays_the_ellipse_it_is():
    c = circle()
    assert touching(c, Motion(), 0.0) is c
    later = touching(c, Motion(), 0.3 * DAY)
    assert later.epoch == c.epoch + 0.3 * DAY
    turn = mci_from_icrf(later.epoch) @ mci_from_icrf(c.epoch).T
    there = states_mci(c, [0.3 * DAY + 600.0])[0][:, 0] @ turn.T
    assert states_mci(later, [600.0])[0][:, 0] == pytest.approx(there, abs=0.05)


def test_it_touches_in_place_and_speed_and_parts_with_the_square_of_time():
    c = circle()
    path = OBLATE.trajectory(c, 0.0, 0.2 * DAY)
    start = 0.1 * DAY
    flown = touching(c, OBLATE, start)
    turn = mci_from_icrf(flown.epoch) @ mci_from_icrf(c.epoch).T

    def apart(t):
        r = states_mci(flown, [t])[0][:, 0]
        return np.linalg.norm(r - path.states([start + t])[0][:, 0] @ turn.T, axis=-1).max()

    assert apart(0.0) < 1e-3
    assert apart(120.0) / apart(60.0) == pytest.approx(4.0, rel=0.1)


@pytest.mark.slow
def test_the_margin_on_the_ellipses_of_a_day_is_that_of_the_orbits(designs):
    """Twenty days on, fifteen resonant satellites have lost two degrees of their mask (own)."""
    c = compass.read_design(designs / "compass-15-5-1.toml").constellation
    sphere = 3396.2e3
    flown = touching(c, Motion("numerical"), 20 * DAY)
    margin = highest_mask(flown, 4, sphere_radius=sphere, span=shortest_span(flown))
    assert np.degrees(margin) == pytest.approx(4.3, abs=0.3)
    path = Motion("numerical").trajectory(c, 0.0, 21 * DAY)
    low, high = least_margins(path, 4, [20 * DAY, 21 * DAY], sphere_radius=sphere)[0]
    assert np.degrees(low) - 0.3 < np.degrees(margin) < np.degrees(high) + 0.3


def test_judge_flies_designs_on_the_ellipses_of_a_day(designs):
    from compass.api.judge import _on_day

    design = compass.Design(name="d", constellation=circle(), motion=OBLATE)
    flown = _on_day(design, 0.1)
    assert flown.constellation == touching(circle(), OBLATE, 0.1 * DAY)
    assert flown.motion == Motion()
    still = compass.Design(name="d", constellation=circle())
    assert _on_day(still, 0.0) is still
    for options, words in (
        ({"start_day": -1.0}, "start_day = -1"),
        ({"start_day": 1.0, "rival": "x.toml"}, "leave one out"),
    ):
        with pytest.raises(ArgumentError, match=words):
            compass.judge(design, scenario=designs / "landing.toml", **options)


def test_a_lander_flies_past_the_real_orbits(tmp_path, designs):
    text = (
        (designs / "compass-15-5-1.toml").read_text().replace("satellites = 15", "satellites = 5")
    )
    forces = '\n[motion]\nmodel = "numerical"\ngravity_degree = 2\nmoons = false\n'
    (tmp_path / "compass-15-5-1.toml").write_text(text + forces)
    start = "start_s = 43200"
    lander = (
        (designs / "landing.toml")
        .read_text()
        .replace('design = "compass-15-5-1.toml"', f'design = "compass-15-5-1.toml"\n{start}')
    )
    (tmp_path / "landing.toml").write_text(lander)
    (tmp_path / "schema").mkdir()
    read = read_scenario(tmp_path / "landing.toml")
    (orbiters,) = read.orbiters
    (same,) = read_scenario(tmp_path / "landing.toml", start_day=0.5).orbiters
    assert same == orbiters
    with pytest.raises(ArgumentError, match="start_day = 1: this scenario has been read"):
        compass.land(read, start_day=1)
    with pytest.raises(ArgumentError, match="start_day = -1: allowed 0 to 36525 days"):
        compass.land(tmp_path / "landing.toml", start_day=-1)
    with pytest.raises(DesignError, match=r"start_day = 1: no beacons\.design moves on"):
        compass.land(designs / "entry-ground-beacons.toml", start_day=1)
    design = compass.read_design(tmp_path / "compass-15-5-1.toml")
    assert orbiters.constellation.epoch == design.constellation.epoch + 43200.0
    path = design.motion.trajectory(design.constellation, 0.0, 0.5 * DAY)
    turn = mci_from_icrf(orbiters.constellation.epoch) @ mci_from_icrf(path.epoch).T
    r = states_mci(orbiters.constellation, [orbiters.start])[0][:, 0]
    assert r == pytest.approx(path.states([43200.0])[0][:, 0] @ turn.T, abs=0.01)

"""The report's sections on entry: what they say is what was found."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compass.api.land_flight import assess_scenario, entry_facts, entry_section
from compass.api.optimize import OptimizeResult, search_scenario
from compass.document import Table
from compass.entry.search import Optimum, Start
from compass.entry.trajectory import fly
from compass.errors import OutputError
from compass.inputs.scenario import read_scenario, read_scenario_text
from compass.pictures.files import check_folder, write_pictures

DESIGNS = Path(__file__).parents[2] / "designs"


@pytest.fixture(scope="module")
def coarse():
    text = (DESIGNS / "entry-ground-beacons.toml").read_text()
    text = text.replace("step_s = 1", "step_s = 24").replace("interval_s = 1", "interval_s = 24")
    return read_scenario_text(text.replace("[optimize]", "[optimize]\nstarts = 1\ngenerations = 2"))


def test_entry_section_and_facts(coarse):
    found = assess_scenario(coarse, 4)
    section = entry_section(coarse, found)
    assert [p.stem for p in section.pictures] == [
        "entry-map",
        "entry-flight",
        "entry-view",
        "entry-observability",
        "entry-navigation",
    ]
    assert all(p.png.startswith(b"\x89PNG") for p in section.pictures)
    assert "observable throughout" in " ".join(section.paragraphs)
    facts = entry_facts(coarse, found)
    assert facts["observability"]["degree_si_min"] == pytest.approx(1.5407080921e-8, rel=1e-7)
    table = section.tables[-1]
    assert len(table.rows[0]) == len(table.header)
    np.testing.assert_allclose(
        [row[6] for row in table.rows], found.bound.position_sigma[[0, 1, 2, 4, 5, 6, 8, 9, 10]]
    )


def test_longitudes_stay_within_a_turn():
    text = (DESIGNS / "entry-ground-beacons.toml").read_text()
    text = text.replace("step_s = 1", "step_s = 24").replace("interval_s = 1", "interval_s = 24")
    east = read_scenario_text(text.replace("longitude_deg = -89.872", "longitude_deg = 359.9"))
    found = assess_scenario(east, 2)
    facts = entry_facts(east, found)
    (event,) = facts["events"]  # some 10 degrees on, past 360
    assert 0 < event["longitude_deg"] < facts["end"]["longitude_deg"] < 20
    assert entry_section(east, found).tables[0].rows[0][-1] == event["longitude_deg"]


def test_diverged_runs_are_mentioned(coarse):
    found = assess_scenario(coarse, 4)
    lost = replace(found.monte_carlo, diverged=np.array([True, False, False, False]))
    section = entry_section(coarse, replace(found, monte_carlo=lost))
    assert any("1 of 4 runs diverged" in words for words in section.paragraphs)


def test_runs_whose_covariance_breaks_are_mentioned(coarse):
    found = assess_scenario(coarse, 4)
    nees = found.monte_carlo.nees.copy()
    nees[2, 5:] = np.nan
    broken = replace(found, monte_carlo=replace(found.monte_carlo, nees=nees))
    assert any("In 1 of 4 runs" in words for words in entry_section(coarse, broken).paragraphs)
    assert entry_facts(coarse, broken)["navigation"]["broken"] == 1
    assert entry_facts(coarse, found)["navigation"]["broken"] == 0


@pytest.mark.parametrize(("latitude", "mentioned"), [(-28.22, False), (89.99, True)])
def test_a_pole_is_mentioned(latitude, mentioned):
    text = (DESIGNS / "landing.toml").read_text()
    text = text.replace("duration_s = 320", "duration_s = 20\nstep_s = 5")
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")
    scenario = read_scenario_text(
        text.replace("latitude_deg = -28.22", f"latitude_deg = {latitude}")
    )
    found = assess_scenario(scenario, 4)
    said = any(
        "from the polar axis" in words for words in entry_section(scenario, found).paragraphs
    )
    assert said is mentioned


@pytest.mark.slow
def test_best_beacons_section(coarse):
    flight, found = search_scenario(coarse)
    result = OptimizeResult(coarse, flight, found)
    assert [p.stem for p in result.pictures()] == ["best-beacons", "best-convergence"]
    assert f"{found.value:.7g}" in str(result).splitlines()[0]


def test_best_places_are_drawn_and_listed(coarse):
    flight = fly(coarse.truth, coarse.state, coarse.times)
    places = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4]])
    start = Start(1.5e-8, places, (1e-10, 1.5e-8), 9)
    found = Optimum("delta", 1.5e-8, places, (start,), 0.1)
    result = OptimizeResult(coarse, flight, found)
    assert [p.stem for p in result.pictures()] == ["best-beacons", "best-convergence"]
    (table, _) = [b for b in result.document().blocks if isinstance(b, Table)]
    np.testing.assert_allclose(table.rows[0][1:], [-25.8, -82.7])


def test_the_same_scenario_gives_the_same_pictures(coarse):
    one, two = (entry_section(coarse, assess_scenario(coarse, 2)).pictures for _ in range(2))
    assert [p.png for p in one] == [p.png for p in two]


def test_pictures_into_impossible_places(tmp_path, monkeypatch):
    check_folder(tmp_path)

    def refuse(self, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(OutputError, match="cannot be made: No space left on device"):
        write_pictures((), tmp_path / "new")


def test_scenarios_have_no_search_unless_they_say_so():
    from compass.errors import ArgumentError

    with pytest.raises(ArgumentError, match=r"no \[optimize\] table"):
        search_scenario(read_scenario(DESIGNS / "entry-compass.toml"))

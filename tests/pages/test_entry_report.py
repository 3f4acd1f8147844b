"""The report's sections on entry: what they say is what was found."""

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from compass.api.land import LandResult
from compass.api.land_facts import entry_facts
from compass.api.land_flight import assess_scenario, check_cost, entry_section
from compass.api.optimize import OptimizeResult, search_scenario
from compass.api.outlook import Glance
from compass.document import Table
from compass.entry.consistency import consistency
from compass.entry.dispersed import Dispersed
from compass.entry.search import Optimum, Start
from compass.entry.trajectory import fly
from compass.errors import ArgumentError, OutputError
from compass.frames import direction
from compass.inputs.scenario import read_scenario, read_scenario_text
from compass.pages.landing import (
    answers,
    beacon_answers,
    dispersed_answers,
    landing_report,
    rests_on,
)
from compass.pictures.entry import around, draw_landing
from compass.pictures.files import check_folder, write_pictures

DESIGNS = Path(__file__).parents[2] / "designs"


@pytest.fixture(scope="module")
def coarse():
    text = (DESIGNS / "entry-ground-beacons.toml").read_text()
    text = text.replace("step_s = 1", "step_s = 24").replace("interval_s = 1", "interval_s = 24")
    return read_scenario_text(text.replace("[optimize]", "[optimize]\nstarts = 1\ngenerations = 2"))


@pytest.mark.slow
def test_entry_section_and_facts(coarse):
    found = assess_scenario(coarse, 4)
    section = entry_section(coarse, found)
    assert [p.stem for p in section.pictures] == [
        "entry-map",
        "entry-flight",
        "entry-view",
        "entry-observability",
        "entry-navigation",
        "landing-budget",
    ]
    assert all(p.drawn.startswith((b"\x89PNG", b"<svg")) for p in section.pictures)
    facts = entry_facts(coarse, found)
    assert facts["observability"]["sentence"] in section.paragraphs
    assert facts["observability"]["degree_si_min"] == pytest.approx(1.5407080921e-8, rel=1e-7)
    table = section.tables[-1]
    assert len(table.rows[0]) == len(table.header)
    np.testing.assert_allclose(
        [row[6] for row in table.rows], found.bound.position_sigma[[0, 1, 2, 4, 5, 6, 8, 9, 10]]
    )


def test_the_page_names_its_beacons_and_how_long_their_orbits_last(coarse, monkeypatch):
    (ground,) = beacon_answers(coarse)
    assert ground.written == f"{len(coarse.surface_names)} beacons on the ground"
    (own,) = beacon_answers(read_scenario(DESIGNS / "entry-orbiters.toml"))
    assert own.written.endswith("orbiters of its own")
    monkeypatch.setattr("compass.pages.landing.glance", lambda d: Glance(d, 31.7, 40.0, ""))
    who, lasts = beacon_answers(read_scenario(DESIGNS / "landing.toml"))
    assert who.written == "COMPASS 15/5/1"
    assert who.sure == "15 satellites in 5 planes: delta 45°: 15/5/1, 20427 km"
    assert (lasts.written, lasts.holds) == ("31 days", None)
    assert lasts.question == "Left alone on real orbits “COMPASS 15/5/1” lasts"
    shown = SimpleNamespace(
        scenario=read_scenario(DESIGNS / "landing.toml"),
        assessment=SimpleNamespace(
            monte_carlo=SimpleNamespace(errors=[0] * 3), consistency=SimpleNamespace(holds=False)
        ),
    )
    assert rests_on(shown) == (
        "Over 3 runs the filter's errors are not what it claims. Its beacons are COMPASS 15/5/1 "
        "(15 satellites in 5 planes: delta 45°: 15/5/1, 20427 km); left alone on real orbits "
        "that lasts 31 days."
    )


@pytest.mark.slow
def test_longitudes_stay_within_a_turn():
    text = (DESIGNS / "entry-ground-beacons.toml").read_text()
    text = text.replace("step_s = 1", "step_s = 24").replace("interval_s = 1", "interval_s = 24")
    east = read_scenario_text(text.replace("longitude_deg = -89.872", "longitude_deg = 359.9"))
    found = assess_scenario(east, 2)
    facts = entry_facts(east, found)
    (event,) = facts["events"]  # some 10 degrees on, past 360
    assert 0 < event["longitude_deg"] < facts["end"]["longitude_deg"] < 20
    place = entry_section(east, found).tables[0].rows[0][-1]
    assert place.endswith(f", {event['longitude_deg']:.2f}° E")


@pytest.mark.slow
def test_what_makes_a_filter_inconsistent_is_told_first(coarse):
    found = assess_scenario(coarse, 4)
    mc, times = found.monte_carlo, found.flight.times
    nees = mc.nees.copy()
    nees[2, 5:] = np.nan
    for change, words in (
        ({"diverged": np.array([True, False, False, False])}, "1 of 4 runs diverged"),
        ({"nees": nees}, "in 1 of 4 runs its covariance did not stay positive definite"),
        ({"nees": 40 * mc.nees}, "times what it claims"),
        ({"nees": 1e-3 * mc.nees}, "too cautious"),
        ({"diverged": np.ones(4, bool)}, "all 4 runs diverged"),
    ):
        runs = replace(mc, **change)
        judged = consistency(runs.nees, times, 6, runs.diverged)
        off = replace(found, monte_carlo=runs, consistency=judged)
        first, _, second, *_ = entry_section(coarse, off).paragraphs
        assert "no accuracy is claimed" in first
        assert second.startswith("The filter is inconsistent") and words in second
        facts = entry_facts(coarse, off)
        assert facts["landing"]["claim_m"] is None
        assert facts["consistency"]["consistent"] is False


def test_cost_is_known_before(coarse):
    assert check_cost(coarse, 4) < 1
    with pytest.raises(ArgumentError, match="would take about"):
        check_cost(replace(coarse, times=np.arange(100_000.0)), 100_000)


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
    assert table.rows[0][1:] == ("25.80° S, 82.70° W",)
    assert found.parameters is places and result.to_dict()["beacons"][0]["latitude_deg"] == (
        pytest.approx(-25.8)
    )


@pytest.mark.slow
def test_the_same_scenario_gives_the_same_pictures(coarse):
    one, two = (entry_section(coarse, assess_scenario(coarse, 2)).pictures for _ in range(2))
    assert [p.drawn for p in one] == [p.drawn for p in two]


def test_pictures_into_impossible_places(tmp_path, monkeypatch):
    check_folder(tmp_path)

    def refuse(self, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(OutputError, match="cannot be made: No space left on device"):
        write_pictures((), tmp_path / "new")


def test_scenarios_have_no_search_unless_they_say_so():
    with pytest.raises(ArgumentError, match=r"no \[optimize\] table"):
        search_scenario(read_scenario(DESIGNS / "entry-compass.toml"))


def test_a_landings_page_has_the_answer_first(coarse):
    flown = LandResult(coarse, assess_scenario(coarse, 4), None, "compass land x", False)
    page, sections = landing_report(flown)
    assert [s.title for s in sections] == [
        "The answer", "Navigation", "The flight", "Who is in view",
    ]  # fmt: skip
    assert sections[0].pictures[0].stem == "landing-ellipse"
    assert "comes down within" in sections[0].paragraphs[0] and "compass land x" in page
    known = {row.question: row for row in answers(flown.assessment)}
    assert known["Errors are what the filter claims"].holds is flown.assessment.consistency.holds
    assert known["Beacons in view"].written == "3 of 3"
    own = flown.assessment.consistency
    bad = replace(flown.assessment, consistency=replace(own, nees=own.nees + 99.0))
    assert bad.claim_m is None
    assert answers(bad)[0].written == "not claimed" and answers(bad)[0].mark == "missed"


def test_dispersed_entries_are_a_row_of_the_answer():
    at = direction(np.zeros(4), np.radians([0.0, 0.01, 0.02, 0.03]))
    ends = np.hstack([3.4e6 * at, np.zeros((4, 3))])
    found = Dispersed("parachute", np.ones(4), ends, direction(0.0, 0.0), True)
    (row,) = dispersed_answers(found)
    assert (
        row.question.startswith("Guided") and row.written == "1.78 km in 95 %"
    )  # 3400 km * 0.03 deg
    some = replace(found, times=np.array([1.0, np.nan, 1.0, 1.0]), guided=False)
    (row,) = dispersed_answers(some)
    assert row.written == "not in 95 %" and row.question == "Entries come within"
    assert row.sure == "sampled, 4 dispersed entries" and dispersed_answers(None) == ()


def test_offsets_over_the_ground_are_found_again():
    """Points so far to the east and north of a place are where `Dispersed` counts them."""
    place = np.array([-1.2e6, 2.9e6, 1.3e6])
    offsets = np.array([[0.0, 0.0], [3e4, -1e4], [-2e5, 7e5]])
    points = around(place, offsets)
    ends = np.concatenate([points, np.ones_like(points)], axis=1)
    centre = place / np.linalg.norm(place)
    found = Dispersed("ground", np.arange(3.0), ends, centre, guided=False)
    np.testing.assert_allclose(found.offsets, offsets, rtol=0, atol=1e-3)


def test_the_map_shows_where_entries_come_down(coarse):
    flown = assess_scenario(coarse, 2)
    ends = flown.flight.path[-3:]
    at = direction(0.0, 0.0)
    axes = Figure().add_subplot()
    draw_landing(axes, flown, Dispersed("ground", np.array([1.0, np.nan, 2.0]), ends, at, False))
    ellipse, spots = axes.lines
    assert len(spots.get_xdata()) == 2
    # its longest diameter is that of the ellipse: a degree is 59.3 km
    lon, lat = ellipse.get_xdata(), ellipse.get_ydata()
    east = (lon - lon.mean()) * np.cos(np.radians(lat.mean()))
    half = np.radians(np.hypot(east, lat - lat.mean()).max()) * np.linalg.norm(
        flown.accuracy.path[:3]
    )
    assert half == pytest.approx(flown.accuracy.delivery.ellipse.semi_major, rel=0.03)


def test_filters_that_claim_too_much_are_told_in_the_first_lines(monkeypatch):
    module = sys.modules["compass.pages.landing"]
    data = SimpleNamespace(attrs={"runs": 300})
    fused = SimpleNamespace(clear={"ekf": data, "dcifaif": data, "ci": data})
    for vain, said in (
        ({}, "none is too sure"),
        ({"ekf": "whose errors", "ci": "whose runs"}, "too sure: ekf and ci"),
    ):
        monkeypatch.setattr(module, "too_sure", lambda _, vain=vain: vain)
        (row,) = module.fused_answers(fused)
        assert (row.written, row.holds, row.sure) == (said, not vain, "NEES of 300 runs")
    assert module.fused_answers(None) == ()

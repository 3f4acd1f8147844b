"""Sections in metres: what they show, and that they are not there without a signal."""

import json

import numpy as np
import pytest

import compass
from compass.coverage.errors import ERRORS
from compass.document.blocks import Sentence, walk
from compass.inputs import read_design_text
from compass.pages.aloft import aloft_section, maps_aloft, standings
from compass.pages.metres import metres_section, tracking_section
from compass.study.mapping import MapOptions
from tests.evidence import unknown

DESIGN = """
name = "nine"
[constellation]
pattern = "walker-delta"
satellites = 9
planes = 3
phasing = 1
inclination_deg = 50
radius_km = 20427
"""
SIGNAL = """
[signal]
clock_m = 3
ephemeris_m = [2, 8, 5]
receiver = { noise_m = 0.5, zenith_m = 0.5 }
"""
TRACKED = "[tracking]\ndays = 0.1\nstep_s = 1800\nearth = { range_m = 1, time_m = 3 }\n"


def mapped(text):
    return compass.map(read_design_text(text), step_deg=60, epochs=2, duration_h=2, budget_s=0.01)


def test_there_is_none_without_a_signal():
    made = mapped(DESIGN)
    assert metres_section(made) is None and tracking_section(made.design) is None


def test_errors_budget_and_promise_stand_on_the_page():
    more = DESIGN.replace("satellites = 9", "satellites = 24")
    section = metres_section(mapped(more + SIGNAL + "[integrity]\n"))
    stems = [p.stem for p in section.pictures]
    assert stems == [
        "error-horizontal-p95", "error-vertical-p95", "error-time-p95",
        "protection-horizontal-p95", "protection-vertical-p95", "fix-budget", "range-budget",
    ]  # fmt: skip
    assert all(p.drawn.startswith((b"\x89PNG", b"<svg")) and p.alt for p in section.pictures)
    titles = [t.title for t in section.tables]
    assert any(t.startswith("Errors of a fix") for t in titles)
    assert any(t.startswith("Budget of a range") for t in titles)
    assert any("a rover anywhere: " in text for text in section.paragraphs)
    assert any(t.startswith("What a fix is made of") for t in titles)


def test_errors_at_the_sites_stand_on_the_page_over_time():
    made = mapped(
        DESIGN + SIGNAL + "[[station]]\nname = 'A'\nlatitude_deg = 3\nlongitude_deg = 5\n"
    )
    followed = compass.series(made.design, days=0.1, epochs=7)
    section = metres_section(made, followed)
    stems = [p.stem for p in section.pictures]
    assert [s for s in stems if s.endswith("sites")] == [
        "error-horizontal-sites", "error-vertical-sites"]  # fmt: skip
    assert any(t.title == "Errors of fixes over time" for t in section.tables)


@pytest.mark.slow
def test_every_number_of_a_budget_stands_between_bounds_in_json_and_in_files():
    more = DESIGN.replace("satellites = 9", "satellites = 24")
    made = mapped(more + SIGNAL + "[integrity]\n")
    found, dataset = made.to_dict(), made.dataset
    assert unknown(found) == []
    budget = found["fix_budget"]
    numbers = [budget, budget["range_parts"]]
    numbers += [one[key] for one in budget.values() if isinstance(one, dict) and "parts" in one
                for key in ("parts", "geometry")]  # fmt: skip
    told = [(of, name) for of in numbers for name, value in of.items() if np.isscalar(value)]
    assert len(told) == 1 + 5 + 4 * (5 + 4)
    for of, name in told:
        low, high = of[f"{name}_interval"]
        assert low <= of[name] <= high
    for name in ("error", "fix_part", "range_part", "range_error", "error_share", "protection"):
        low, value, high = (dataset[f"global_{name}{end}"] for end in ("_low", "", "_high"))
        assert bool(((low <= value) & (value <= high)).all()), name
    p95 = dataset.global_error_high.sel(error="error_time_m", global_percentile=95)
    assert float(p95) == made.errors["error_time_m"]["p95_interval"][1]
    clock = dataset.global_fix_part_low.sel(error="error_vertical_m", part="clock")
    assert float(clock) == budget["error_vertical_m"]["parts"]["clock_interval"][0]


def test_a_design_that_never_has_a_fix_gets_no_bars():
    few = DESIGN.replace("satellites = 9", "satellites = 3")
    section = metres_section(mapped(few + SIGNAL))
    assert [p.stem for p in section.pictures] == ["range-budget"]
    assert any("in 100 % fewer than four satellites are in view" in p for p in section.paragraphs)
    assert any("more than 5 % of it there is no fix" in p for p in section.paragraphs)
    errors = mapped(few + SIGNAL).errors
    for name in ERRORS:  # proven, not drawn
        assert (errors[name]["share"], errors[name]["share_bracket"]) == (0.0, [0.0, 0.0])


def test_it_is_said_why_errors_and_levels_are_infinite():
    """Shares of the reasons add up to those of the infinities, which cells and epochs tell."""
    text = DESIGN.replace("satellites = 9", "satellites = 12").replace("planes = 3", "planes = 4")
    made = compass.map(
        read_design_text(text + "[coverage]\nmask_deg = 15\n" + SIGNAL + "[integrity]\n"),
        step_deg=30, epochs=5, duration_h=7, budget_s=0.01,
    )  # fmt: skip
    known = made.to_dict()
    four = float((made.drawn.count >= 4).mean())
    assert known["fewer_than_four_share"] == pytest.approx(1 - four) and 0.01 < four < 0.99
    reasons = known["fewer_than_four_share"] + known["singular_share"]
    assert reasons == pytest.approx(1 - known["fix_share"]) and known["masked_share"] > 0.01
    of_level = [known[f"{name}_share"] for name in ("fewer_than_five", "unchecked", "two_faults")]
    assert sum(of_level) == pytest.approx(1 - known["level_share"])
    assert known["level_share"] < known["fix_share"]
    said = " ".join(str(made).split())
    assert "errors are infinite in" in said and "the mask begins at 15 deg" in said
    assert "fewer than five satellites are in view" in said


def test_an_infinite_map_says_why_in_its_title():
    few = mapped(DESIGN.replace("satellites = 9", "satellites = 3") + SIGNAL)
    title = few.plot("error_time_m").get_title()
    assert "errors are infinite in 100 %" in title
    assert "infinite" not in mapped(DESIGN + SIGNAL).plot("error_time_m").get_title()


def test_the_tracking_stands_on_the_page():
    section = tracking_section(read_design_text(DESIGN + SIGNAL + TRACKED))
    stems = ["tracking-sigma", "tracking-components", "tracking-schedule"]
    assert [p.stem for p in section.pictures] == stems
    (lanes,) = json.loads(section.pictures[2].reading)  # who points at one is told whose it is
    assert [row["name"] for row in lanes["rows"][:2]] == ["P1S1: Earth", "P1S2: Earth"]
    assert lanes["rows"][0]["to"][-1] >= 0.1 * 24.0
    assert any(t.title.startswith("Who measures when") for t in section.tables)
    assert any(" of tracking by Earth" in text for text in section.paragraphs)
    assert len(list(walk(section.blocks))) > 3


def test_users_in_orbit_of_requirements_have_a_section():
    """Each standing once, in metres where ranges have errors; nobody on the ground all around."""
    ground = '[[requirement]]\nname = "ground"\nfold = 1\nshare = 0.5\n'
    aloft = (
        ground.replace("ground", "{name}")
        + "altitude_km = 400\nmask_deg = -15\nbeam_deg = {beam}\n"
    )
    more = DESIGN.replace("satellites = 9", "satellites = 24") + ground
    options = MapOptions(step_deg=60, epochs=2, duration_h=2)
    assert aloft_section(maps_aloft(read_design_text(more), options, "")) is None
    text = more + "".join(aloft.format(name=name, beam=b) for name, b in (("a", 17), ("b", 17)))
    dop = aloft_section(maps_aloft(read_design_text(text), options, ""))
    assert [p.stem for p in dop.pictures] == ["aloft-1-gdop-p95"]
    design = read_design_text(text + aloft.format(name="c", beam=16) + SIGNAL)
    assert [one.beam_deg for one in standings(design)] == pytest.approx([17, 16])
    section = aloft_section(maps_aloft(design, options, ""))
    stems = [p.stem for p in section.pictures]
    assert stems == ["aloft-1-error-position-p95", "aloft-2-error-position-p95"]
    titles = [t.title for t in section.tables]
    assert len(titles) == len(set(titles)) == 6
    assert all("400 km above the ground, in beams of 1" in title for title in titles)
    said = [block.text for block in walk(section.blocks) if isinstance(block, Sentence)]
    assert "Users anywhere, 400 km above the ground, in beams of 17 deg, above -15 deg:" in said
    assert not any(words.endswith("..") for words in said)

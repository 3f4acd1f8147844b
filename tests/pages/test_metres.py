"""Sections in metres: what they show, and that they are not there without a signal."""

import compass
from compass.document.blocks import walk
from compass.inputs import read_design_text
from compass.pages.metres import metres_section, tracking_section

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
    return compass.map(read_design_text(text), step_deg=60, epochs=2, duration_h=2)


def test_there_is_none_without_a_signal():
    made = mapped(DESIGN)
    assert metres_section(made) is None and tracking_section(made.design) is None


def test_errors_budget_and_promise_stand_on_the_page():
    section = metres_section(mapped(DESIGN + SIGNAL + "[integrity]\n"))
    stems = [p.stem for p in section.pictures]
    assert stems == [
        "error-horizontal-p95", "error-vertical-p95", "error-time-p95",
        "protection-horizontal-p95", "protection-vertical-p95", "range-budget",
    ]  # fmt: skip
    assert all(p.drawn.startswith((b"\x89PNG", b"<svg")) and p.alt for p in section.pictures)
    titles = [t.title for t in section.tables]
    assert any(t.startswith("Errors of a fix") for t in titles)
    assert any(t.startswith("Budget of a range") for t in titles)
    assert any("a rover anywhere: " in text for text in section.paragraphs)


def test_the_tracking_stands_on_the_page():
    section = tracking_section(read_design_text(DESIGN + SIGNAL + TRACKED))
    assert [p.stem for p in section.pictures] == ["tracking-sigma"]
    assert any(" of tracking by earth" in text for text in section.paragraphs)
    assert len(list(walk(section.blocks))) > 3

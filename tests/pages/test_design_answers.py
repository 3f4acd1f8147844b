"""The first lines of a design's page, and what they advise."""

import json
import re
import shlex
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

import compass
from compass.allowed import check_allowed
from compass.api.map_result import MapResult
from compass.cli.main import command
from compass.document import Sampled
from compass.errors import ArgumentError
from compass.inputs import read_design_text
from compass.pages.advice import accurate, answer_section, search_line, what_to_do
from compass.pages.answers import (
    ANSWERS,
    _dilution,
    flown,
    geometry,
    losses,
    moment_words,
    place_errors,
)
from compass.pages.design_results import DesignResults
from compass.pages.neighbours import Neighbour
from compass.ranging import Receiver, Signal
from compass.requirement import Requirement
from compass.study.certified import certified_areas
from compass.study.mapping import MapOptions, make_map
from tests.pages.test_lasting_section import told

FILE = """
name = "few"
[constellation]
pattern = "walker-delta"
satellites = 5
planes = 5
phasing = 1
inclination_deg = {inclination}
orbit = "areosynchronous"
[coverage]
fold = {fold}
[[station]]
name = "A"
latitude_deg = 0
longitude_deg = 0
[[station]]
name = "B"
latitude_deg = 80
longitude_deg = 0
"""


def look(fold, inclination=43.7, lost=1):
    design = read_design_text(FILE.format(fold=fold, inclination=inclination))
    return DesignResults(
        design,
        compass.show(design),
        MapResult(design, make_map(design, MapOptions(step_deg=30, epochs=2))),
        compass.fold(design, losses=lost),
        None,
        stations=certified_areas(design, MapOptions(), design.stations, ()),
    )


@pytest.fixture(scope="module")
def met():
    return look(1)


def beside(found, *masks):
    angles = np.linspace(20.0, 90.0, len(masks))
    return [Neighbour(found.design.constellation.pattern, angles, np.array(masks, float))]


def test_what_is_met_is_said_with_its_margin_and_how_sure(met):
    rows = {row.question: row for question in ANSWERS for row in question(met)}
    coverage = rows["1 in view above 0°, everywhere"]
    assert coverage.mark == "met" and coverage.answer == "proven"
    assert "for all time" in coverage.sure
    assert rows["The mask may rise to"].written.startswith("11.")
    assert rows["After any one loss, in view at least"].written == "0"
    assert flown(met.design) == "5 satellites in 5 planes: delta 43.7°: 5/5/1, 20428 km"
    assert rows["After any one loss, in view at least"].sure == (
        "proven, for all time, two-body motion, IAU 2015 sphere"
    )
    (worst,) = [row for name, row in rows.items() if name.startswith("Worst of 2 stations: ")]
    assert worst.holds and worst.written.startswith("1 in view always: 22.7")
    assert worst.sure.startswith("proven, for ever")
    assert "sampled" in rows["GDOP, half of area and time below"].sure


def test_the_advice_names_the_rival_and_what_would_change_it(met):
    words = what_to_do(met, beside(met, 3.0, 20.0))
    assert words.startswith("Build it as it is")
    assert "rival of the same size: 90°: 5/5/1, with a mask up to 20° instead of 11." in words
    assert "A mask above 11." in words and "loss of one satellite: then 0 in view" in words
    assert "horizon of" not in words
    few = replace(met.stations[1], fold=replace(met.stations[1].fold, met=False))
    words = what_to_do(replace(met, stations=(met.stations[0], few)), [])
    assert "proven for all time. Above the horizon of “B” it has less: not always 1." in words
    words = what_to_do(met, beside(met, 3.0, 4.0))
    assert "No other phasing or inclination" in words


def test_users_aloft_lead_where_they_alone_are_asked_for(met):
    aloft = MapOptions(step_deg=60, epochs=2, altitude_km=400.0, mask_deg=-15.0)
    above = MapResult(met.design, make_map(met.design, aloft))
    for altitude_km, first in ((400.0, "GDOP 400 km above the ground"), (0.0, "GDOP on the")):
        asked = compass.Requirement.of("few", fold=1, share=0.5, altitude_km=altitude_km)
        design = replace(met.design, requirements=(asked,))
        rows = geometry(replace(met, design=design, aloft=(above,)))
        assert [row.question.startswith(first) for row in rows] == [True] * 2 + [False] * 4
        assert len({row.question for row in rows}) == 6
        words = accurate(replace(met, design=design, aloft=(above,)))
        assert ("400 km above the ground" in words) is (altitude_km > 0.0)


@pytest.mark.slow
def test_what_is_missed_is_not_to_be_built():
    found = look(4, lost=0)
    section = answer_section(found, [], beside(found, 1.0, 2.0))
    (words,) = section.paragraphs
    assert words.startswith("Do not build it for 4-fold coverage above 0°")
    assert "Build 90°: 5/5/1 in its place: as many satellites, with a mask up to 2°." in words
    assert "instead" not in words
    words = what_to_do(found, beside(found, -80.0, -70.0))  # no rival: its mask is lower still
    assert "No other phasing or inclination" in words and "rival" not in words
    line = "compass search --fold 4 --mask-deg 0 --radius-km 20427.7"
    assert line in words and words.endswith(" --max-satellites 64.")
    # 4 spheres over the part of one that a satellite sees: acos(3396.19 / 20427.7) is 80.4 degrees
    assert "How many it takes, 10 or more by the area that each sees, is found by" in words
    assert "In more than half of area and time" in words
    lost = told(outcome="refuted", days_proven=0.0, loss="0 in view at the equator", keeping=None)
    words = what_to_do(replace(found, outlook=lost), [])
    assert "lasts no time: at the epoch 0 in view at the equator. In more than half" in words
    assert losses(found) == []
    assert "missed" in compass.document.text(compass.document.Page("x", section.blocks))


@pytest.mark.slow
def test_no_loss_changes_a_refusal():
    found = look(4, lost=1)
    assert found.fold.coverage.losses and "loss of one" not in what_to_do(found, [])


def test_the_search_that_is_advised_is_one_that_runs():
    """Without a radius and a largest size it had been refused."""
    circles, ovals = (
        read_design_text(text)
        for text in (FILE.format(fold=1, inclination=50), ELLIPSES.format(0.5))
    )
    lines = [search_line(circles, "--fold 1"), search_line(ovals, "--require 'my file.toml'")]
    for line, option in zip(lines, ("--radius-km 20427.7", "--orbit areosynchronous"), strict=True):
        assert option in line
        with command("search").make_context("search", shlex.split(line)[2:]) as context:
            most = context.params["max_satellites"]
            check_allowed("max_satellites", most)
            with pytest.raises(ArgumentError):  # none larger is allowed
                check_allowed("max_satellites", most + 1)


def test_a_moment_has_the_unit_of_its_size():
    assert [moment_words(s) for s in (7200.0, 252.0, 3.0)] == ["2 h", "4.2 min", "3 s"]


FIVE = """
[[requirement]]
name = "ever"
fold = 1
[[requirement]]
name = "low"
fold = 1
region = "lat:-10:10"
mask_deg = 20
"""


ELLIPSES = """
name = "two"
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "A"
semi_major_axis_km = 14453
eccentricity = {}
inclination_deg = 63.4
[[constellation.satellite]]
name = "B"
semi_major_axis_km = 14453
inclination_deg = 50
"""


def test_what_flies_is_said_in_a_line():
    text = FILE.format(fold=1, inclination=43.7).replace("= 5\n", "= 1\n")
    one = read_design_text(text.replace("phasing = 1", "phasing = 0"))
    assert flown(one) == "1 satellite in 1 plane: delta 43.7°: 1/1/0, 20428 km"
    said = "2 satellites, semi-major axis 14453 km, eccentricity 0 to 0.5, inclination 50 to 63.4°"
    assert flown(read_design_text(ELLIPSES.format(0.5))) == said
    assert "eccentricity" not in flown(read_design_text(ELLIPSES.format(0)))
    paths = SimpleNamespace(constellation=one.constellation, motion=SimpleNamespace(table=1))
    assert flown(paths) == "1 satellite on given paths"


def mapped(**numbers):
    """As much of what was found as the accuracy is read from."""
    attrs = {"epochs": 2, "grid": "cells", "pdop_threshold": 6.0}
    numbers = {"gdop": {"p50": np.inf, "p95": np.inf}, "availability": 0.5, **numbers}
    design = read_design_text(FILE.format(fold=1, inclination=43.7))
    shown = SimpleNamespace(
        design=design,
        users="",
        numbers=lambda: numbers,
        dataset=SimpleNamespace(attrs=attrs),
        certified=None,
        drawn=None,
        looked=Sampled(how="at 2 epochs on cells"),
    )
    shown.value = partial(MapResult.value, shown)
    return SimpleNamespace(design=design, mapped=shown, aloft=())


def test_how_accurate_a_fix_is_is_one_sentence():
    few = SimpleNamespace(design=read_design_text(ELLIPSES.format(0.5)))
    assert "takes four satellites in view" in accurate(few)
    assert [row.written for row in geometry(few)] == ["never: it takes four satellites in view"]
    assert "no bound of GDOP is known" in accurate(mapped())
    none = mapped(gdop={"p50": np.inf, "p95": np.inf, "p50_bracket": (1e5, np.inf)})
    assert accurate(none).endswith("ranges of one moment give no fix.")
    half = mapped(gdop={"p50": 2.0, "p95": 9.0, "p95_bracket": (8.0, np.inf)})
    assert accurate(half).startswith(
        "GDOP is below 2 in half of area and time (sampled, at 2 epochs on cells, error not known)"
    )
    chance = accurate(mapped(gdop={"p50": 2.0, "p95": 3.4, "p95_interval": (3.3, 3.5)}))
    assert chance.startswith("GDOP is below 3.5 in 95 % of area and time (bounds that hold in 95 ")
    most = mapped(gdop={"p50": 2.0, "p95": 3.4, "p95_bracket": (3.4059, 3.4101)})
    assert accurate(most).startswith("GDOP is proven below 3.42 in 95 % of area and time: a fix")


def test_requirements_come_first_and_decide_the_advice(met):
    design = read_design_text(FILE.format(fold=1, inclination=43.7) + FIVE)
    checked = compass.check(design)
    found = replace(met, design=design, checked=checked)
    rows = ANSWERS[0](found)
    assert [row.holds for row in rows] == [v.met for v in checked.verdicts]
    assert rows[0].question == "ever: 1 satellite, always" and "proven" in rows[0].sure
    assert ANSWERS[1](found)[0].holds is None  # the coverage is not what was asked for
    assert "bracket" not in "".join(row.sure for row in rows)
    words = what_to_do(found, [])
    missed = [v.requirement.name for v in checked.verdicts if v.met is False]
    assert ("Do not build it" in words) is bool(missed)
    for met_, start in ((True, "Build it as it is: it meets all of its 2"), (None, "Decide after")):
        changed = replace(checked, verdicts=tuple(replace(v, met=met_) for v in checked.verdicts))
        assert what_to_do(replace(found, checked=changed), []).startswith(start)
    assert ANSWERS[0](met) == []


def in_metres(met, label="d.toml", **attrs):
    """A map of users who have a signal, and know their place to 23.1 to 24.6 m."""
    signal = Signal(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5))
    design = replace(met.design, signal=signal, label=label)
    numbers = met.mapped.numbers() | {
        f"rover_{name}_m{ending}": value
        for name in ("horizontal", "vertical")
        for ending, value in (("", 23.5), ("_interval", [23.1, 24.6]))
    }
    made = replace(met.mapped.made, dataset=met.mapped.made.dataset.assign_attrs(attrs))
    mapped = replace(met.mapped, design=design, made=made)
    object.__setattr__(mapped, "numbers", lambda: numbers)
    return replace(met, design=design, mapped=mapped)


def test_a_rover_anywhere_is_answered_where_a_signal_is_known(met):
    found = in_metres(met, "my design.toml")
    row, _ = place_errors(found.mapped)
    assert row.question.startswith("A rover anywhere: horizontal, 95 % of fixes")
    assert row.written.startswith("23.1 to 24.6") and "in 95 of 100 cases" in row.sure
    assert "2, 8, 5, 3 m (radial" in row.sure
    assert row.sure.endswith("; compass map 'my design.toml'")
    assert place_errors(met.mapped) == []
    said = accurate(found)
    assert said.startswith("A rover anywhere knows its place within 23.1 to 24.6 m horizontally:")


def test_users_in_orbit_come_first_where_all_that_is_asked_for_is_theirs(met):
    aloft = in_metres(met, user_altitude_km=400.0, beam_deg=17.0, elevation_mask_deg=[-15.0]).mapped
    wanted = Requirement.of(
        "relay", regions="globe", fold=1, altitude_km=400, beam_deg=17, mask_deg=-15
    )
    ground = Requirement.of("surface", regions="globe", fold=1)
    for asked, first in (((wanted,), "user"), ((wanted, ground), "rover")):
        found = in_metres(met)
        design = replace(found.design, requirements=asked)
        found = replace(found, design=design, aloft=(aloft,))
        rows = [row for row in geometry(found) if " anywhere" in row.question]
        assert [row.question.split()[1] for row in rows[::2]] == sorted(
            ("user", "rover"), key=lambda who: who != first
        )
        assert accurate(found).startswith(f"A {first} anywhere")
    row, _ = place_errors(aloft)
    assert row.question.startswith("A user anywhere, 400 km above the ground, in beams of 17 deg:")
    assert row.sure.endswith("; compass map d.toml --altitude-km 400 --beam-deg 17 --mask-deg -15")


def test_maps_and_losses_of_a_page(met):
    from compass.pages import design as page
    from compass.pages.coverage import count_picture, dilution_pictures, one_colour, one_count

    assert "0 to" in count_picture(met.mapped).alt or "1 to" in count_picture(met.mapped).alt
    # five satellites fix nobody for 95 % of the time: that is a sentence, no grey map
    assert [p.stem for p in dilution_pictures(met.mapped)] == ["availability"]
    assert [said.partition(":")[0] for said in one_colour(met.mapped)] == [
        "At no cell is there a fix for 95 % of the time"
    ]
    design = read_design_text(
        FILE.format(fold=4, inclination=45).replace("satellites = 5", "satellites = 15")
    )
    many = MapResult(design, make_map(design, MapOptions(step_deg=30, epochs=2)))
    drawn = dilution_pictures(many)
    assert one_colour(many) == []
    assert [p.stem for p in drawn][:2] == ["gdop-p95", "dilutions-p95"]
    assert drawn[0].wide and drawn[0].alt.startswith("Map of Mars: GDOP")
    titles = [panel["title"] for panel in json.loads(drawn[1].reading)]
    assert titles == [f"{n}DOP, 95th percentile over time" for n in "PHVT"]
    assert re.search("PDOP (from|none).*; TDOP (from|none)", drawn[1].alt)
    flat = met.mapped.dataset.assign(availability=0.0 * met.mapped.dataset.availability)
    even = replace(met.mapped, made=replace(met.mapped.made, dataset=flat))
    assert one_colour(even)[1:] == ["PDOP is never 6 or less, at any cell and epoch."]
    full = replace(met.mapped, made=replace(met.mapped.made, dataset=flat + 1))
    full.made.dataset.attrs = flat.attrs
    said = "PDOP is at most 6 for 100 % of the time, at every cell."
    assert one_colour(full)[-1] == said
    assert one_count(met.mapped) == []
    flat = met.mapped.dataset.assign(count_min=3 + 0 * met.mapped.dataset.count_min)
    even = replace(met.mapped, made=replace(met.mapped.made, dataset=flat))
    assert one_count(even) == ["At every cell the fewest in view at any epoch are 3."]
    lost = page._losses(met, [])
    assert lost is not None and lost.tables[0].title.startswith("After 1 loss")


def test_a_gdop_of_nobody_is_words(met):
    for low, said in ((1e5, "none: over 5 % of it has no fix"), (3.4, "3.4 to ∞")):
        found, holds, sure = _dilution(
            met.mapped, {"p95": np.inf, "p95_bracket": (low, np.inf)}, "p95"
        )
        assert (str(found), holds) == (said, None) and "proven" in sure

"""How long a design lasts, as its page says it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import compass
from compass.api import outlook as module
from compass.api.outlook import (
    Glance,
    KeepingCost,
    Outlook,
    Settled,
    SlotHistory,
    commands,
    outlook,
)
from compass.api.radii import RadiusLasts
from compass.bodies import SOLAR_DAY
from compass.coverage.certificate import Outcome
from compass.document import Table
from compass.errors import ArgumentError
from compass.inputs import read_design_text
from compass.orbits.motion import Motion
from compass.pages.design import _known_sols
from compass.pages.lasting import (
    TITLE,
    lasting_advice,
    lasting_answers,
    lasting_section,
    lasting_sentence,
    lasting_verdicts,
    until_leap,
)

PLAIN = 'gravity_degree = 3\nsun = false\nmoons = false\nradiation_m2_kg = 0\nshadow = "none"\n'

RING = (
    """
name = "ring"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = {n}
planes = {n}
phasing = 1
inclination_deg = 43.66
radius_km = {radius}
[coverage]
fold = 1
mask_deg = {mask}
[motion]
model = "numerical"
"""
    + PLAIN
)


#: Requirements of a ring of five: the first is kept, the second never.
PLACES = """
[[station]]
name = "pole"
latitude_deg = -90
longitude_deg = 0
mask_deg = 60
[[requirement]]
name = "near"
region = "lat:-80:80"
fold = 1
[[requirement]]
name = "far"
sites = ["pole"]
fold = 1
"""


def ring(radius=20427.7, mask=0.0, n=5):
    return read_design_text(RING.format(radius=radius, mask=mask, n=n))


@pytest.fixture
def near(monkeypatch):
    """A short horizon: what takes a Mars year takes long."""
    monkeypatch.setattr(module, "HORIZON", 2.0)
    monkeypatch.setattr(module, "GLANCE", 1.0)


def words(section):
    return " ".join(f"{b.word} {b.claim}" for b in section.blocks if hasattr(b, "claim"))


def test_places_in_slots_are_drawn_up_to_a_leap_of_the_best_fit():
    """A drift that grows by a degree a day is none, forty degrees at once are."""
    smooth = np.column_stack([np.arange(30.0) ** 2 / 4, -(np.arange(30.0) ** 2) / 5])
    across = np.zeros_like(smooth)
    assert until_leap(smooth, across) == 29
    leaping = smooth.copy()
    leaping[21:] += 60.0
    assert until_leap(leaping, across) == 20
    assert until_leap(smooth[:1], across[:1]) == 0
    coarse = 16.0 * smooth[:5]  # by 4 degrees first, by 12 next
    assert until_leap(coarse, across[:5]) == 4
    turned = across.copy()
    turned[29:, 1] = 15.0  # less than the drift itself, beside it
    slow = 0.1 * smooth
    assert until_leap(slow, turned) == 28


@pytest.mark.slow
def test_what_is_proven_for_the_horizon_needs_no_more(near):
    design = ring()
    found = outlook(design)
    assert found.lasts
    assert (found.days_proven, found.radii, found.keeping) == (2.0, (), None)
    section = lasting_section(design, found)
    assert section.title == TITLE
    assert words(section).startswith("Lasts 2 days and more 1 or more satellites above 0 deg")
    assert [p.stem for p in section.pictures] == ["lasting-margin", "lasting-slots"]
    again = outlook(design)
    assert again.known
    assert again.drift == found.drift


def test_what_never_holds_lasts_no_time(near):
    found = outlook(ring(mask=40.0))
    assert (found.days_proven, found.drift) == (0.0, None)
    (said,) = lasting_verdicts(ring(mask=40.0), found)
    assert said.word == "Does not hold at the epoch"
    assert not said.holds


KEPT = KeepingCost.of({
    "holds": True,
    "years": 1.0,
    "delta_v_mean_m_s_year": 16.0,
    "box_deg": 2.0,
    "dry_mass_kg": 100.0,
    "specific_impulse_s": 220.0,
    "per_satellite": [
        {
            "name": "A", "delta_v_m_s_year": 12.0, "burns": 0, "days_between_burns": None,
            "worst_in_track_deg": 1.0, "worst_cross_track_deg": 0.1, "propellant_kg": 0.5,
        },
        {
            "name": "B", "delta_v_m_s_year": 20.0, "burns": 9, "days_between_burns": 40.6,
            "worst_in_track_deg": 2.0, "worst_cross_track_deg": 0.1, "propellant_kg": 0.9,
        },
    ],
})  # fmt: skip
DRIFT = SlotHistory(
    days=[0.0, 20.0, 40.0],
    margin_deg=[6.0, 3.0, -4.0],
    room_deg=[5.0, 1.0, -20.0],
    satellites=["A", "B"],
    in_track_deg=[[0.0, 0.0], [3.0, -3.0], [9.0, -9.0]],
    cross_track_deg=[[0.0, 0.0], [0.1, -0.1], [0.3, -0.2]],
    slot_sideways_deg=6.0,
)


def told(first_loss=31.7, radii=((-400.0, 687.0), (400.0, 687.0)), **changed):
    rows = tuple(
        RadiusLasts(20427.0 + shift, days, None if days >= 687 else days, 5.8, 17.0, trimmed=True)
        for shift, days in radii
    )
    known = {
        'asked': "4 in view", 'motion': "forces", 'requirements': (), 'horizon_days': 687.0, 'outcome': "refuted",
        'days_proven': 31.7, 'first_loss_days': first_loss, 'loss': "3 in view", 'drift': DRIFT,
        'radius_km': 20427.0, 'radii': rows, 'keeping': KEPT, 'notes': ("a note",), 'known': False,
    }  # fmt: skip
    return Outlook(**{**known, **changed})


def test_the_first_lines_say_how_long_at_what_cost_and_where_not():
    design = ring()
    lasts, cost, radius = lasting_verdicts(design, told())
    assert lasts.word == "Lasts 31 days" and "proven left alone on real orbits for" in lasts.claim
    assert cost.word == "Keeping it costs 16 m/s a year a satellite"
    assert cost.claim.startswith("12 to 20 by slot")
    assert radius.word == "400 km lower it keeps itself for 1.9 years"
    assert [v.holds for v in (lasts, cost, radius)] == [False, True, True]
    for said, command in zip(
        (lasts, cost, radius), ("--days 33", "keep", "20027,20827"), strict=True
    ):
        assert command in said.claim
    section = lasting_section(design, told())
    assert [p.stem for p in section.pictures] == [
        "lasting-margin",
        "lasting-slots",
        "lasting-radius",
    ]
    assert section.paragraphs[0] == "forces; a note."


def test_the_page_asks_and_advises():
    rows = lasting_answers(ring(), told())
    assert [row.written for row in rows] == [
        "31 days", "16 m/s a year a satellite", "20027 km, 400 km lower, for 1.9 years",
    ]  # fmt: skip
    assert [row.mark for row in rows] == ["", "", ""]  # nobody asked for a number of days
    assert lasting_advice(ring(), told()) == (
        "Left alone on real orbits it loses that after 31 days: fly it 400 km lower, where it keeps "
        "itself once trimmed, or keep every satellite in its slot for 16 m/s a year each."
    )
    held = told(None, (), outcome="proven", days_proven=687.0, keeping=None)
    assert lasting_advice(ring(), held) == ""
    assert [row.written for row in lasting_answers(ring(), held)] == ["687 days and more"]


def test_of_paths_known_for_days_no_years_and_no_slots_are_spoken_of():
    drift = replace(DRIFT, room_deg=None, in_track_deg=None, cross_track_deg=None)
    short = {"days_proven": 1.25, "horizon_days": 1.25, "radii": (), "keeping": None}
    found = told(None, outcome="proven", drift=drift, **short)
    (lasts,) = lasting_verdicts(ring(), found)
    assert lasts.word == "Lasts 1.25 days and more"
    assert "for the 1.25 days looked at (compass drift" in lasts.claim
    (margin,) = lasting_section(ring(), found).pictures
    assert margin.title == "Margin over time" and "slot" not in margin.caption
    lost = told(days_proven=1.7)
    assert "it loses that after 1.7 days: " in lasting_advice(ring(), lost)
    assert lasting_verdicts(ring(), lost)[0].word == "Lasts 1.7 days"
    path = Motion().trajectory(ring().constellation, 0.0, 1.25 * 86400.0)
    given = replace(ring(), motion=Motion("ephemeris", table=path))
    (row,) = lasting_answers(given, found)
    assert (row.question, row.written) == (
        "On its given paths it lasts", "1.25 days, all they are given for",
    )  # fmt: skip
    assert lasting_sentence(given, found) == f"{row.question} {row.written}."
    assert lasting_sentence(given, lost) == "On its given paths it lasts 1.7 days."
    assert lasting_verdicts(given, found)[0].word == "Lasts 1.25 days, all they are given for"
    # a share is lost in a stretch of days, which the command must reach
    shared = Glance(ring(), 13.3, 40.0, "4 satellites", 20.0)
    assert shared.answer().sure.endswith("--days 20")
    assert Glance(ring(), 1.7, 40.0, "3 in view", 1.7).answer().sure.endswith("--days 3")
    assert Glance(given, 1.25, 1.25, "").sentence.endswith("1.25 days, all they are given for.")
    # looked at for less than they are given for, or lost there: nobody leaves given paths alone
    longer = replace(
        given, motion=Motion("ephemeris", table=replace(path, breaks=2.0 * path.breaks))
    )
    (verdict,) = lasting_verdicts(longer, found)
    assert verdict.word == "Lasts 1.25 days and more"
    assert "proven on its given paths for the 1.25 days looked at" in verdict.claim
    assert lasting_answers(longer, found)[0].written == "1.25 days and more"
    assert Glance(longer, 1.25, 1.25, "").words == "1.25 days and more"
    assert "proven on its given paths for" in lasting_verdicts(given, lost)[0].claim
    assert lasting_advice(given, lost).startswith("On its given paths it loses that after 1.7 days")


def test_what_is_open_or_nowhere_better_is_said():
    design = ring()
    lasts, _, radius = lasting_verdicts(design, told(None, ((-400.0, 20.0), (0.0, 55.0))))
    assert lasts.word == "Lasts at least 31 days"
    assert radius.word == "No radius tried does without keeping"
    assert "the best, 20427 km, is proven for 55 days" in radius.claim
    own = lasting_verdicts(design, told(radii=((0.0, 687.0),)))[-1]
    assert own.word.startswith("At its own radius it keeps itself")


@pytest.mark.slow
def test_a_resonant_design_is_told_its_cost_and_another_radius(monkeypatch):
    """A margin of a degree goes within weeks; 400 km away it stays for the 60 days looked at."""
    monkeypatch.setattr(module, "HORIZON", 60.0)
    monkeypatch.setattr(module, "SATELLITE_DAYS", 1e4)
    design = ring(mask=0.0)
    mask = float(
        int(10 * compass.fold(design, motion="two-body").to_dict()["mask_margin_deg"]) / 10
    )
    design = ring(mask=mask - 0.9)
    found = outlook(design)
    assert 1.0 < found.days_proven < 60.0
    assert found.lasting_radii
    assert found.keeping.delta_v_mean_m_s_year > 5.0
    section = lasting_section(design, found)
    said = words(section)
    for part in ("Keeping it costs", "400 km", "it keeps itself for 0.2 years", "trimmed once"):
        assert part in said
    for command in commands(design, found).values():
        assert command in said
    assert {p.stem for p in section.pictures} >= {"lasting-radius", "lasting-slots"}
    assert [t.title.split()[0] for t in section.tables] == ["The", "Keeping"]
    # the radius that is named keeps itself by the other command too
    days = compass.drift(design, days=60.0, radius_km=[found.lasting_radii[0].radius_km]).radii[0]
    assert days.days_proven == 60.0


def test_orbits_without_slots_are_followed_all_the_same(near):
    oval = read_design_text(
        'name = "o"\nepoch = 2030-01-01T12:00:00\n[constellation]\npattern = "elements"\n'
        '[[constellation.satellite]]\nname = "a"\nsemi_major_axis_km = 20000\neccentricity = 0.1\n'
        'inclination_deg = 10\n[coverage]\nfold = 1\n[motion]\nmodel = "numerical"\n' + PLAIN
    )
    found = outlook(oval)
    assert (found.radius_km, found.radii) == (20000.0, ())
    assert lasting_verdicts(oval, found)[0].holds is False


class Asked:
    """Stand-ins for what takes long: a claim that is lost, radii that last from a distance on."""

    def __init__(self, monkeypatch, lasts_from):
        self.radii = []
        self.lasts_from = lasts_from
        monkeypatch.setattr(module, "kept", lambda question, work: (work(), False))
        monkeypatch.setattr(module, "_claim", lambda design, horizon: self.claim(horizon))
        monkeypatch.setattr(
            module, "_over_time", lambda design, days: {**vars(DRIFT), "days": [0.0, days]}
        )
        monkeypatch.setattr(module, "at_radii", self.at_radii)

    def claim(self, horizon):
        assert horizon > 0.0
        return Settled("1 in view", Outcome.REFUTED, 30.0, 30.1, "")

    def at_radii(self, design, radii, *, days):
        own = design.constellation.semi_major_axis[0] / 1e3
        self.radii += [round(r - own) for r in radii]
        return tuple(
            RadiusLasts(r, days if abs(r - own) >= self.lasts_from else 40.0, None, 5.0, 9.0, True)
            for r in radii
        )


@pytest.mark.parametrize(("years", "said"), [(1.0001, "1 year"), (2.0, "2 years")])
def test_one_year_is_written_as_one(years, said):
    rows = lasting_answers(ring(), told(keeping=replace(KEPT, years=years)))
    assert f"simulated over {said}: compass keep" in rows[1].sure


def test_radii_are_tried_from_near_to_far(monkeypatch):
    def refuse(design):
        raise ArgumentError("box_deg = 0: must be more than 0")

    monkeypatch.setattr(module, "keep", refuse)
    resonant = Asked(monkeypatch, 400)
    found = outlook(ring())
    assert resonant.radii == [-400, 400]
    assert [r.days_proven for r in found.lasting_radii] == [687.0, 687.0]
    assert found.keeping is None
    assert found.notes == ("keeping: box_deg = 0: must be more than 0",)
    assert found.drift.days[-1] == 37.5
    stubborn = Asked(monkeypatch, 800)
    assert len(outlook(ring()).lasting_radii) == 2
    assert stubborn.radii == [-400, 400, -800, 800]
    trimmed = Asked(monkeypatch, 0)
    assert outlook(ring(radius=18000)).lasting_radii[0].radius_km == 18000
    assert trimmed.radii == [0]


def test_what_a_design_requires_is_looked_at_and_listed(monkeypatch):
    """Of two places the one that no satellite rises high over is lost, and named."""
    monkeypatch.setattr(module, "HORIZON", 0.1)
    monkeypatch.setattr(module, "GLANCE", 0.05)
    design = read_design_text(RING.format(radius=20427.7, mask=0.0, n=5) + PLACES)
    found = outlook(design)
    assert (found.asked, found.outcome, found.days_proven) == (
        "all that is required",
        "refuted",
        0.0,
    )
    assert found.loss.startswith("0 in view")
    assert found.loss.endswith("(far)")
    (said,) = lasting_verdicts(design, found)
    assert "all that is required: 0 in view at" in said.claim
    tables = [b for b in lasting_section(design, found).blocks if isinstance(b, Table)]
    assert [(row[0], row[3]) for row in tables[0].rows] == [("near", ""), ("far", "pole")]


def test_oval_orbits_have_other_radii_and_no_box_of_their_own(monkeypatch):
    monkeypatch.setattr(module, "keep", pytest.fail)
    asked = Asked(monkeypatch, 400)
    c = ring().constellation
    oval = replace(ring(), constellation=replace(c, eccentricity=np.full(5, 0.1)))
    found = outlook(oval)
    assert asked.radii == [-400, 400]
    assert found.lasting_radii[0].radius_km == 20027.7
    assert found.notes[-1].endswith("compass keep design --box-deg DEGREES")
    several = np.array([2.0e7, 2.0e7, 2.1e7, 2.1e7, 2.1e7])
    unlike = replace(ring(), constellation=replace(c, semi_major_axis=several))
    found = outlook(unlike)
    assert (found.radii, found.radius_km, len(found.notes)) == ((), None, 2)
    assert asked.radii == [-400, 400]


def test_many_satellites_are_followed_for_less_time(monkeypatch):
    monkeypatch.setattr(module, "keep", lambda design: None)
    asked = Asked(monkeypatch, 400)
    found = outlook(ring(n=41))
    assert found.horizon_days == pytest.approx(15 * 687 / 41)
    assert asked.radii == []
    assert len(found.notes) == 2


def test_access_of_an_ephemeris_looks_as_far_as_it_is_known():
    path = Motion().trajectory(ring().constellation, 0.0, 2 * 86400.0)
    design = replace(ring(), motion=Motion("ephemeris", table=path))
    assert _known_sols(design) * SOLAR_DAY.value == pytest.approx(2 * 86400.0)
    assert _known_sols(replace(design, access_duration=86400.0)) is None
    assert _known_sols(ring()) is None


def test_the_equator_has_no_sign():
    at = SimpleNamespace(witness=SimpleNamespace(fold=0, latitude=-1e-9, longitude=-1e-9))
    assert module._place(at) == "0 in view at the equator, 0.00° E"

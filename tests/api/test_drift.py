"""A design left alone."""

import dataclasses
import json
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import compass
from compass.api.drift_files import elements_text
from compass.api.lasting import LastingResult
from compass.api.radii import read_radii
from compass.cli.main import program
from compass.coverage.certificate import Outcome
from compass.document import text
from compass.errors import ArgumentError
from compass.frames import FIGURES, prime_meridian_angle
from compass.inputs import read_design, read_design_text
from compass.orbits.motion import Motion
from compass.orbits.trimming import Trim
from tests.test_conventions import assert_in_conventions

FIVE = """
name = "five"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = 5
planes = 5
phasing = 1
inclination_deg = 43.66
radius_km = 19000
[coverage]
fold = 1
[motion]
model = "{model}"
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("drift") / "five.toml"
    # the least of fields: interpreted kernels take their time for each term
    path.write_text(FIVE.format(model="numerical") + "gravity_degree = 2\nmoons = false\n")
    return path


@pytest.fixture(scope="module")
def found(file):
    return compass.drift(file, days=3.0, trimmed=False)


def test_json_lists_margin_and_room_over_the_days(found):
    out = found.to_dict()
    assert out["days"] == [0.0, 1.0, 2.0, 3.0]
    assert len(out["margin_deg"]) == len(out["room_deg"]) == 4
    assert (out["outcome"], out["days_proven"], out["first_loss_days"]) == ("proven", 3.0, None)
    assert out["room_deg"][0] == pytest.approx(out["slot_box"]["sideways_deg"], abs=0.01)
    # the least of some time is not above a moment of it, and room is not above either
    assert np.all(np.array(out["margin_deg"]) <= np.array(out["margin_at_moment_deg"]) + 0.01)
    assert np.all(np.array(out["room_deg"]) <= np.array(out["margin_at_moment_deg"]) + 0.01)
    first = out["per_satellite"][0]
    assert set(first) == {"name", "in_track_deg", "cross_track_deg", "radial_km"}
    json.dumps(out)


def test_several_designs_drift_as_one_network(file, found):
    whole = read_design(file)
    three, two = (
        replace(whole, name=name, constellation=whole.constellation.without(others))
        for name, others in (("three", [3, 4]), ("two", [0, 1, 2]))
    )
    both = compass.drift(three, two, days=3.0, trimmed=False).to_dict()
    assert both["margin_deg"] == pytest.approx(found.to_dict()["margin_deg"], abs=1e-3)
    assert len(both["per_satellite"]) == 5


def test_the_text_says_how_long_first(found):
    words = text(found.document())
    assert words.splitlines()[0].startswith("five: PROVEN: 1 or more satellites above 0 deg")
    assert "GMM-3" in words
    assert "the push of Mars's field swings" in words
    assert "In its slot at the end of the span" in words
    assert found.plot().get_title() == "five"


def test_a_two_body_design_is_followed_under_the_default_forces():
    design = read_design_text(FIVE.format(model="two-body"))
    assert "to degree 8, Sun" in compass.drift(design, days=0.5).motion
    assert compass.fold(design, days=0.5).motion == "two-body motion"


@pytest.mark.slow
def test_a_trim_is_written_as_a_design_and_a_radius_as_a_row(file, tmp_path):
    out = tmp_path / "elements.toml"
    run = CliRunner().invoke(
        program,
        ["drift", str(file), "--days", "20", "--trim", "--radius-km", "18000,20430", "--elements",
         str(out), "--json"],
    )  # fmt: skip
    assert run.exit_code == 0, run.output
    printed = json.loads(run.stdout)
    assert printed["trimmed"]
    low, resonant = printed["radii"]
    assert (low["radius_km"], low["trimmed"], resonant["trimmed"]) == (18000.0, True, False)
    assert low["beat_days"] < 10 < resonant["beat_days"]
    written = read_design(out).constellation
    assert written.semi_major_axis / 1e3 == pytest.approx(printed["trim"]["semi_major_axis_km"])
    tolerance = printed["trim"]["tolerance"]
    # 1.5 n / a, degrees a day for a kilometre, times the days and the tolerance is the least room
    rate = np.degrees(1.5 * np.sqrt(42828.37 / 19000.0**3) / 19000.0) * 86400
    assert tolerance["semi_major_axis_km"] * rate * 20 == pytest.approx(min(printed["room_deg"]))


def test_fold_over_days_is_the_same_claim(file):
    held = compass.fold(file, days=2.0)
    assert isinstance(held, LastingResult)
    assert held.holds
    assert held.to_dict()["days_proven"] == 2.0
    later = compass.fold(file, days=0.5, start_day=1.0, motion="j2")
    assert later.to_dict()["start_day"] == 1.0
    lost = compass.fold(file, days=1.0, mask_deg=30.0)
    assert lost.outcome is Outcome.REFUTED
    assert "lost on day 0.00000" in text(lost.document())
    assert not lost.holds
    hours = compass.fold(file, duration_h=6.0)
    assert hours.days == 0.25


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "nothing is for ever: give the days"),
        ({"days": 0.0}, "days = 0: allowed above 0"),
        ({"days": 1.0, "losses": 1}, "losses = 1: looked at for all time"),
        ({"days": 1.0, "start_day": -1.0}, "start_day = -1"),
    ],
)
def test_fold_over_days_refuses(file, options, message):
    with pytest.raises(ArgumentError, match=message):
        compass.fold(file, **options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"days": 0.0}, "days = 0: allowed above 0"),
        ({"start_day": -1.0}, "start_day = -1: allowed 0 to"),
        ({"days": 1.0, "step_days": 2.0}, "step_days = 2: allowed above 0 to days"),
    ],
)
def test_drift_refuses(file, options, message):
    with pytest.raises(ArgumentError, match=message):
        compass.drift(file, **options)


def test_a_span_of_less_than_a_second_has_two_moments(file):
    found = compass.drift(file, days=1e-7)
    assert found.drift.times.tolist() == [0.0, 1e-7 * 86400.0]
    assert str(found).startswith("five: PROVEN")


def test_a_trim_needs_forces_and_a_sweep_one_axis(file):
    design = read_design_text(FIVE.format(model="j2"))
    with pytest.raises(
        ArgumentError, match="trimmed: needs forces, which mean motion under J2 has not"
    ):
        compass.drift(design, days=1.0, trimmed=True)
    oval = read_design_text(
        'name = "o"\n[constellation]\npattern = "elements"\n[[constellation.satellite]]\nname = "a"\n'
        "semi_major_axis_km = 20000\neccentricity = 0.1\ninclination_deg = 10\n[coverage]\nfold = 1"
    )
    swept = compass.drift(oval, days=0.2, radius_km=[21000.0]).radii[0]
    assert (swept.radius_km, swept.days_proven) == (21000.0, 0.0)
    other = dataclasses.replace(compass.read_design(file).constellation, epoch=0.0)
    two = dataclasses.replace(oval.constellation, epoch=0.0) + other
    unlike = dataclasses.replace(oval, constellation=two)
    with pytest.raises(ArgumentError, match=r"several axes, 19000 to 20000 km, for which one"):
        compass.drift(unlike, days=0.2, radius_km=[20000.0])


def test_an_oval_orbit_has_a_margin_and_no_room():
    oval = read_design_text(
        'name = "o"\n[constellation]\npattern = "elements"\n[[constellation.satellite]]\nname = "a"\n'
        "semi_major_axis_km = 20000\neccentricity = 0.1\ninclination_deg = 10\n[coverage]\nfold = 1"
    )
    out = compass.drift(oval, days=0.1)
    assert (out.to_dict()["room_deg"], out.to_dict()["per_satellite"]) == (None, None)
    assert out.first_loss_days == pytest.approx(0.0, abs=2e-5)
    assert "lost on day" in text(out.document())


@pytest.mark.parametrize(
    ("given", "radii"),
    [("19000..19200:100", [19000, 19100, 19200]), ("1e4,2e4", [1e4, 2e4])],
)
def test_radii_are_read(given, radii):
    assert read_radii(given) == pytest.approx(radii)


@pytest.mark.parametrize("given", ["", "a..b:c", "1..2:0", "5..4:1", "1..1e6:1", "-3"])
def test_wrong_radii_are_refused(given):
    with pytest.raises(ArgumentError, match=r"write FIRST\.\.LAST:STEP or A,B,C"):
        read_radii(given)


def test_moons_are_kept_away_from(found, file):
    moons = found.to_dict()["moons"]
    assert [m["moon"] for m in moons] == ["phobos", "deimos"]
    assert 5000 < moons[0]["distance_km"] < 19000 + 9400
    assert "closest approach of any satellite to the moons: Phobos" in text(found.document())
    near = replace(found, avoid_km=moons[1]["distance_km"] + 1.0)
    assert found.avoids
    assert not near.avoids
    assert found.holds
    assert not near.holds
    assert "from their centres is not kept" in text(near.document())
    with pytest.raises(ArgumentError, match="avoid_km = 0: allowed above 0"):
        compass.drift(file, days=1.0, avoid_km=0.0)


@pytest.mark.slow
def test_the_file_over_time_keeps_to_the_conventions(file, tmp_path):
    path = tmp_path / "drift.nc"
    run = CliRunner().invoke(program, ["drift", str(file), "--days", "1", "-o", str(path)])
    assert run.exit_code == 0, run.output
    with xr.open_dataset(path, engine="h5netcdf") as read:
        assert read.room.dims == ("time",)
        assert sorted(read.in_track.shape) == [2, 5]
        assert read.attrs["days_proven"] == 1.0
        assert float(read.least_margin.min()) <= float(read.margin.min()) + 0.01
    assert_in_conventions(path)


def test_the_elements_to_inject_fly_under_the_same_forces(found):
    design = replace(found.design, motion=Motion("numerical"))
    c = design.constellation
    done = Trim(c, np.zeros(5), 1e6, 1e5, 1e-9, 1e-12, 0.1, 0.01)
    written = elements_text(replace(found, design=design, trim=done))
    assert written.startswith("# Osculating elements to inject, trimmed over 3 days.")
    assert "#   semi_major_axis_km " in written
    assert read_design_text(written).motion == Motion("numerical")


def test_the_orbits_to_inject_are_written_as_oem_to_the_end_of_the_span(found, tmp_path):
    """Read as a design of trajectories they are where the elements, integrated, are."""
    c = found.design.constellation
    done = Trim(c, np.zeros(5), 1e6, 1e5, 1e-9, 1e-12, 0.1, 0.01)
    folder = tmp_path / "orbits"
    replace(found, trim=done).write_orbits(folder)
    assert len(list(folder.glob("*.oem"))) == 5
    (tmp_path / "flown.toml").write_text(
        'name = "flown"\n[constellation]\npattern = "ephemeris"\nfiles = ["orbits/*.oem"]\n'
    )
    flown = read_design(tmp_path / "flown.toml")
    there = flown.motion.trajectory(flown.constellation, 0.0, 3 * 86400.0)
    here = found.design.motion.trajectory(c, 0.0, 3 * 86400.0)
    r, other = (path.states([0.0, 2.9 * 86400.0])[0] for path in (here, there))
    assert np.linalg.norm(r - other, axis=-1).max() < 0.1


def test_elements_need_a_trim(file, tmp_path):
    run = CliRunner().invoke(
        program, ["drift", str(file), "--days", "0.2", "--elements", str(tmp_path / "x.toml")]
    )
    assert "add --trim" in str(run.exception)


def test_an_ellipsoid_is_proven_as_fold_proves_it(file):
    own = FIGURES["iau-ellipsoid"]
    design = dataclasses.replace(compass.read_design(file), figure=own)
    drifted, folded = compass.drift(design, days=0.02), compass.fold(design, days=0.02)
    assert drifted.drift.lasting == folded.lasting
    assert drifted.drift.lasting.stretch == own.stretch
    assert drifted.to_dict()["figure"] == own.title
    on_sphere = compass.drift(file, days=0.02)
    assert on_sphere.drift.lasting.stretch == 1.0
    said = "margins are of the ellipsoid, stretched to its equatorial sphere"
    assert said in " ".join(str(drifted).split())
    assert said not in " ".join(str(on_sphere).split())
    assert drifted.drift.margin == pytest.approx(on_sphere.drift.margin, abs=0.01)
    assert np.all(drifted.drift.margin != on_sphere.drift.margin)


#: One satellite that hovers over Jezero's meridian, and what is wanted of it.
HOVER = """
name = "hover"
figure = "iau-sphere"
[constellation]
pattern = "walker-delta"
satellites = 1
planes = 1
phasing = 0
inclination_deg = 0
repeat = [1, 1]
[coverage]
fold = 1
[[station]]
name = "below"
latitude_deg = 0
longitude_deg = {below}
mask_deg = 0
[[station]]
name = "behind"
latitude_deg = 0
longitude_deg = {behind}
mask_deg = 0
[[requirement]]
name = "seen"
sites = ["below"]
fold = 1
[[requirement]]
name = "unseen"
sites = ["below", "behind"]
fold = 1
[[requirement]]
name = "belt"
region = "lat:-1:1"
fold = 1
[[requirement]]
name = "often"
sites = ["below"]
fold = 1
share = 0.9
"""


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    path = tmp_path_factory.mktemp("wanted") / "hover.toml"
    under = -float(np.degrees(prime_meridian_angle(0.0, 0.0))) % 360
    path.write_text(HOVER.format(below=under, behind=(under + 180) % 360))
    return compass.drift(path, days=0.02, region=f"polygon:-2,{under - 2};-2,{under + 2};2,{under}")


def test_requirements_are_followed_each_at_its_own_places(wanted):
    out = wanted.to_dict()
    seen, unseen, belt, often = out["requirements"]
    assert (seen["outcome"], seen["place"], seen["days_proven"]) == ("proven", "below", 0.02)
    # a cap that covers the place below and no more has nearly all of its radius to spare
    cap = np.degrees(np.arccos(3396.19 / wanted.design.constellation.semi_major_axis[0] * 1e3))
    assert seen["room_deg"][0] == pytest.approx(cap, abs=0.1)
    assert seen["slot_box"]["sideways_deg"] == pytest.approx(cap, abs=0.1)
    assert cap - 3 < out["room_deg"][0] < cap - 1.9
    assert (unseen["outcome"], unseen["place"]) == ("refuted", "behind")
    assert unseen["first_loss_days"] < 1e-4
    # for a whole belt a cap would have to reach round to the antipode
    assert belt["outcome"] == "refuted"
    assert belt["room_deg"][0] == pytest.approx(cap - 180, abs=0.1)
    assert (often["outcome"], often["days_proven"]) == ("proven", 0.02)
    assert often["share"] == [1.0, 1.0]


def test_what_a_design_requires_decides_and_not_its_fold_everywhere(wanted):
    assert wanted.lasting.holds
    assert not wanted.holds
    said = text(wanted.document())
    assert "LOST: 4 requirements: 2 proven for the whole span, 2 lost" in said
    kept = replace(wanted, promises=wanted.promises[:1])
    assert kept.holds
    assert "KEPT: 1 requirement" in text(kept.document())
    often = wanted.promises[3]
    for outcome, evidence, holds, word in (
        (Outcome.UNDECIDED, "none", False, "UNDECIDED: 2 requirements: 1 proven"),
        (Outcome.PROVEN, "sampled", True, "1 kept for the whole span by samples"),
    ):
        verdict = replace(often.geometry.verdict, evidence=evidence)
        told = replace(often, geometry=replace(often.geometry, outcome=outcome, verdict=verdict))
        some = replace(wanted, promises=(wanted.promises[0], told))
        assert some.holds is holds
        assert word in text(some.document())
        assert some.to_dict()["requirements"][1]["evidence"] == evidence


@pytest.mark.slow
def test_of_shares_alone_no_verdict_is_given_on_a_fold_that_nobody_asked_for(wanted):
    often = wanted.design.requirements[3]
    found = compass.drift(replace(wanted.design, fold=2, requirements=(often,)), days=0.02)
    out, said = found.to_dict(), " ".join(text(found.document()).split())
    assert found.holds and (out["outcome"], out["days_proven"]) == ("proven", 0.02)
    assert (out["first_loss_days"], out["witness"], found.dataset.outcome) == (None, None, "proven")
    assert found.lasting.outcome is Outcome.REFUTED  # of two satellites, which there are not
    assert "REFUTED" not in said and "or more satellites above" not in said
    assert "margin and room are of the design's own 2 satellites above 0 deg, below" in said
    rare = compass.Requirement.of("rare", sites=often.sites, fold=2, mask_deg=0, share=0.5)
    lost = compass.drift(replace(wanted.design, requirements=(often, rare)), days=0.02)
    assert not lost.holds and lost.to_dict()["outcome"] == "refuted"
    assert (lost.days_proven, lost.first_loss_days) == (0.0, 0.02)


@pytest.mark.slow
def test_without_another_question_the_place_that_is_lost_first_is_followed(wanted):
    """Nobody asked for the whole sphere, which one satellite never sees; radii likewise."""
    design = replace(wanted.design, requirements=wanted.design.requirements[:1])
    kept = compass.drift(design, days=0.02, radius_km=[20000.0])
    assert kept.holds
    assert (kept.lasting.lasting.region.name, kept.mask_deg) == ("below", 0.0)
    assert "above 0 deg, below, 0.02 days" in text(kept.document())
    assert "over its own vertical" in kept.to_dict()["figure"]
    assert kept.drift.box == kept.promises[0].box
    (lower,) = kept.radii
    assert (lower.days_proven, lower.first_loss_days) == (0.02, None)
    both = replace(design, requirements=wanted.design.requirements[:2])
    lost = compass.drift(both, days=0.02, radius_km=[20000.0])
    assert lost.to_dict()["region"] == "behind"
    assert lost.radii[0].days_proven == 0.0
    assert compass.drift(both, days=0.02, region="globe").to_dict()["region"] == "whole sphere"


@pytest.mark.slow  # interpreted, a map of where two are in view takes most of an hour
def test_losses_are_as_many_more_in_view(wanted):
    """One of one satellite lost, none is left: lost at once, wherever."""
    seen = replace(wanted.design.requirements[0], losses=1)
    out = compass.drift(replace(wanted.design, requirements=(seen,)), days=0.02)
    assert out.promises[0].outcome is Outcome.REFUTED
    assert out.drift.lasting.fold == 2


ALOFT = """
name = "users in orbit"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = 15
planes = 5
phasing = 1
inclination_deg = 45
orbit = "areosynchronous"
[coverage]
mask_deg = 5
[signal]
clock_m = 3
ephemeris_m = [2, 8, 5]
receiver = { noise_m = 0.5, zenith_m = 0.5 }
[motion]
model = "numerical"
gravity_degree = 2
moons = false
"""


@pytest.mark.slow
def test_beams_that_reach_all_users_lose_them_when_caps_do():
    """Boxes of place and time against the proof by caps: the same claim, the same moment."""
    design = read_design_text(ALOFT)
    caps = compass.Requirement.of("caps", regions=["globe"], fold=4, mask_deg=6.25)
    both = replace(design, requirements=(caps, replace(caps, name="beams", beam=np.radians(60))))
    found = compass.drift(both, days=2)
    one, other = found.promises
    assert one.outcome is other.outcome is Outcome.REFUTED
    assert other.evidence == "proven"
    assert 0.0 < one.first_loss_days < 2.0
    assert other.first_loss_days == pytest.approx(one.first_loss_days, abs=2 * 60 / 86400)
    narrow = replace(caps, mask=0.0, beam=np.radians(9.0))  # as a mask of 19.8 deg
    worse = compass.drift(replace(design, requirements=(narrow,)), days=0.05)
    assert worse.promises[0].first_loss_days < 0.01


@pytest.mark.slow
def test_users_in_orbit_are_followed_by_samples():
    """As `check` asks for the same days: shares kept, an always missed or open, never proven."""
    users = {"regions": ["globe"], "altitude_km": 400, "mask_deg": -20}
    often = {"share": 0.9, "share_of": "area-time"}
    wanted = tuple(
        compass.Requirement.of(name, **users, **more)
        for name, more in (
            ("kept", {"error_position_m_at_most": 60, **often}),
            ("lost", {"error_position_m_at_most": 1, **often}),
            ("missed", {"error_position_m_at_most": 8}),
            ("open", {"error_position_m_at_most": 1e6}),
        )
    )
    design = replace(read_design_text(ALOFT), requirements=wanted)
    found = compass.drift(design, days=1)
    kept, lost, missed, left = found.promises
    assert {each.evidence for each in found.promises} == {"sampled"}
    outcomes = [each.outcome for each in found.promises]
    assert outcomes == [Outcome.PROVEN, *2 * [Outcome.REFUTED], Outcome.UNDECIDED]
    assert (kept.decides.days_proven, lost.first_loss_days) == (1.0, 1.0)
    worst = missed.geometry.verdict.worst
    assert (worst.value > 8, missed.first_loss_days) == (True, worst.time / 86400)
    assert (left.decides.days_proven, left.first_loss_days) == (0.0, None)
    said = " ".join(text(found.document()).split())
    assert "LOST: 4 requirements: 1 kept for the whole span by samples, 2 lost, 1 undecided" in said
    assert "missed: looked at over the whole span by random samples, always; " in said
    asked = compass.check(design, days=1)
    assert [v.met for v in asked.verdicts] == [True, False, False, None]


@pytest.mark.slow
def test_geometry_is_told_stretch_by_stretch(wanted):
    """One satellite never makes a fix: missed from the beginning, always and for a share."""
    places = wanted.design.requirements[0].sites
    always = compass.Requirement.of("always", sites=places, pdop_at_most=6)
    often = compass.Requirement.of("often", sites=places, fold=4, pdop_at_most=6, share=0.9)
    found = compass.drift(replace(wanted.design, requirements=(always, often)), days=0.02)
    first, second = found.to_dict()["requirements"]
    assert (first["outcome"], second["outcome"]) == ("refuted", "refuted")
    assert (second["days_proven"], second["first_loss_days"]) == (0.0, 0.02)
    assert (second["share"], second["place"]) == ([0.0, 0.0], "below")
    said = " ".join(text(found.document()).split())
    assert "looked at in stretches of up to 7 days by proven bounds, always" in said
    assert "0 to 0 % in the days 0 to 0.02" in said


def test_an_interruption_says_what_is_known_by_then(file, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    for place, known in (
        ("compass.coverage.drift.least_margins", "proven for 0.1 days\n"),
        ("compass.coverage.lasting._bands", "proven up to day 0\n"),
    ):
        with monkeypatch.context() as patched:
            patched.setattr(place, interrupt)
            with pytest.raises(KeyboardInterrupt) as stopped:
                compass.drift(file, days=0.1)
        assert "\n".join(stopped.value.__notes__) + "\n" == known


def test_radii_known_before_an_interruption_are_said(file, monkeypatch):
    from compass.api import radii

    look = radii._at_radius

    def interrupt(design, radius, *rest):
        if radius == 18000.0:
            raise KeyboardInterrupt
        return look(design, radius, *rest)

    monkeypatch.setattr(radii, "_at_radius", interrupt)
    with pytest.raises(KeyboardInterrupt) as stopped:
        radii.at_radii(read_design(file), [19000.0, 18000.0], days=0.1)
    assert stopped.value.__notes__ == ["at 19000 km proven for 0.1 of 0.1 days"]


def test_what_takes_long_is_foretold(file, monkeypatch, capsys):
    monkeypatch.setattr("compass.api.progress.LONG_S", 0.0)
    compass.drift(file, days=0.1, progress=True)
    assert re.search(r"margins: about \d+ s\n", capsys.readouterr().err)

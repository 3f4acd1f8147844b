"""Searches for requirements: small ones whose answers are known, and what is kept out."""

import json
from dataclasses import replace

import numpy as np
import pytest

import compass
from compass import Requirement
from compass.coverage.clearance import always_clear
from compass.coverage.region import read_region
from compass.coverage.users import region_users
from compass.errors import ArgumentError, DesignError
from compass.frames import FIGURES
from compass.inputs import read_design
from compass.orbits.constellation import from_pattern
from compass.orbits.pattern import Pattern
from compass.sites import Mask, Site
from compass.study import requirement_patterns as patterns
from compass.study import requirement_samples as samples
from compass.study import requirement_search as module
from compass.study.requirement_question import Question

EQUATOR = Site("equator", 0.0, 0.3)
FILE = """
name = "small"
[coverage]
mask_deg = 5
[[station]]
name = "E"
latitude_deg = 0
longitude_deg = 20
[[requirement]]
name = "one in view"
sites = ["E"]
fold = 1
"""


@pytest.fixture
def flat(monkeypatch):
    """Only a few inclinations: kernels are slow where they are interpreted."""
    monkeypatch.setattr(patterns, "STEP", 45.0)
    monkeypatch.setattr(patterns, "TURN_STEP", 40.0)
    monkeypatch.setattr(samples, "SAMPLES", 100)


def test_a_ring_for_a_site_on_the_equator(flat, tmp_path):
    """Caps of 75 degrees: three satellites on the equator, and one over a place that it keeps."""
    path = tmp_path / "needs.toml"
    path.write_text(FILE)
    found = compass.search(require=path, radius_km=20427.7, max_satellites=4)
    assert found.holds
    best = found.best.constellation
    assert (best.size, best.inclination[0]) == (3, 0.0)
    assert found.sentence.startswith("Build 3/")
    assert "next best" in found.sentence
    known = found.to_dict()
    json.dumps(known, allow_nan=False)
    assert (known["smallest"], known["sentence"]) == (3, found.sentence)
    assert {"satellites", "planes", "phasing", "inclination_deg"} <= set(known["candidates"][0])
    out = tmp_path / "found.toml"
    found.write(out)
    again = read_design(out)
    assert again.constellation == best or again.constellation.size == 3
    assert compass.check(again).holds
    closed = compass.search(require=path, orbit="areosynchronous", max_satellites=2)
    assert closed.best.constellation.size == 1
    closed.write(out)
    assert 'orbit = "areosynchronous"' in out.read_text()
    assert compass.check(out).holds


def test_what_meets_nothing_says_so(flat):
    asked = [Requirement("both poles", regions=("lat:80:90",), fold=3)]
    none = compass.search(require=asked, radius_km=9000, max_satellites=3)
    assert not none.holds
    assert none.sentence.startswith("No walker-delta of up to 3 satellites meets all requirements")
    assert none.to_dict()["smallest"] is None
    assert "NONE: No walker-delta" in str(none)
    with pytest.raises(ArgumentError, match="search: No walker-delta"):
        none.write("nowhere.toml")


def test_geometry_keeps_a_ring_out(flat):
    found = compass.search(
        fold=4, region="lat:-5:5", pdop_at_most=10, share=0.5, radius_km=20427.7, max_satellites=9
    )
    ring = next(k for k in found.outcome.kept_out if k.constellation.inclination[0] == 0.0)
    assert ring.constellation.size <= 9
    assert not any(one.constellation.inclination[0] == 0.0 for one in found.outcome.met)


def test_satellites_that_meet_are_kept_out(flat):
    asked = [Requirement("one", regions=("lat:-5:5",), fold=1)]
    close = compass.search(require=asked, radius_km=20427.7, max_satellites=4, least_approach_deg=0)
    apart = compass.search(
        require=asked, radius_km=20427.7, max_satellites=4, least_approach_deg=100
    )
    assert close.best.closest_approach <= apart.best.closest_approach
    assert np.degrees(apart.best.closest_approach) >= 100
    assert "kept out" in apart.sentence
    assert "come within" in apart.sentence


def test_turns_over_the_ground_are_all_there_are():
    """Three on one plane of closed tracks: a turn of 120 degrees brings them back."""
    q = Question((), FIGURES["iau-sphere"], Mask(), 2e7, (1, 1), 0.0, ("walker-delta",), 3)
    turns = patterns.turns(q, Pattern("walker-delta", 3, 1, 0, 0.0))
    assert max(turns) < np.radians(120) <= max(turns) + 2 * (turns[1] - turns[0])
    half = patterns.turns(
        Question((), q.figure, q.mask, q.radius, (2, 1), 0.0, q.kinds, 3),
        Pattern("walker-delta", 3, 1, 0, 0.0),
    )
    assert max(half) < np.radians(60) + 1e-9
    open_ = Question((), q.figure, q.mask, q.radius, None, 0.0, q.kinds, 3)
    assert patterns.turns(open_, Pattern("walker-delta", 3, 1, 0, 0.0)) == [0.0]


def looked_at(q, size):
    """Candidates of a size that have the folds wanted."""
    able, _ = patterns.sampled(q, list(patterns.grids(q, size)), 2)
    return [one for one in able if module._holds(q, one)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("band", "mask", "size"), [(15, 0, 9), (15, 10, 11), (30, 0, 10), (45, 10, 12)]
)
def test_bands_against_a_brute_force_of_others(band, mask, size, monkeypatch):
    """Fold alone, Walker delta at 20,427.7 km: one size below nothing covers."""
    monkeypatch.setattr(patterns, "STEP", 15.0)
    users = region_users(
        read_region(f"lat:-{band}:{band}"), FIGURES["iau-sphere"], Mask.constant(np.radians(mask))
    )
    asked = Requirement(
        "band", regions=(f"lat:-{band}:{band}",), fold=4, mask=float(np.radians(mask))
    )
    q = Question(
        (asked,), FIGURES["iau-sphere"], Mask(), 20427.7e3, None, 0.0, ("walker-delta",), 16
    )
    assert looked_at(q, size - 1) == []
    found = looked_at(q, size)
    assert found
    assert always_clear(found[0].constellation, users, 4)


def test_the_best_of_a_pattern_are_those_of_most_room_of_all_that_hold(monkeypatch):
    """A first glance that is no less than the room skips nothing that counts."""
    monkeypatch.setattr(patterns, "STEP", 6.0)
    asked = Requirement("band", regions=("lat:-20:20",), fold=1)
    q = Question(
        (asked,), FIGURES["iau-sphere"], Mask(), 20427.7e3, None, 0.0, ("walker-delta",), 5
    )
    able, _ = patterns.sampled(q, list(patterns.grids(q, 4)), 1)
    for name in {module._name(one) for one in able}:
        some = [one for one in able if module._name(one) == name]
        rooms = sorted(
            (-module._room(q, one, module.ROOM_BOXES), k)
            for k, one in enumerate(some)
            if module._holds(q, one)
        )
        known = [some[k].constellation for _, k in rooms[: module.TRIES]]
        found = module._best(q, some)
        assert [one.constellation for _, one in found] == known
        assert all(module._room(q, one, 0) >= module._room(q, one, 20_000) for one in some)


def test_bad_files_and_options_are_told(tmp_path, run):
    path = tmp_path / "needs.toml"
    path.write_text(FILE.replace('"E"]', '"F"]'))
    with pytest.raises(DesignError, match="sites = 'F': no such"):
        compass.search(require=path, radius_km=2e4, max_satellites=3)
    path.write_text('name = "x"\n[constellation]\npattern = "walker-delta"\nsatellites = 3\n'
                    "planes = 1\nphasing = 0\ninclination_deg = 0\nradius_km = 20000\n")  # fmt: skip
    with pytest.raises(DesignError, match="requires nothing; add a"):
        compass.search(require=path, radius_km=2e4, max_satellites=3)
    for options, message in (
        ({"share": 2.0}, "share = 2: allowed above 0 to 1"),
        ({"least_approach_deg": -1}, "least_approach_deg = -1: allowed 0 up to below 180"),
        ({"max_satellites": 100}, "max_satellites = 100: allowed 1 to 64"),
        ({"mask_deg": 95}, "mask_deg = 95: allowed 0 up to below 90"),
        ({"finalists": 0}, "finalists = 0: must be 1 or more"),
        ({"fold": None}, "fold: missing; give it, pdop_at_most, or requirements"),
        ({"region": ()}, ""),
    ):
        asked = {"fold": 1, "region": "globe", "radius_km": 2e4, "max_satellites": 1} | options
        if message:
            with pytest.raises(ArgumentError, match=message):
                compass.search(**asked)
    with pytest.raises(ArgumentError, match="fold: missing; give it, a region and a limit"):
        compass.search(radius_km=2e4, max_satellites=1)
    code, _, err = run(
        "search", "--max-satellites", 3, "--radius-km", 20000, "--require", "no.toml"
    )
    assert code == 2
    assert "no.toml: no such file" in err


def test_twins_are_one():
    one = from_pattern(Pattern("walker-delta", 6, 3, 0, 0.0), 2e7)
    other = from_pattern(Pattern("walker-delta", 6, 6, 3, 0.0), 2e7)
    lean = from_pattern(Pattern("walker-delta", 6, 3, 0, 0.3), 2e7)
    assert module._shape(one) == module._shape(one)
    assert module._shape(one) != module._shape(lean)
    assert (module._shape(one) == module._shape(other)) == np.allclose(
        *(np.sort(np.concatenate(module.pair_cosines(c))) for c in (one, other))
    )


def test_a_range_of_radii_says_what_height_buys(flat, run, monkeypatch):
    monkeypatch.setattr("compass.api.search.RADII", 2)
    # caps of 59.5 and 80.4 degrees around the equator: four of the one, three of the other
    asked, sizes = {"fold": 1, "region": "lat:-0.1:0.1", "max_satellites": 4}, [4, 3]
    found = compass.search(radius_km=(6700.0, 20427.7), **asked)
    assert found.best.constellation.size == sizes[1]
    assert found.question.radius == pytest.approx(20427.7e3)
    assert [each["smallest"] for each in found.to_dict()["by_radius"]] == sizes
    assert f"smallest by radius: {sizes[0]} at 6700 km, {sizes[1]} at 20427.7 km" in found.sentence
    with pytest.raises(ArgumentError, match="the least first, below the greatest"):
        compass.search(radius_km=(9000.0, 8000.0), **asked)
    with pytest.raises(ArgumentError, match="a range is for requirements; add a region"):
        compass.search(fold=1, radius_km=(8000.0, 9000.0), max_satellites=2)
    code, _, err = run("search", "--fold", 1, "--max-satellites", 2, "--radius-km", "low:high")
    assert code == 2 and "is not a number or LEAST:MOST" in err


@pytest.mark.slow
def test_orbits_that_nobody_steers_must_hold_too(flat):
    """Left alone at the areosynchronous radius, each goes to the nearer of two longitudes.

    Three caps of 80 degrees reach round the equator while no two are farther apart than 160: for
    a day, but not for 300.
    """
    belt = Requirement.of("one", regions="lat:-1:1", fold=1)
    few = {"require": [belt], "radius_km": 20427.7, "max_satellites": 3}
    day = compass.search(**few, days=1)
    assert day.holds and "left alone on real orbits, it is proven for 1 day;" in day.sentence
    assert day.to_dict()["days"] == 1
    long = compass.search(**few, days=300)
    assert not long.holds
    assert "left alone on real orbits, no proof of 1 satellite for 300 days" in long.sentence
    with pytest.raises(ArgumentError, match="days = 0: allowed above 0 to 36525 days, a century"):
        compass.search(**few, days=0)


WANTED = (
    {"fold": 2, "mask_deg": 10},
    {"fold": 4, "mask_deg": 0, "pdop_at_most": 20, "share": 0.3},
    {"fold": 1, "mask_deg": 20, "losses": 1},
)


@pytest.mark.slow
@pytest.mark.parametrize("orbit", [{"radius_km": 20000}, {"orbit": "areosynchronous"}], ids=str)
@pytest.mark.parametrize("seed", range(3))
def test_every_answer_over_random_sites_is_proven_anew_by_check(flat, seed, orbit, tmp_path):
    rng = np.random.default_rng(seed)
    sites = [
        Site(f"S{k}", float(np.arcsin(rng.uniform(-0.7, 0.7))), float(rng.uniform(-3, 3)))
        for k in range(3)
    ]
    asked = Requirement.of("sites", sites=sites, **WANTED[seed])
    found = compass.search(require=[asked], max_satellites=12, **orbit)
    assert found.holds, found.sentence
    following = [found.outcome.next_best] if found.outcome.next_best else []
    for one in (*found.outcome.met, *following):
        again = compass.check(
            replace(found.question.design(one.constellation), requirements=(asked,))
        )
        assert again.holds, again
        closed = "said to close after" in again.verdicts[0].scope
        assert closed == ("orbit" in orbit)
    # and what is written says the same
    path = tmp_path / "best.toml"
    found.write(path)
    again = compass.check(path)
    assert again.holds
    assert again.design.constellation.size == found.size

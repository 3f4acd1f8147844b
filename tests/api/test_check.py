"""Verdicts on requirements: against folds and shares found in other ways, and what is told."""

import json
from dataclasses import replace

import numpy as np
import pytest

import compass
from compass import Mask, Requirement, Site, walker_delta
from compass.coverage.promises import box_of
from compass.coverage.verdict import Verdict, both
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import positions_mcmf
from compass.orbits.motion import Motion
from compass.words import counted

POLE = Site("pole", np.pi / 2, 0.0)
EQUATOR = Site("equator", 0.0, 1.0)
DAY = 88642.66


def ring(*requirements, satellites=6, **options):
    """A ring over the equator and what is wanted of it."""
    orbit = {"radius_km": 20000} | options.pop("orbit", {})
    if "orbit" in orbit or "repeat" in orbit:
        del orbit["radius_km"]
    c = walker_delta(satellites, 1, 0, inclination_deg=0, **orbit)
    return Design(c, name="ring", requirements=requirements, **options)


def verdict(design, **options):
    (found,) = compass.check(design, **options).verdicts
    return found


def test_a_ring_is_seen_from_the_equator_and_not_from_the_pole():
    design = ring(
        Requirement("two", sites=(EQUATOR,), fold=2), Requirement("one", sites=(POLE,), fold=1)
    )
    found = compass.check(design)
    met, missed = found.verdicts
    assert (met.met, missed.met, found.holds) == (True, False, False)
    # 60 degrees apart: with one overhead the second stands 60 degrees away
    r, rho = design.figure.equatorial_radius, 2e7
    elevation = np.arctan2(np.cos(np.pi / 3) - r / rho, np.sin(np.pi / 3))
    assert 0.0 <= met.margin <= elevation
    assert missed.worst.value == 0
    assert missed.share == pytest.approx((0.0, 0.0), abs=1e-9)
    assert missed.margin == pytest.approx(np.arctan2(-r, rho), abs=1e-6)
    assert (met.worst.rank, met.worst.elevation) == (2, pytest.approx(elevation, abs=1e-3))
    said = " ".join(str(found).split())
    assert f"2nd satellite at {np.degrees(met.worst.elevation):.2f} deg; " in said
    assert missed.worst.elevation == pytest.approx(missed.margin, abs=1e-6)
    known = found.to_dict()["requirements"]
    assert [
        set(one) >= {"name", "met", "evidence", "share", "margin_deg", "worst"} for one in known
    ]
    assert (known[0]["met"], known[0]["evidence"], known[0]["share"]) == (True, "proven", [1, 1])
    json.dumps(found.to_dict(), allow_nan=False)
    assert str(found).startswith("ring: MISSED: 2 requirements: 1 met, 1 missed")


def test_without_requirements_the_coverage_of_the_file_is_asked():
    design = ring(fold=1, mask=Mask.constant(0.1))
    found = verdict(design)
    assert (found.requirement.name, found.met, found.requirement.where) == (
        "coverage",
        False,
        "all of Mars",
    )


@pytest.mark.slow
def test_the_higher_of_mask_and_horizon_counts():
    high = Mask((0.0, np.pi), (0.0, np.radians(85)))
    wall = Site("wall", 0.2, 0.0, mask=high)
    plain = Site("wall", 0.2, 0.0)
    asked = {"fold": 2, "mask": np.radians(2)}
    assert verdict(ring(Requirement("a", sites=(plain,), **asked))).met is True
    assert verdict(ring(Requirement("a", sites=(wall,), **asked))).met is False


def test_a_closed_track_counts_at_the_place_and_one_nearly_closed_on_the_circle():
    """Three relays that stand still see a place between two of them, or under one."""
    asked = Requirement("two", sites=(Site("between", 0.0, 0.0),), fold=2)
    closed = ring(asked, satellites=3, orbit={"orbit": "areosynchronous"})
    # at the epoch one stands over the prime meridian's node: turn it to 60 degrees
    angle = float(np.degrees(compass_angle(closed)))
    stand = {"orbit": "areosynchronous", "raan_deg": angle % 360 + 60}
    between = verdict(ring(asked, satellites=3, orbit=stand))
    assert (between.met, "close after 1 revolution" in between.scope) == (True, True)
    under = verdict(ring(asked, satellites=3, orbit=stand | {"raan_deg": angle % 360}))
    assert under.met is False
    radius = closed.constellation.semi_major_axis[0] / 1e3
    near = ring(asked, satellites=3, orbit={"radius_km": radius, "raan_deg": angle % 360 + 60})
    found = verdict(near)
    assert (found.met, "no ground track is said to close" in found.scope) == (False, True)
    # but for a day it stays where it is, and that is proven at the place
    assert verdict(near, days=1).met is True


def compass_angle(design):
    from compass.frames import prime_meridian_angle

    return prime_meridian_angle(design.constellation.epoch, 0.0)


@pytest.mark.slow
def test_shares_on_the_circle_against_samples():
    c = walker_delta(4, 2, 1, inclination_deg=60, radius_km=15000)
    site = Site("a", np.radians(40), 0.5)
    design = Design(
        c, name="four", requirements=(Requirement("r", sites=(site,), fold=2, share=0.5),)
    )
    found = verdict(design)
    # 61 incommensurate turns of the orbit: a fair sample of phases and longitudes
    times = np.random.default_rng(1).uniform(0, 600 * DAY, 4000)
    seen = site.sees(np.moveaxis(positions_mcmf(c, times), 1, 0)).sum(axis=-1)
    low, high = found.share
    assert low - 0.04 < (seen >= 2).mean() < high + 0.04  # 5 sigma
    assert found.met is (True if low >= 0.5 else False if high < 0.5 else None)
    assert found.evidence == "bracket"
    belt = Requirement("r", regions=("lat:-20:20",), fold=1, share=0.2)
    assert verdict(replace(design, requirements=(belt,))).met is True
    by_area = replace(belt, share_of="area-time", share=0.3)
    assert verdict(replace(design, requirements=(by_area,))).met is True


def test_any_loss_of_a_ring_is_alike_and_of_a_closed_one_is_not():
    asked = Requirement("one", sites=(EQUATOR,), fold=1, losses=1)
    lost = verdict(ring(asked, satellites=6))
    assert (lost.met, lost.alike, len(lost.lost)) == (True, 6, 1)
    closed = verdict(ring(asked, satellites=3, orbit={"orbit": "areosynchronous"}))
    assert (closed.met, closed.alike) == (False, 1)
    assert "loss of P1S1 or one of 6 sets alike" in str(compass.check(ring(asked)))


@pytest.mark.slow
def test_along_paths_it_is_said_whose_loss_hurts_most():
    """The one that stands best where the fold is missed, or where an antenna's beam is tightest."""
    asked = Requirement("one", sites=(EQUATOR,), fold=1, losses=1)
    missed = ring(asked, satellites=3)
    found = compass.check(missed, motion="j2", days=0.5)
    (one,) = found.verdicts
    assert (one.met, len(one.lost), one.worst.value, one.worst.rank) == (False, 1, 0, 1)
    assert one.worst.elevation < 0.0 and "which hurts most" in str(found)
    beamed = ring(replace(asked, beam=1.0), satellites=6)
    kept = verdict(beamed, motion="j2", days=0.5)
    assert (kept.met, len(kept.lost), kept.worst.value >= 1) == (True, 1, True)
    assert kept.worst.elevation == pytest.approx(kept.margin, abs=1e-3)


def test_the_site_that_is_tightest_is_named():
    far = Site.of("far", latitude_deg=20, longitude_deg=-170)
    asked = Requirement("two", sites=(EQUATOR, far), fold=1)
    own = compass.check(ring(asked, orbit={"orbit": "areosynchronous"}), days=1)
    assert "tightest at far, 20.0000° N, 170.0000° W" in str(own)
    assert own.to_dict()["requirements"][0]["worst"]["site"] == "far"
    circle = compass.check(ring(asked))
    assert "tightest at far's latitude, 20.0000° N, " in str(circle)
    belt = compass.check(ring(replace(asked, sites=(), regions=("lat:10:20",))))
    assert "tightest at 20.0000° N, " in str(belt)
    assert belt.to_dict()["requirements"][0]["worst"]["site"] is None


def two_periods(wanted, first=4, second=4):
    both_radii = walker_delta(first, 1, 0, inclination_deg=0, radius_km=15000) + replace(
        walker_delta(second, 1, 0, inclination_deg=0, radius_km=16000),
        satellite_names=tuple("abcdefgh"[:second]),
    )
    return Design(both_radii, name="two", requirements=(wanted,))


def test_what_satellites_of_one_period_keep_holds_for_ever_whatever_others_do():
    """Four of a ring keep one in view of the equator always, and six keep two."""
    one = Requirement("one", sites=(EQUATOR,), fold=1)
    found = verdict(two_periods(one))
    assert (found.met, found.evidence, found.share, found.worst) == (True, "proven", (1, 1), None)
    assert found.scope.startswith("by 4 satellites at 15000 km alone; for ever")
    assert found.margin == verdict(ring(one, satellites=4, orbit={"radius_km": 15000})).margin
    # what they keep each for itself adds up: one and two
    both = verdict(two_periods(replace(one, fold=3), 4, 6))
    assert (both.met, both.evidence, both.margin) == (True, "proven", None)
    assert "2 of 6 satellites at 16000 km and 1 of 4 satellites at 15000 km" in both.scope
    for asked in (replace(one, fold=4), replace(one, fold=3, losses=1)):
        assert verdict(two_periods(asked, 4, 6)).met is not True
    assert verdict(two_periods(replace(one, fold=2, losses=1), 4, 6)).met is True
    often = verdict(two_periods(replace(one, fold=2, share=0.5), 2, 6))
    assert (often.met, often.evidence, often.share[1]) == (True, "bracket", 1.0)


def test_orbits_of_two_periods_need_days():
    asked = Requirement("one", sites=(EQUATOR,), fold=3, share=0.9)
    design = two_periods(asked)
    found = verdict(design)
    assert (found.met, found.evidence) == (None, "none")
    assert "every combination of their phases; give days" in found.reason
    assert verdict(design, days=0.2).met is not None
    # what is missed once is not always so, whatever the phases
    missed = verdict(two_periods(replace(asked, fold=8, share=1.0)))
    assert (missed.met, missed.evidence) == (False, "proven") and "over 2 days" in missed.scope


def test_geometry_of_a_ring_is_useless_on_the_equator():
    asked = Requirement("pdop", sites=(EQUATOR,), limits=(("pdop", 10.0),), share=0.5)
    found = verdict(ring(asked, satellites=3))
    assert (found.met, found.share) == (False, (0.0, 0.0))
    again = verdict(ring(replace(asked, fold=1), satellites=3))
    assert again.met is False
    # off the resonance always in a polygon is always on its latitudes
    part = replace(asked, sites=(), regions=("polygon:0,0;0,40;10,10;40,0",), share=1.0)
    found = verdict(ring(part))
    assert (found.met, found.evidence) == (False, "proven")
    assert 0 <= found.worst.latitude <= np.radians(40)


@pytest.mark.slow
def test_geometry_is_certified_and_losses_too():
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    asked = Requirement("g", regions=("globe",), limits=(("pdop", 6.0),), share=0.97,
                        share_of="area-time")  # fmt: skip
    design = Design(c, name="COMPASS", figure="kelly2018-sphere", requirements=(asked,))
    found = verdict(design)
    # a prototype of its own: the share lies in [0.9736164, 0.9736178]
    assert found.share[0] <= 0.9736178
    assert found.share[1] >= 0.9736164
    assert found.met is True
    lost = verdict(replace(design, requirements=(replace(asked, losses=1),)))
    assert (lost.met, lost.alike) == (False, 15)


def test_along_real_paths_over_days():
    asked = Requirement("two", sites=(EQUATOR,), fold=2)
    design = replace(ring(asked), motion=Motion("j2"))
    assert verdict(design).met is True  # for ever: all drift alike
    found = verdict(design, days=0.5)
    assert (found.met, "over 0.5 days" in found.scope) == (True, True)
    belt = Requirement("three", regions=("lat:60:80",), fold=3)
    missed = verdict(replace(design, requirements=(belt,)), days=0.5)
    assert (missed.met, missed.evidence) == (False, "proven")
    assert missed.margin < 0
    seen = positions_mcmf(design.constellation, [missed.worst.time])[:, 0]
    there = Site("w", missed.worst.latitude, missed.worst.longitude)
    assert there.sees(seen).sum() == missed.worst.value < 3
    flat = replace(design, figure=FIGURES["iau-ellipsoid"], requirements=(belt,))
    missed = verdict(flat, days=0.5)
    seen = positions_mcmf(design.constellation, [missed.worst.time])[:, 0]
    there = Site("w", missed.worst.latitude, missed.worst.longitude, figure=flat.figure)
    assert there.sees(seen).sum() == missed.worst.value < 3


@pytest.mark.slow
@pytest.mark.parametrize(
    "asked",
    [
        {"beam": 0.21},
        {"beam": 0.1},
        {"altitude": 4e7, "mask": np.radians(-85)},
        {"altitude": 4e7, "mask": np.radians(-85), "beam": 0.2},
        {"share": 0.5},
        {"share": 0.9, "share_of": "area-time", "altitude": 1e5},
        {"share": 0.9, "losses": 1, "beam": 0.3},
        {"altitude": 1e5, "figure": "iau-ellipsoid"},
    ],
    ids=str,
)
def test_along_paths_as_on_the_ellipses_they_follow(asked):
    """Beams, users above, shares, ellipsoids: two-body paths as series, and in closed form."""
    asked = dict(asked)
    figure = FIGURES[asked.pop("figure", "iau-sphere")]
    belt = Requirement("b", regions=("lat:-20:10",), fold=2, **asked)
    exact = replace(ring(belt, satellites=5), figure=figure)
    days = 0.1 if belt.losses else 0.5  # each loss is a question of its own
    path = Motion("two-body").trajectory(exact.constellation, 0.0, days * 86400)
    along = replace(exact, motion=Motion("ephemeris", table=path))
    one, other = (verdict(design, days=days) for design in (exact, along))
    assert one.met is not None
    assert other.met == one.met
    if one.margin is not None and one.met:  # bounds from below
        assert 0 <= other.margin < one.margin + 1e-4
    elif one.margin is not None:
        assert other.margin == pytest.approx(one.margin, abs=3e-4)
    elif one.share is not None:
        assert other.share[0] <= one.share[1] + 1e-9
        assert one.share[0] <= other.share[1] + 1e-9


def test_a_horizon_by_azimuth_refutes_with_its_lowest_along_paths():
    """What is missed over the highest part of a horizon may stand over another part."""
    belt = Requirement("one", regions=("lat:-5:5",), fold=1)
    wall = Mask((0.0, np.pi), (0.0, np.radians(89)))
    steep = Mask((0.0, np.pi), (np.radians(80), np.radians(89)))

    def under(mask):
        return verdict(replace(ring(belt, mask=mask), motion=Motion("j2")), days=0.1)

    assert under(Mask.constant(0.0)).met is True
    assert under(Mask.constant(np.radians(80))).met is False
    assert under(wall).met is None
    missed = under(steep)
    assert (missed.met, missed.evidence) == (False, "proven")
    # the place and moment are a miss over the lowest of the horizon, so over all of it
    design = ring(belt)
    seen = positions_mcmf(design.constellation, [missed.worst.time])[:, 0]
    there = Site("w", missed.worst.latitude, missed.worst.longitude, mask=steep)
    assert there.sees(seen).sum() == missed.worst.value == 0
    low = replace(there, mask=Mask.constant(steep.lowest))
    assert low.sees(seen).sum() == 0


def test_the_worst_over_days_lies_in_them_and_among_the_users():
    c = walker_delta(12, 3, 1, inclination_deg=50, radius_km=20000)
    belt = Requirement("a", regions=("lat:-60:60",), fold=8)
    missed = verdict(Design(c, requirements=(belt,)), days=2, start_day=3)
    assert missed.met is False
    assert 3 * 86400 <= missed.worst.time <= 5 * 86400
    seen = positions_mcmf(c, [missed.worst.time])[:, 0]
    there = Site("w", missed.worst.latitude, missed.worst.longitude)
    assert there.sees(seen).sum() == missed.worst.value < 8
    elevation, _ = there.elevation_azimuth(seen)
    assert np.sort(elevation)[-8] == pytest.approx(missed.margin, abs=1e-6)
    # all around its latitudes one is in view: the polygon's own users have more
    part = Requirement("p", regions=("polygon:0,0;0,10;10,10;10,0",), fold=1)
    met = verdict(Design(c, requirements=(part,)), days=2, start_day=3)
    w = met.worst
    assert met.met is True and 3 * 86400 <= w.time <= 5 * 86400
    assert -1e-9 <= min(w.latitude, w.longitude) <= max(w.latitude, w.longitude) < np.radians(10.01)
    elevation, _ = Site("w", w.latitude, w.longitude).elevation_azimuth(
        positions_mcmf(c, [w.time])[:, 0]
    )
    assert 0 < met.margin <= elevation.max() == pytest.approx(w.elevation, abs=1e-9)


@pytest.mark.slow
def test_margins_come_near_for_bands_and_polygons_and_are_alike_for_losses_that_are():
    """A band whose first look shows 18 degrees where 16.2 are, a part of it, and any loss."""
    c = walker_delta(18, 6, 2, inclination_deg=50, orbit="areosynchronous")
    band = Requirement("band", regions=("lat:-30:30",), fold=4)
    part = Requirement("part", regions=("polygon:10,60;10,100;25,100;25,60",), fold=4)
    lost = replace(band, name="lost", losses=1)
    asked = [band, part, lost, replace(lost, name="again", regions=("lat:-30:30", "lat:-30:30"))]
    found = compass.check(Design(c, requirements=tuple(asked))).verdicts
    for one in found:
        assert 0.0 <= one.worst.elevation - one.margin < 1.1e-4
    assert found[0].margin <= found[1].margin + 1.1e-4
    assert (found[2].alike, found[2].margin) == (18, found[3].margin)
    # all moments and places of the band, from the whole of a sol
    times = np.random.default_rng(3).uniform(0, DAY, 300)
    for latitude in np.radians([-30, -12.4, 0, 12.4, 30]):
        seen = np.moveaxis(positions_mcmf(c, times), 1, 0)
        elevation, _ = Site("x", latitude, 0.3).elevation_azimuth(seen)
        assert np.sort(elevation, axis=-1)[..., -4].min() >= found[0].margin


@pytest.mark.slow
def test_geometry_along_integrated_paths_is_settled_over_days():
    asked = Requirement("g", limits=(("pdop", 6.0),))
    found = verdict(ring(asked, motion=Motion("numerical")), days=0.1)
    assert (found.met, found.evidence) == (False, "proven")
    assert "over 0.1 days" in found.scope


def test_what_cannot_be_asked_is_told():
    design = ring(Requirement("a", fold=1), motion=Motion("numerical"))
    with pytest.raises(ArgumentError, match="days: missing; under numerical motion"):
        compass.check(design)
    with pytest.raises(ArgumentError, match="days = -1: allowed above 0"):
        compass.check(design, days=-1)
    with pytest.raises(ArgumentError, match="start_day = -1: allowed 0 to 36525 days"):
        compass.check(design, days=1, start_day=-1)
    with pytest.raises(ArgumentError, match="start_day = 3: counts with days only"):
        compass.check(ring(), start_day=3)
    with pytest.raises(ArgumentError, match="budget_s = 0: allowed above 0"):
        compass.check(ring(), budget_s=0)
    with pytest.raises(ArgumentError, match="a: asks for nothing; add a fold or a limit"):
        compass.check(ring(Requirement("a")))


def test_users_in_orbit_and_in_beams():
    """A ring around the equator as seen from over it, past Mars, and by those in its beams."""
    over = {"altitude": 4e7, "mask": np.radians(-85), "regions": ("lat:-1:1",)}
    seen = Requirement("past Mars", fold=3, **over)
    narrow = replace(seen, name="narrow", beam=np.radians(10))
    many = replace(seen, name="many", fold=13)
    found = compass.check(ring(seen, narrow, many, satellites=12))
    assert [verdict.met for verdict in found.verdicts] == [True, False, False]
    assert "many: 12 satellites in all, 13 wanted" in str(found)
    assert "40000 km above the ground, in beams of 10 deg" in str(found)
    deep = replace(seen, altitude=4e5, fold=None, limits=(("pdop", 6.0),))
    with pytest.raises(
        ArgumentError,
        match=r"past Mars: mask_deg = -85: below the limb of Mars as seen from 400 km; allowed from -26.5389",
    ):
        compass.check(ring(deep))
    below = Requirement("g", regions=("lat:-1:1",), limits=(("pdop", 6.0),), beam=0.1)
    missed = compass.check(ring(below))
    worst = missed.verdicts[0].worst
    assert missed.verdicts[0].met is False and np.isinf(worst.value)
    assert worst.seen < 4 and worst.seen < worst.around
    more = worst.around - worst.seen
    assert (
        f"PDOP infinite: {counted(worst.seen, 'satellite')} in view, and {more} more outside of "
        "whose beams the place is" in " ".join(str(missed).split())
    )
    alone = compass.check(ring(replace(below, beam=None)))
    assert alone.verdicts[0].worst.seen == alone.verdicts[0].worst.around
    flat = verdict(replace(ring(below), figure="iau-ellipsoid"))
    assert (flat.met, flat.evidence, flat.worst.value) == (False, "proven", np.inf)
    assert flat.worst.seen < 4 and flat.worst.seen < flat.worst.around
    assert box_of(ring(replace(below, limits=(), fold=1))) is None


@pytest.mark.slow
def test_a_beam_that_reaches_the_limb_takes_nothing_from_a_margin():
    """From 20000 km Mars and users up to 400 km over it fill less than 11 degrees."""
    c = walker_delta(16, 8, 3, inclination_deg=50, radius_km=20000)
    wanted = Requirement("up", regions=("lat:-60:60",), fold=4, mask=np.radians(-15), altitude=4e5)
    wide, bare = (
        verdict(Design(c, requirements=(replace(wanted, beam=beam),))).margin
        for beam in (np.radians(12), None)
    )
    assert wide == bare > 0.1


def test_four_in_view_are_implied_by_a_dilution_at_the_same_moments():
    """Not asked for again: their share and that of the dilution need not add their misses."""
    wanted = {"regions": "lat:-20:20", "mask_deg": 20, "share": 0.5, "pdop_at_most": 6}
    alone, four, five = (Requirement.of("a", fold=k, **wanted) for k in (None, 4, 5))
    assert [one.counts for one in (alone, four, five)] == [None, None, 5]
    assert Requirement.of("a", fold=4, **wanted | {"share": 1}).counts == 4
    c = walker_delta(12, 3, 1, inclination_deg=30, radius_km=20000)
    found = compass.check(Design(c, requirements=(alone, replace(four, name="b"))), width=0.3)
    assert found.verdicts[0].share == found.verdicts[1].share


def made(met, share=None, evidence="bracket"):
    asked = Requirement("a", fold=5, limits=(("pdop", 6.0),), share=0.9)
    return Verdict(asked, met, evidence, "for ever", share)


def test_two_halves_hold_together_as_far_as_shares_allow():
    assert both(made(True, (0.99, 1.0)), made(True, (0.95, 0.96))).met is True
    half = both(made(True, (0.94, 0.95)), made(True, (0.94, 0.95)))
    assert (half.met, half.share) == (None, pytest.approx((0.88, 0.95)))
    assert half.reason
    assert both(made(True, (0.95, 0.95)), made(False, (0.1, 0.2))).met is False
    assert both(made(None), made(True)).met is None


def test_the_command_ends_with_the_verdict(run, tmp_path):
    path = tmp_path / "ring.toml"
    text = """
name = "ring"
[constellation]
pattern = "walker-delta"
satellites = 4
planes = 1
phasing = 0
inclination_deg = 0
radius_km = 20000
[[station]]
name = "E"
latitude_deg = 0
longitude_deg = 0
[[requirement]]
sites = ["E"]
fold = {fold}
"""
    for fold, status in ((1, 0), (2, 1)):
        path.write_text(text.format(fold=fold))
        code, out, _ = run("check", path, "--json")
        assert (code, json.loads(out)["holds"]) == (status, status == 0)
    code, out, _ = run("check", path)
    assert (code, out) == (1, str(compass.check(path)) + "\n")
    path.write_text(text.replace('sites = ["E"]', 'sites = ["F"]').format(fold=1))
    code, out, err = run("check", path)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "no such [[station]]; there are E" in err


def test_of_all_satellites_lost_no_geometry_is_left():
    lost = Requirement("none left", sites=(EQUATOR,), limits=(("pdop", 6.0),), losses=6)
    found = verdict(ring(lost, satellites=6))
    assert (found.met, found.evidence, found.share) == (False, "proven", (0.0, 0.0))
    assert found.reason == "no satellite is left of 6"

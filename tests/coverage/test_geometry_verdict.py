"""Claims that a dilution of precision is always small enough: proven, refuted, or left open."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from compass.coverage import geometry_verdict as module
from compass.coverage import value_limit
from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.geometry_verdict import geometry_verdict
from compass.coverage.requirement_verdict import verdict_of
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import positions_mcmf, walker_delta
from compass.orbits.motion import Motion
from compass.requirement import Requirement
from compass.sites import Site


def asked(pattern, mask, share=1.0, **options):
    wanted = Requirement(name="band", regions=("lat:-30:30",), mask=mask, share=share)
    return geometry_verdict(Design(pattern), wanted, "pdop", 6.0, **options)


@pytest.mark.slow
def test_always_is_proven_or_refuted_with_place_and_moment():
    good = walker_delta(24, 6, 1, inclination_deg=55, radius_km=20427)
    met = asked(good, math.radians(5))
    assert (met.met, met.evidence, met.share) == (True, "proven", (1.0, 1.0))
    # on a grid of 4 degrees this one passes
    bad = walker_delta(14, 14, 8, inclination_deg=18.4, orbit="areosynchronous")
    missed = asked(bad, math.radians(10))
    assert (missed.met, missed.evidence) == (False, "proven")
    assert missed.worst.value > 6.0
    assert abs(missed.worst.latitude) <= math.radians(30) + 1e-9


@pytest.mark.slow
def test_the_largest_value_is_bracketed_where_it_is_asked_for():
    """No sample is above, and the place and moment show the lower end, by matrices."""
    c = walker_delta(12, 4, 0, inclination_deg=12, radius_km=20427.7)
    met, plain = (asked(c, 0.0, thorough=thorough) for thorough in (True, False))
    w = met.worst
    assert met.met is plain.met is True and plain.worst is None
    assert w.value < w.most < 1.02 * w.value
    at = dops(c, np.array([w.time]), w.latitude, w.longitude)[0]
    assert at == pytest.approx(w.value, rel=1e-9)
    times = np.random.default_rng(5).uniform(0, 1e7, 3000)
    for latitude in np.radians([-30, -10, 5, 29]):
        assert dops(c, times, latitude, 0.4).max() <= w.most
    bad = walker_delta(14, 14, 8, inclination_deg=18.4, radius_km=20427.7)
    missed = asked(bad, math.radians(10), thorough=True)
    assert missed.met is False and missed.worst.value > 100.0 and missed.worst.most == math.inf


@pytest.mark.slow
@pytest.mark.parametrize("motion", ["two-body", "j2"])
def test_shares_of_satellites_in_view_come_near_at_places_and_in_regions(motion):
    """Along paths too, where boxes of clearance left 0.36 to 0.83 open; against random moments."""
    c = walker_delta(15, 5, 1, inclination_deg=55, radius_km=20427)
    design = Design(c, motion=Motion(motion))
    site = Site("a", math.radians(18), math.radians(77))
    place = Requirement("place", sites=(site,), fold=6, share=0.9)
    band = Requirement("band", regions=("lat:-30:30",), fold=6, share=0.9, share_of="area-time")
    generator = np.random.default_rng(7)
    times = generator.uniform(0, 86400, 4000)
    seen = np.moveaxis(positions_mcmf(c, times), 1, 0)
    for wanted, width in ((place, 1e-3), (band, 0.05)):
        found = verdict_of(design, wanted, days=1)
        low, high = found.share
        assert (found.met, found.evidence) == (False, "bracket") and high - low < width
        latitude = np.full(4000, site.latitude)
        longitude = np.full(4000, site.longitude)
        if wanted is band:
            latitude = np.arcsin(generator.uniform(-0.5, 0.5, 4000))
            longitude = generator.uniform(-math.pi, math.pi, 4000)
        up = np.stack([
            np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ], axis=-1)  # fmt: skip
        line = seen - FIGURES["iau-sphere"].equatorial_radius * up[:, np.newaxis]
        share = ((np.einsum("tni,ti->tn", line, up) >= 0.0).sum(axis=1) >= 6).mean()
        # four sigmas of so many moments; what J2 moves in a day is less than a place is wide
        assert low - 0.03 <= share <= high + 0.03


def dops(c, times, latitude, longitude):
    """PDOP at a place, by inverting the normal matrix at each time."""
    r = np.moveaxis(positions_mcmf(c, times), 1, 0)
    up = np.array([
        math.cos(latitude) * math.cos(longitude), math.cos(latitude) * math.sin(longitude),
        math.sin(latitude),
    ])  # fmt: skip
    line = r - FIGURES["iau-sphere"].equatorial_radius * up
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    rows = np.concatenate([line, np.ones((*line.shape[:-1], 1))], axis=-1)
    rows *= (line @ up >= 0.0)[..., np.newaxis]
    found = np.linalg.inv(np.einsum("tni,tnj->tij", rows, rows))
    return np.sqrt(np.trace(found[:, :3, :3], axis1=1, axis2=2))


def test_what_claims_leave_open_is_asked_of_the_share(monkeypatch):
    pattern = walker_delta(12, 3, 1, inclination_deg=55, radius_km=20427)
    witness = SimpleNamespace(time=1.0, latitude=0.1, longitude=0.2, value=9.0, satellites=())
    share = SimpleNamespace(low=0.9, high=1.0, value=0.95, stopped="boxes")
    monkeypatch.setattr(Effort, "share", lambda *_, **__: share)
    found = {}
    for outcome in Outcome:
        claim = SimpleNamespace(outcome=outcome, witness=witness)
        monkeypatch.setattr(Effort, "always", lambda *_, claim=claim, **__: claim)
        found[outcome] = asked(pattern, 0.1)
    assert found[Outcome.PROVEN].met is True
    assert found[Outcome.REFUTED].met is False
    assert found[Outcome.REFUTED].worst.value == 9.0
    assert found[Outcome.UNDECIDED].met is None
    assert np.isclose(found[Outcome.UNDECIDED].share, (0.9, 1.0)).all()


def test_a_share_of_area_and_time_lies_between_those_of_its_parts(monkeypatch):
    """One part of two that surely falls short does not refute the mean, both do."""
    pattern = walker_delta(12, 3, 1, inclination_deg=55, radius_km=20427)
    wanted = Requirement(name="two", regions=("lat:-30:0", "lat:0:30"), share=0.8)

    def settled(highs, share_of):
        found = iter([SimpleNamespace(low=0.1, high=h, value=h, stopped="") for h in highs])
        monkeypatch.setattr(Effort, "share", lambda *_, **__: next(found))
        monkeypatch.setattr(module, "asked_place", lambda *_: {})
        monkeypatch.setattr(
            value_limit, "certified_worst_place", lambda *_, **__: (next(found), 0.1)
        )
        asked = replace(wanted, share_of=share_of)
        return geometry_verdict(Design(pattern), asked, "pdop", 6.0)

    mean = settled((0.5, 0.9), "area-time")
    assert (mean.met, mean.share) == (None, (0.1, 0.9))
    assert settled((0.5, 0.7), "area-time").met is False
    assert settled((0.5, 0.9), "time").met is False


def test_what_cannot_be_asked_is_refused_by_the_requirement_s_name():
    pattern = walker_delta(6, 3, 1, inclination_deg=50, radius_km=20427)
    limits = (("pdop", 6.0),)
    wanted = Requirement(
        name="orbiters", regions=("globe",), limits=limits, share=0.5, altitude=17030.81e3
    )
    with pytest.raises(ArgumentError, match=r"^orbiters: altitude_km = 17030.8: among the sat"):
        geometry_verdict(Design(pattern), wanted, "pdop", 6.0)


@pytest.mark.slow
def test_in_beams_samples_tell_what_bounds_leave_open(monkeypatch):
    """Where no horizon stands for a beam, as over an ellipsoid; how wide its bounds are is told."""
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    design = Design(c, figure="iau-ellipsoid")
    wanted = Requirement(
        "w", regions=("lat:-20:20",), beam=math.radians(9.2), share=0.6, share_of="area-time"
    )

    def settled(requirement, **options):
        return geometry_verdict(design, requirement, "pdop", 8.0, **options)

    proven = settled(wanted, effort=Effort(width=5e-3))
    assert proven.evidence == "bracket" and proven.share[1] - proven.share[0] <= 5e-3
    monkeypatch.setattr(module, "SHARE_BOXES", 200)
    monkeypatch.setattr(module, "WORST_BOXES", 200)
    left = settled(wanted)
    assert (left.met, left.evidence, left.stopped) == (None, "bracket", "boxes")
    for told in (settled(wanted, by_samples=True), settled(wanted, thorough=True)):
        assert (told.met, told.evidence) == (proven.met, "sampled")
        assert told.share[0] < proven.share[1] and proven.share[0] < told.share[1]
        between = f"between {left.share[0]:.6g} and {left.share[1]:.6g}"
        assert f"no proof: the share surely lies {between}; ended early" in told.scope
    # of the worst place of a region samples tell less than bounds
    place = replace(wanted, share_of="time", share=0.8)
    assert settled(place, by_samples=True) == settled(place)

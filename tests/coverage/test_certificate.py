"""Proof over time: published and computed cases, samples, symmetry, bad input."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.certificate import caps_at
from compass.coverage import witness
from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.fold import caps_of, clearances
from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, read_region
from compass.coverage.symmetry import Span, shortest_span
from compass.coverage.witness import find_witness
from compass.errors import ArgumentError
from compass.frames import direction, mcmf_from_mci, prime_meridian_angle
from compass.orbits import (
    keplerian,
    orbital_period,
    positions_mci,
    positions_mcmf,
    rosette,
    walker_delta,
)

R = 3396.2e3
DEGREE = np.radians(1.0)


def seed_design():
    return walker_delta(15, 5, 1, inclination_deg=45, radius_km=20428)


def ellipses(n=5, e=0.3, a=14000e3):
    k = np.arange(n)
    return keplerian(a, e, 50 * DEGREE, k * 2 * np.pi / n, 1.0, -k * 4 * np.pi / n, name="ellipses")


def random_view(constellation, mask, span, count=4000, seed=0):
    """Fold and clearance at random times and places, by elevation."""
    rng = np.random.default_rng(seed)
    times = rng.uniform(span.start, span.stop, 40)
    p = rng.normal(size=(count // 40, 3))
    p /= np.linalg.norm(p, axis=1, keepdims=True)
    return np.concatenate(
        [clearances(positions_mci(constellation, [t])[:, 0], R, mask, p) for t in times]
    )


def test_the_seed_design_is_proven_at_mask_0():
    found = prove_fold(seed_design(), 4, sphere_radius=R)
    assert found.outcome == "proven"
    assert found.span.for_all_time
    assert (random_view(seed_design(), 0.0, found.span) >= 0).sum(axis=1).min() >= 4


def test_the_seed_design_is_refuted_at_mask_10():
    c = seed_design()
    found = prove_fold(c, 4, sphere_radius=R, mask=10 * DEGREE)
    assert found.outcome == "refuted"
    w = found.witness
    assert w.fold == len(w.satellites) == 3
    # the witness again, from Mars-fixed positions and nothing of the proof
    r = positions_mcmf(c, [w.time])[:, 0]
    up = direction(w.latitude, w.longitude)
    sight = r - R * up
    elevation = np.arcsin(sight @ up / np.linalg.norm(sight, axis=1))
    seen = [name for name, e in zip(c.satellite_names, elevation, strict=True) if e >= 10 * DEGREE]
    assert tuple(seen) == w.satellites
    assert np.sort(elevation)[-4] == pytest.approx(10 * DEGREE - w.shortfall, abs=1e-9)


def test_fold_of_the_seed_design_is_4_to_9():
    # the range that a grid finds (specification, section 1), here settled
    assert fold_range(seed_design(), sphere_radius=R) == ((4, 4), (9, 9))


@pytest.mark.slow
@pytest.mark.parametrize("mask_deg", [6.2, 6.3])
def test_the_reduced_span_decides_as_the_whole_period_does(mask_deg):
    c = seed_design()
    period = float(orbital_period(20428e3))
    whole = Span(0.0, period, True, "no symmetry")
    short = prove_fold(c, 4, sphere_radius=R, mask=mask_deg * DEGREE)
    full = prove_fold(c, 4, sphere_radius=R, mask=mask_deg * DEGREE, span=whole)
    assert short.outcome == full.outcome
    assert short.span.stop < period / 50


@settings(deadline=None, max_examples=8)
@given(
    t=st.sampled_from([(5, 5, 1), (6, 3, 1), (6, 2, 0)]),
    inclination=st.floats(20, 90),
    mask=st.floats(0, 25),
    seed=st.integers(0, 1000),
)
def test_no_random_sample_contradicts_a_proof(t, inclination, mask, seed):
    c = walker_delta(*t, inclination_deg=inclination, radius_km=20428)
    least, greatest = fold_range(c, sphere_radius=R, mask=mask * DEGREE, max_intervals=300)
    period = Span(0.0, float(orbital_period(20428e3)), True, "")
    fold = (random_view(c, mask * DEGREE, period, 400, seed) >= 0).sum(axis=1)
    assert least[0] <= fold.min()
    assert greatest[1] >= fold.max()
    assert least[0] <= least[1]
    assert greatest[0] <= greatest[1]


def test_ellipses_are_proven_over_their_period_and_samples_agree():
    c = ellipses(9, 0.1, 25000e3)
    least, greatest = fold_range(c, sphere_radius=R, max_intervals=2000)
    span = shortest_span(c)
    assert span.for_all_time
    assert least[0] >= 1
    fold = (random_view(c, 0.0, span) >= 0).sum(axis=1)
    assert least[0] <= fold.min()
    assert greatest[1] >= fold.max()
    assert prove_fold(c, least[0], sphere_radius=R).outcome == "proven"
    assert prove_fold(c, least[1] + 1, sphere_radius=R).outcome == "refuted"


@settings(deadline=None, max_examples=15)
@given(e=st.floats(0, 0.6), half=st.floats(1.0, 3000.0), part=st.floats(-1, 1), t=st.floats(0, 1e5))
def test_no_cap_strays_beyond_its_bound(e, half, part, t):
    c = ellipses(4, e)
    orbits, frame = motion_of(c, Span(0.0, 1.0, False, ""))
    assert np.isnan(frame.angle)
    _, before, stray = caps_at(orbits, frame, R, 0.1, t, half)
    _, after, _ = caps_at(orbits, frame, R, 0.1, t + part * half, 0.0)
    # directions in the frame that turns with the spin, by Rodrigues' formula
    axis = frame.spin / np.linalg.norm(frame.spin)
    turn = -np.linalg.norm(frame.spin) * part * half
    start, end = positions_mci(c, [t, t + part * half]).transpose(1, 0, 2)
    end = (
        np.cos(turn) * end
        + np.sin(turn) * np.cross(axis, end)
        + (1 - np.cos(turn)) * np.outer(end @ axis, axis)
    )
    moved = np.arctan2(np.linalg.norm(np.cross(start, end), axis=1), (start * end).sum(axis=1))
    assert np.all(moved + np.abs(after - before) <= stray + 1e-9)


def test_a_polygon_turns_with_mars():
    c = ellipses()
    region = read_region("polygon:0,0;0,60;50,30")
    span = Span(0.0, 20000.0, False, "")
    u, _, _ = caps_at(*motion_of(c, span, region), R, 0.0, 1e4, 0.0)
    r = positions_mcmf(c, [1e4])[:, 0]
    assert u == pytest.approx(r / np.linalg.norm(r, axis=1, keepdims=True), abs=1e-11)
    least, _ = fold_range(c, sphere_radius=R, region=region, span=span, max_intervals=2000)
    refuted = prove_fold(c, least[1] + 1, sphere_radius=R, region=region, span=span)
    assert refuted.outcome == "refuted"
    w = refuted.witness
    assert region.contains(direction(w.latitude, w.longitude))
    rng = np.random.default_rng(1)
    for t in rng.uniform(0, 20000.0, 30):
        p = rng.normal(size=(200, 3))
        p /= np.linalg.norm(p, axis=1, keepdims=True)
        fixed = mcmf_from_mci(p, prime_meridian_angle(c.epoch, t))
        fold = (
            clearances(positions_mci(c, [t])[:, 0], R, 0.0, p[region.contains(fixed)]) >= 0
        ).sum(axis=1)
        assert fold.size == 0 or fold.min() >= least[0]


def test_a_band_has_more_in_view_than_the_globe():
    c = seed_design()
    mask = 9 * DEGREE
    band = read_region("lat:-25:25")
    assert prove_fold(c, 4, sphere_radius=R, mask=mask).outcome == "refuted"
    assert prove_fold(c, 4, sphere_radius=R, mask=mask, region=band).outcome == "proven"


def test_a_claim_on_the_edge_is_undecided_not_wrong():
    # five satellites whose caps just close at the worst moment: no proof, no counter-example
    c = walker_delta(5, 5, 1, inclination_deg=43.66, radius_km=20428)
    worst = shortest_span(c).stop
    u, _ = caps_of(c, R, 0.0, worst)
    # the exact covering radius of that moment from its critical triangle
    best = 0.0
    for i in range(5):
        for j in range(i):
            for k in range(j):
                n = np.cross(u[j] - u[i], u[k] - u[i])
                n /= np.linalg.norm(n)
                for p in (n, -n):
                    if (u @ p > u[i] @ p + 1e-12).sum() == 0:
                        best = max(best, np.arccos(u[i] @ p))
    rim = np.arctan2(np.cos(best) - R / 20428e3, np.sin(best))
    claim = {"sphere_radius": R, "mask": float(rim), "span": Span(worst, worst, False, "")}
    assert prove_fold(c, 1, **claim).outcome == "undecided"
    assert prove_fold(c, 1, **claim).unsettled == ((worst, worst),)
    claim["mask"] = float(rim) - 1e-10
    assert prove_fold(c, 1, **claim).outcome == "proven"
    claim["mask"] = float(rim) + 1e-10
    assert prove_fold(c, 1, **claim).outcome == "refuted"


def test_giving_up_says_what_is_left():
    c = seed_design()
    found = prove_fold(c, 4, sphere_radius=R, mask=6.2 * DEGREE, max_intervals=3)
    assert found.outcome == "undecided"
    assert found.intervals == 3
    assert found.unsettled[0][0] < found.unsettled[0][1]
    least, _ = fold_range(c, sphere_radius=R, mask=6.2 * DEGREE, max_intervals=1)
    assert least[0] < least[1] == 4


def test_too_few_satellites_are_refuted_at_once():
    c = walker_delta(3, 3, 1, inclination_deg=57.3, radius_km=20428)
    found = prove_fold(c, 4, sphere_radius=R)
    assert found.outcome == "refuted"
    assert found.witness.fold < 4


def test_an_empty_constellation():
    c = walker_delta(2, 1, 0, inclination_deg=57.3, radius_km=20428).without([0, 1])
    assert fold_range(c, sphere_radius=R) == ((0, 0), (0, 0))
    found = prove_fold(c, 1, sphere_radius=R)
    assert (found.outcome, found.witness.satellites) == ("refuted", ())


def test_a_witness_in_a_narrow_valley_is_found_soon(monkeypatch):
    """Moves that gain ever less went on for millions of steps."""
    calls = 0

    def counted(*arguments):
        nonlocal calls
        calls += 1
        return clearances(*arguments)

    monkeypatch.setattr(witness, "clearances", counted)
    sixth = np.radians(30.0) * np.arange(6)
    c = keplerian(2e7, 0.8, np.radians(100.0), sixth, -np.pi / 2, 2 * sixth)
    assert prove_fold(c, 1, sphere_radius=R).outcome == "refuted"
    halvings = np.ceil(np.log2(0.05 / 1e-7))
    assert calls <= 2 + halvings * (1 + witness.MOVES)


def test_no_witness_where_the_claim_holds():
    c = seed_design()
    assert find_witness(c, R, 0.0, 4, 0.0, np.array([0.0, 0.0, 1.0]), GLOBE) is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fold": 0}, "fold = 0"),
        ({"mask": 2.0}, "mask_deg = 114"),
        ({"sphere_radius": 3e7}, "must be above the surface"),
    ],
)
def test_bad_arguments(change, message):
    arguments = {"fold": 4, "mask": 0.0, "sphere_radius": R} | change
    with pytest.raises(ArgumentError, match=message):
        prove_fold(seed_design(), **arguments)


def test_rosettes_are_proven_like_the_deltas_they_are():
    c = rosette(8, 8, 6, inclination_deg=61.86, radius_km=20428)
    d = walker_delta(8, 8, 6, inclination_deg=61.86, radius_km=20428)
    masks = (20 * DEGREE, 30 * DEGREE)
    outcomes = [[prove_fold(x, 1, sphere_radius=R, mask=m).outcome for m in masks] for x in (c, d)]
    assert outcomes == [["proven", "refuted"]] * 2


@pytest.mark.slow
def test_draims_four_satellites_cover_the_planet():
    """Draim 1987: four eccentric orbits of one period suffice for single coverage, always."""
    k = np.arange(4)
    c = keplerian(
        24453e3,
        0.263,
        31.3 * DEGREE,
        k * 90 * DEGREE,
        np.where(k % 2, 90, 270) * DEGREE,
        -k * 90 * DEGREE,
    )
    found = prove_fold(c, 1, sphere_radius=3396.19e3)
    assert found.outcome == "proven"
    assert found.span.for_all_time
    assert (random_view(c, 0.0, found.span, 20000) >= 0).sum(axis=1).min() >= 1
    # one satellite fewer, or circles, do not
    assert prove_fold(c.without([3]), 1, sphere_radius=3396.19e3).outcome == "refuted"

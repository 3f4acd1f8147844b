"""Moves of a constellation into itself: found without a label, and true in space."""

from dataclasses import replace
from math import gcd

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.orbits import keplerian, positions_mci, rosette, walker_delta, walker_star
from compass.orbits.symmetry import TOLERANCE, mirrors, phase_steps, shifts

RADIUS = 2e7


@st.composite
def patterns(draw):
    """Patterns placed anywhere, their satellites in any order."""
    planes, per_plane = draw(st.integers(1, 6)), draw(st.integers(1, 5))
    t = planes * per_plane
    make = draw(st.sampled_from([walker_delta, walker_star]))
    c = make(
        t,
        planes,
        draw(st.integers(0, planes - 1)),
        inclination_deg=draw(st.floats(20, 160)),
        radius_km=RADIUS / 1e3,
        raan_deg=draw(st.floats(-360, 360)),
        phase_deg=draw(st.floats(0, 360)),
    )
    return c, shuffled(c, draw(st.randoms(use_true_random=False)))


def shuffled(c, random):
    order = list(range(c.size))
    random.shuffle(order)
    return keplerian(
        RADIUS, 0.0, c.inclination[order], c.raan[order], 0.0, c.mean_anomaly[order] + 2 * np.pi
    )


def unit(c, times):
    """Directions, shape (time, satellite, 3)."""
    return positions_mci(c, times).transpose(1, 0, 2) / RADIUS


def parts(moves):
    return moves.turn, moves.phase, moves.image


def about_pole(angle):
    co, si = np.cos(angle), np.sin(angle)
    return np.array([[co, -si, 0.0], [si, co, 0.0], [0.0, 0.0, 1.0]])


@settings(max_examples=60)
@given(patterns())
def test_moves_are_what_they_say_in_space(made):
    """Against positions: an independent rotation of space, at two moments of an odd fraction."""
    for c in made:
        rate = c.mean_motion[0]
        times = np.array([0.0, 3217.0])
        now = unit(c, times)
        for turn, phase, image in zip(*parts(shifts(c)), strict=True):
            later = unit(c, times + phase / rate)
            turned = later @ about_pole(turn).T
            assert np.abs(turned - now[:, image]).max() < 1e-9
        for turn, phase, image in zip(*parts(mirrors(c)), strict=True):
            before = unit(c, -times - phase / rate)
            half_turn = about_pole(turn) @ np.diag([1.0, -1.0, -1.0])
            assert np.abs(before @ half_turn.T - now[:, image]).max() < 1e-9


@settings(max_examples=60)
@given(patterns())
def test_every_move_of_a_pattern_is_found_in_any_order(made):
    c, mixed = made
    p = c.pattern
    expected = p.satellites if p.kind != "walker-star" else p.per_plane
    for one in (c, mixed):
        assert len(shifts(one)) == expected == len(mirrors(one))
        assert phase_steps(one) == (
            p.per_plane if p.kind == "walker-star" else p.satellites // gcd(p.planes, p.phasing)
        )
        assert shifts(one).mismatch < 1e-13


@given(patterns(), st.integers(0, 29), st.floats(2 * TOLERANCE, 0.1))
def test_one_satellite_out_of_place_ends_it(made, which, angle):
    """With what it was called before, a constellation is what its elements are."""
    c, _ = made
    anomaly = c.mean_anomaly.copy()
    anomaly[which % c.size] += angle
    moved = replace(c, mean_anomaly=anomaly)
    assert len(shifts(moved)) < max(2, len(shifts(c)))
    for moves in (shifts(moved), mirrors(moved)):
        assert moves.mismatch <= TOLERANCE + 1e-13


def test_what_is_missed_by_little_is_told():
    c = walker_delta(6, 3, 1, inclination_deg=50, radius_km=RADIUS / 1e3)
    anomaly = c.mean_anomaly.copy()
    anomaly[2] += 3e-11
    moves = shifts(replace(c, mean_anomaly=anomaly))
    assert len(moves) == 6
    # moves that are known by where they take the first satellite miss the others by twice as much
    assert moves.mismatch == pytest.approx(6e-11, rel=0.01)


def test_satellites_that_share_a_place_stand_in_for_one_another():
    c = walker_delta(6, 3, 1, inclination_deg=50, radius_km=RADIUS / 1e3)
    twice = keplerian(
        RADIUS,
        0.0,
        c.inclination[0],
        np.tile(c.raan, 2),
        0.0,
        np.tile(c.argument_of_periapsis + c.mean_anomaly, 2),
    )
    assert len(shifts(twice)) == len(mirrors(twice)) == 6
    for image in shifts(twice).image:
        assert sorted(image) == list(range(12))
    one_place = keplerian(RADIUS, 0.0, 0.5, np.zeros(6), 0.0, np.zeros(6))
    assert len(shifts(one_place)) == 1
    # one out of three in a place counts: no turn takes two satellites to three
    assert len(shifts(twice.without([0]))) == 1


def test_other_orbits_have_none():
    c = rosette(5, 5, 1, inclination_deg=50, radius_km=RADIUS / 1e3)
    oval = replace(c, eccentricity=np.full(5, 1e-6))
    higher = replace(c, semi_major_axis=c.semi_major_axis + np.arange(5.0))
    for other in (oval, higher, c.without(range(5))):
        assert len(shifts(other)) == 1 and len(mirrors(other)) == 0
    assert len(shifts(keplerian(1e7, 0, 0.5, np.arange(2001.0), 0, 0))) == 1

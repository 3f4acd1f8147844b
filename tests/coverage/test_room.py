"""Room in the slots: sufficient, indifferent to common turns, equal to the margin at the start."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.coverage.cap import cap_radius
from compass.coverage.lasting import margins_at
from compass.coverage.margin import covering_radius
from compass.coverage.room import has_slots, room_in_slots, slot_box
from compass.errors import ArgumentError
from compass.orbits.constellation import keplerian
from compass.orbits.motion import Motion
from tests.coverage.test_lasting import SPHERE, about, few

PATTERN = few()
COVERING = covering_radius(PATTERN, 1, tolerance=1e-7).radius
SPARE = float(cap_radius(20427.7e3, SPHERE)) - COVERING


def moved(raan=0.0, inclination=0.0, along=0.0, axis=0.0):
    """The pattern with changes of each satellite, radians and m."""
    c = PATTERN
    return keplerian(
        c.semi_major_axis + axis, 0.0, c.inclination + inclination, c.raan + raan, 0.0,
        c.mean_anomaly + along,
    )  # fmt: skip


def room_of(constellation, times=(0.0,)):
    path = Motion().trajectory(constellation, 0.0, max(times) + 1000.0)
    return path, room_in_slots(PATTERN, path, times, covering=COVERING, sphere_radius=SPHERE)


def test_room_at_the_start_is_the_margin_and_common_motion_costs_nothing():
    """All of one radius keep their slots for ever; so do they all turned, or all ahead."""
    for c in (PATTERN, moved(raan=0.7), moved(along=-2.0), moved(raan=3.0, along=1.0)):
        room = room_of(c, (0.0, 1.7e5))[1]
        assert room.room == pytest.approx(SPARE, abs=1e-6)
        assert np.abs([room.along, room.across]).max() < 1e-6


def test_any_rigid_turn_leaves_it_unchanged():
    rng = np.random.default_rng(7)
    c = moved(*(0.03 * rng.standard_normal((3, 5))))
    path, room = room_of(c)
    axis = np.array([0.6, 0.0, 0.8])
    paths = np.array(path.paths)
    for p in range(len(paths)):
        for k in range(paths.shape[-1]):
            paths[p, :, :, k] = about(axis, 0.1, paths[p, :, :, k])
    turned = type(path)(path.breaks, paths, path.errors, 0.0, path.satellite_names, "turned")
    other = room_in_slots(PATTERN, turned, [0.0], covering=COVERING, sphere_radius=SPHERE)
    # the search stops near the optimum: to a hundredth of a degree
    assert other.room == pytest.approx(room.room, abs=2e-4)


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.floats(0.001, 0.25))
def test_room_is_never_more_than_the_exact_margin(seed, size):
    """Positive room is a proof: the fold of the moment holds with that much to spare."""
    rng = np.random.default_rng(seed)
    c = moved(*(size * rng.uniform(-1, 1, (3, 5))), 2e6 * size * rng.uniform(-1, 1, 5))
    path, room = room_of(c)
    assert room.room[0] <= margins_at(path, 1, [0.0], sphere_radius=SPHERE)[0] + 2e-6


def test_the_best_turn_is_near_the_best_that_a_general_optimiser_finds():
    from scipy.optimize import minimize

    from compass.core.slots import miss_of

    rng = np.random.default_rng(3)
    c = moved(*(0.04 * rng.standard_normal((3, 5))))
    path, room = room_of(c)
    x = path.states([0.0])[0][:, 0]
    directions, out = x / np.linalg.norm(x, axis=-1, keepdims=True), np.empty(11)

    def worst(q):
        angle = np.linalg.norm(q[:3])
        axis = q[:3] / angle if angle else np.array([0.0, 0.0, 1.0])
        turn = about(axis, angle, np.eye(3)).T.copy()
        return max(
            miss_of(PATTERN.raan, 0.0 + PATTERN.inclination[0], PATTERN.mean_anomaly, turn, q[3], s,
                    directions[s], out)
            for s in range(5)
        )  # fmt: skip

    best = min(
        minimize(worst, start, method="Nelder-Mead", options={"maxiter": 3000, "xatol": 1e-8, "fatol": 1e-9}).fun
        for start in (np.zeros(4), 0.02 * rng.standard_normal(4))
    )  # fmt: skip
    assert SPARE - room.room[0] <= best + 3e-4


def test_rings_over_the_equator_have_slots_too():
    ring = keplerian(20427.7e3, 0.0, 0.0, 0.0, 0.0, np.arange(3) * 2 * np.pi / 3)
    path = Motion().trajectory(ring, 0.0, 1e5)
    room = room_in_slots(ring, path, [0.0, 5e4], covering=1.0, sphere_radius=SPHERE)
    spare = float(cap_radius(20427.7e3, SPHERE)) - 1.0
    assert room.room == pytest.approx(spare, abs=1e-6)


def test_the_slot_box_uses_up_the_margin():
    box = slot_box(20427.7e3, COVERING, SPHERE)
    assert box.sideways == pytest.approx(SPARE)
    assert float(cap_radius(20427.7e3 - box.radial, SPHERE)) == pytest.approx(COVERING)


def test_unlike_orbits_have_no_slots():
    c = keplerian([2e7, 2.1e7], 0.0, 0.5, 0.0, 0.0, 0.0)
    assert not has_slots(c)
    assert not has_slots(keplerian(2e7, 0.1, 0.5, 0.0, 0.0, 0.0))
    with pytest.raises(ArgumentError, match="needs circular orbits of one radius"):
        room_in_slots(c, room_of(PATTERN)[0], [0.0], covering=1.0, sphere_radius=SPHERE)

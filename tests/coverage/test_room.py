"""Room in the slots: sufficient, indifferent to common turns, equal to the margin at the start."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.coverage.cap import cap_radius
from compass.coverage.inner_cap import inner_cap_radius
from compass.coverage.lasting import margins_at
from compass.coverage.margin import covering_radius
from compass.coverage.region import read_region
from compass.coverage.room import (
    Slots,
    covering_slots,
    has_slots,
    room_in_slots,
    slot_box,
    slots_for,
)
from compass.errors import ArgumentError
from compass.frames import prime_meridian_angle
from compass.orbits import keplerian, walker_delta
from compass.orbits.motion import Motion
from tests.coverage.test_lasting import SPHERE, about, few

PATTERN = few()
COVERING = covering_radius(PATTERN, 1, tolerance=1e-7).radius
SLOTS = Slots(PATTERN, COVERING)
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
    return path, room_in_slots(SLOTS, path, times, sphere_radius=SPHERE)


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
    other = room_in_slots(SLOTS, turned, [0.0], sphere_radius=SPHERE)
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
    room = room_in_slots(Slots(ring, 1.0), path, [0.0, 5e4], sphere_radius=SPHERE)
    spare = float(cap_radius(20427.7e3, SPHERE)) - 1.0
    assert room.room == pytest.approx(spare, abs=1e-6)


def test_the_slot_box_uses_up_the_margin():
    box = slot_box(PATTERN, COVERING, SPHERE)
    assert box.sideways == pytest.approx(SPARE)
    assert float(cap_radius(20427.7e3 - box.radial, SPHERE)) == pytest.approx(COVERING)


OBLATE = 3396.19 / 3376.2


@settings(max_examples=25)
@given(
    st.floats(1.05, 20.0), st.floats(-1.57, 1.57), st.floats(0.0, 0.8), st.integers(0, 1000)
)  # fmt: skip
def test_all_users_in_the_inner_cap_of_an_ellipsoid_see_the_satellite(far, latitude, mask, seed):
    """By elevations over the ellipsoid's own normal; a little further out some do not."""
    radius, rng = far * SPHERE, np.random.default_rng(seed)
    cap = float(inner_cap_radius(radius, latitude, SPHERE, mask, OBLATE))
    up = np.array([np.cos(latitude), 0.0, np.sin(latitude)])
    side, east = np.array([-up[2], 0.0, up[0]]), np.array([0.0, 1.0, 0.0])
    turn = rng.uniform(0, 2 * np.pi, 2000)
    around = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * east

    def lowest(angle):
        users = np.cos(angle)[:, None] * up + np.sin(angle)[:, None] * around
        users = users / np.linalg.norm(users * [1.0, 1.0, OBLATE], axis=1, keepdims=True) * SPHERE
        normals = users * [1.0, 1.0, OBLATE**2]
        sights = radius * up - users
        sine = (normals * sights).sum(axis=1)
        sine /= np.linalg.norm(normals, axis=1) * np.linalg.norm(sights, axis=1)
        return np.arcsin(sine.min()) - mask

    if cap > 0.0:
        assert lowest(cap * rng.uniform(0.0, 1.0, 2000)) >= -1e-9
        assert lowest(np.full(2000, cap)) >= -1e-9
    assert lowest(np.full(2000, cap + 1e-3)) < 0.0


@pytest.mark.slow
def test_room_and_box_on_an_ellipsoid():
    ground = {"sphere_radius": SPHERE, "stretch": OBLATE}
    path = Motion().trajectory(PATTERN, 0.0, 2e5)
    times = np.linspace(0.0, 1.9e5, 5)
    on_it = room_in_slots(SLOTS, path, times, **ground).room
    box = slot_box(PATTERN, COVERING, SPHERE, stretch=OBLATE)
    # satellites in their slots have the cap of the latitude that they stand at; the box the least
    assert np.all(on_it >= box.sideways - 1e-6)
    assert np.all(np.abs(on_it - SPARE) < np.radians(0.4))
    assert np.all(margins_at(path, 1, times, **ground) > 0.0)
    lowered = PATTERN.semi_major_axis[0] - box.radial
    latitudes = np.linspace(0.0, float(PATTERN.inclination[0]), 500)
    caps = inner_cap_radius(lowered, latitudes, SPHERE, 0.0, OBLATE)
    assert COVERING <= caps.min() < COVERING + 5e-4


def test_unlike_orbits_have_no_slots():
    c = keplerian([2e7, 2.1e7], 0.0, 0.5, 0.0, 0.0, 0.0)
    assert not has_slots(c)
    assert not has_slots(keplerian(2e7, 0.1, 0.5, 0.0, 0.0, 0.0))
    with pytest.raises(ArgumentError, match="needs circular orbits of one radius"):
        slots_for(c, 1)


@pytest.mark.parametrize("part", ["globe", "lat:-30:20", "polygon:-20,30;15,40;25,75;-10,60"])
def test_a_fold_above_all_satellites_has_no_covering_slots(part):
    region = read_region(part)
    assert covering_slots(PATTERN, PATTERN.size + 1, region) is None
    assert covering_slots(keplerian(2e7, 0.1, 0.5, 0.0, 0.0, 0.0), 1, region) is None


BAND = read_region("lat:-30:20")
POLYGON = read_region("polygon:-20,30;15,40;25,75;-10,60")
CLOSED = walker_delta(5, 5, 1, inclination_deg=43.66, repeat=(1, 1))


@pytest.fixture(scope="module")
def parts():
    """Slots for a band, and for a polygon under closed tracks, each with its region."""
    return tuple((slots_for(c, 1, part), part) for c, part in ((PATTERN, BAND), (CLOSED, POLYGON)))


@pytest.mark.slow
def test_a_band_has_its_own_caps_and_a_turn_about_the_pole_costs_nothing():
    slots = slots_for(PATTERN, 1, BAND)
    assert slots.covering < COVERING
    spare = float(cap_radius(20427.7e3, SPHERE)) - slots.covering
    path = room_of(moved(raan=1.0, along=0.3))[0]
    room = room_in_slots(slots, path, [0.0], sphere_radius=SPHERE)
    assert room.room == pytest.approx(spare, abs=1e-6)
    # tipped as a whole it is the pattern for the globe, not for a band
    tipped = moved(raan=np.sin(PATTERN.raan) * 0.02)
    path, globe = room_of(tipped)
    assert room_in_slots(slots, path, [0.0], sphere_radius=SPHERE).room[0] < spare - 0.005
    assert globe.room[0] < SPARE


@pytest.mark.slow
@settings(max_examples=15)
@given(seed=st.integers(0, 10_000), size=st.floats(0.001, 0.2), fixed=st.booleans())
def test_room_of_a_part_is_never_more_than_its_exact_margin(parts, seed, size, fixed):
    """For a band in any way it has turned, for a polygon under closed tracks at its own time."""
    rng = np.random.default_rng(seed)
    common = rng.uniform(-0.5, 0.5)
    c = moved(*(size * rng.uniform(-1, 1, (3, 5)) + [[common], [0], [-common * fixed]]))
    slots, region = parts[fixed]
    path = Motion().trajectory(c, 0.0, 1e5)
    times = [0.0, 7e4]
    room = room_in_slots(slots, path, times, sphere_radius=SPHERE).room
    exact = margins_at(path, 1, times, sphere_radius=SPHERE, region=region)
    assert np.all(room <= exact + 2e-5)


def test_a_satellite_that_hovers_elsewhere_leaves_a_place_no_room():
    """With phase or turn free it would seem to have all."""
    hover = keplerian(20427.7e3, 0.0, 0.0, 0.0, 0.0, 0.0, repeat=(1, 1))
    under = -np.degrees(prime_meridian_angle(0.0, 0.0))
    corners = [(-5, -5), (-5, 5), (5, 5), (5, -5)]
    below = read_region("polygon:" + ";".join(f"{la},{lo + under}" for la, lo in corners))
    slots = slots_for(hover, 1, below)
    away = keplerian(20427.7e3, 0.0, 0.0, np.radians(80.0), 0.0, 0.0)
    here, there = (
        room_in_slots(slots, Motion().trajectory(c, 0.0, 1e5), [0.0], sphere_radius=SPHERE).room[0]
        for c in (hover, away)
    )
    assert here > 1.0
    assert here - there == pytest.approx(np.radians(80.0), abs=slots.closure + 1e-9)
    assert there < 0.0


@pytest.mark.slow
def test_without_closed_tracks_a_place_has_what_its_latitudes_have(parts):
    slots = slots_for(PATTERN, 1, POLYGON)
    assert not slots.region.mars_fixed
    assert slots.covering >= parts[1][0].covering

"""Beacons: places, motion, visibility, schedule."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.entry.beacons import Beacons, orbiting_beacons, surface_beacons
from compass.entry.schedule import Measurements, check_apart, in_view
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError
from compass.orbits import keplerian, states_mci

RADIUS = 3397.2e3


@settings(deadline=None, max_examples=50)
@given(st.floats(-1.5, 1.5), st.floats(-3.1, 3.1), st.floats(1e3, 2e6), st.floats(-1.5, 1.5))
def test_line_of_sight_from_the_surface_is_the_horizon_of_eq_52(lat, lon, height, beacon_lat):
    state = np.array([[RADIUS + height, lon, lat, 1.0, 0.0, 0.0]])
    beacon = surface_beacons(beacon_lat, 0.0, [0.0], planet_radius=RADIUS)
    line = cartesian_of(state)[0, :3] - beacon.r[0, 0]
    sine = line @ beacon.r[0, 0] / (np.linalg.norm(line) * RADIUS)
    if abs(sine) > 1e-6:  # a hair from the horizon rounding decides
        assert in_view(beacon, state, RADIUS) == (sine > 0)


def test_line_of_sight_is_a_segment_that_misses_the_sphere(orbiter_beacons):
    """Eqs. 58 to 60 against the closest point of the segment to the centre."""
    rng = np.random.default_rng(5)
    count = 300
    states = np.zeros((count, 6))
    states[:, 0] = RADIUS + rng.uniform(1e4, 3e5, count)
    states[:, 1], states[:, 2] = rng.uniform(-3, 3, count), rng.uniform(-1.4, 1.4, count)
    r = rng.normal(size=(count, 1, 3))
    r *= (RADIUS + 725e3) / np.linalg.norm(r, axis=2, keepdims=True)
    beacons = Beacons(("o",), np.arange(count), r, np.zeros_like(r), np.array([True]))
    lander = cartesian_of(states)[:, :3]
    way = r[:, 0] - lander
    part = np.clip(-(lander * way).sum(1) / (way * way).sum(1), 0, 1)
    closest = np.linalg.norm(lander + part[:, None] * way, axis=1)
    np.testing.assert_array_equal(in_view(beacons, states, RADIUS)[:, 0], closest > RADIUS)


def test_below_the_sphere_a_lander_still_has_a_sky():
    """On the ground and a little under the sphere: the horizon of the sphere itself, no nan."""
    state = np.array([[RADIUS - 10.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
    high = Beacons(
        ("o",), np.zeros(1), np.array([[[2 * RADIUS, 0, 0]]]), np.zeros((1, 1, 3)), np.array([True])
    )
    assert in_view(high, state, RADIUS).all()


def test_mask_hides_the_low_sky_of_surface_beacons():
    state = np.array([[RADIUS + 50e3, 0.1, 0.0, 1.0, 0.0, 0.0]])
    beacon = surface_beacons(0.0, [0.0, 0.0999], [0.0], planet_radius=RADIUS)
    assert in_view(beacon, state, RADIUS).tolist() == [[True, True]]
    masked = beacon.above(np.radians(30.0))
    assert in_view(masked, state, RADIUS).tolist() == [[False, True]]
    both = beacon.with_others(masked).chosen([0, 2])
    assert in_view(both, state, RADIUS).tolist() == [[True, False]]
    with pytest.raises(ArgumentError, match="masks: 1 for 2 beacons"):
        Beacons(*(getattr(beacon, n) for n in ("names", "times", "r", "v", "moving")), np.ones(1))


def test_mask_hides_satellites_near_the_limb():
    """A satellite so far over the lander's limb, found by angles between directions."""
    height, mask = 60e3, np.radians(30.0)
    state = np.array([[RADIUS + height, 0.0, 0.0, 1.0, 0.0, 0.0]])
    limb = np.pi / 2 - np.arcsin(RADIUS / (RADIUS + height))  # below the horizontal
    for over, seen in ((mask - 1e-6, False), (mask + 1e-6, True)):
        elevation = over - limb
        line = 1e7 * np.array([np.sin(elevation), np.cos(elevation), 0.0])
        place = np.array([RADIUS + height, 0.0, 0.0]) + line
        one = Beacons(("o",), np.zeros(1), place[None, None], np.zeros((1, 1, 3)), np.ones(1, bool))
        assert in_view(one.above(mask), state, RADIUS).all() == seen
        assert in_view(one, state, RADIUS).all()


def test_orbiters_turn_backwards_in_mars_fixed_axes():
    omega = 7.088218e-5
    orbit = keplerian(4122.2e3, 0.1, 0.6, 1.0, 2.0, 3.0)
    times = np.array([0.0, 100.0, 100.0 + 1e-2])
    r, v = states_mci(orbit, times)
    beacons = orbiting_beacons(r, v, times, omega=omega, angle=0.4, planet_radius=RADIUS)
    np.testing.assert_allclose(
        np.linalg.norm(beacons.r[:, 0], axis=1), np.linalg.norm(r[0], axis=1)
    )
    # velocity is the derivative of the Mars-fixed position
    slope = (beacons.r[2, 0] - beacons.r[1, 0]) / 1e-2
    np.testing.assert_allclose(beacons.v[1, 0], slope, atol=0.05)
    c, s = np.cos(0.4), np.sin(0.4)
    turned = [c * r[0, 0, 0] + s * r[0, 0, 1], c * r[0, 0, 1] - s * r[0, 0, 0], r[0, 0, 2]]
    np.testing.assert_allclose(beacons.r[0, 0], turned)


def test_beacons_under_the_surface_are_refused():
    with pytest.raises(ArgumentError, match=r"beacon deep: height = -1 km: under the surface"):
        surface_beacons(0.0, 0.0, [0.0], planet_radius=RADIUS, height=-1e3, names=["deep"])
    r, v = states_mci(keplerian(3.4e6, 0.2, 0.1, 0, 0, 0), [0.0])
    with pytest.raises(ArgumentError, match="beacon O1: comes down to radius 2720 km, under"):
        orbiting_beacons(r, v, [0.0], omega=0.0, planet_radius=RADIUS)


def test_a_beacon_at_the_lander_is_refused():
    state = np.array([[RADIUS, 0.3, 0.2, 1.0, 0.0, 0.0]])
    beacon = surface_beacons(0.2, 0.3, [7.0], planet_radius=RADIUS, names=["here"])
    with pytest.raises(ArgumentError, match="beacon here: at the lander's own place at 7 s"):
        check_apart(beacon, state)


def test_sets_join_and_split(orbiter_beacons):
    orbiters = orbiter_beacons()
    ground = surface_beacons([0.1, 0.2], 0.3, orbiters.times, planet_radius=RADIUS)
    both = ground.with_others(orbiters)
    assert both.names == ("B1", "B2", "O1", "O2", "O3")
    np.testing.assert_array_equal(both.chosen(both.moving).r, orbiters.r)
    with pytest.raises(ArgumentError, match="same times"):
        both.with_others(surface_beacons(0.1, 0.2, [0.0], planet_radius=RADIUS))


def test_schedule():
    times, seen = np.arange(11.0), np.ones((11, 3), bool)
    seen[:, 1] = times > 4
    all_at_once = Measurements(50.0, interval=2.0, start=2.0, stop=8.0).taken(seen, times)
    assert all_at_once.any(axis=1).nonzero()[0].tolist() == [2, 4, 6, 8]
    assert all_at_once[2].tolist() == [True, False, True]
    # counted from the first, not from entry; without an epoch at the start, from the next
    for start in (1.0, 0.5):
        odd = Measurements(50.0, interval=3.0, start=start).taken(seen, times)
        assert odd.any(axis=1).nonzero()[0].tolist() == [1, 4, 7, 10]
    assert not Measurements(50.0, start=11.0).taken(seen, times).any()
    in_turn = Measurements(50.0, in_turn=True).taken(seen, times)
    assert (in_turn.sum(axis=1) == 1).all()
    assert in_turn[:7].argmax(axis=1).tolist() == [0, 2, 0, 2, 0, 1, 2]
    nothing = Measurements(50.0, in_turn=True).taken(np.zeros((4, 2), bool), times[:4])
    assert not nothing.any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0,), "range_sigma = 0"),
        ((50.0, -1.0), "rate_sigma = -1"),
        ((None, None), "give range_sigma, rate_sigma or both"),
        ((50.0, None, 0.0), "interval = 0"),
    ],
)
def test_noise_must_be_positive(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        Measurements(*arguments)

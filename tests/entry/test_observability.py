"""Observability: computed check values, plain words, symmetries."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.spatial.transform import Rotation

from compass.entry.beacons import surface_beacons
from compass.entry.observability import blind_spots, observability
from compass.entry.views import cartesian_of, spherical_of

RADIUS = 3397.2e3


def test_degree_and_index_of_the_chapter(world, ground_flight, ground_beacons):
    found = observability(world(), ground_flight.states, ground_beacons)
    at = [0, 60, 120]
    degree = [1.540708092093e-8, 1.085359223315e-7, 5.553464656322e-8]
    index = [1.230201859475e-3, 2.463502396668e-1, 5.121074179162e-2]
    np.testing.assert_allclose(found.spherical_degree[at], degree, rtol=1e-7)
    np.testing.assert_allclose(found.index[at], index, rtol=1e-11)
    assert np.all(found.rank == 6)


def test_lie_derivatives_of_the_chapter(world, ground_flight, ground_beacons):
    found = blind_spots(world(), ground_flight.states[0], ground_beacons.chosen([0]))
    published = [4.257117624935e5, -5.343163913474e3, 3.237743025510]
    published += [1.533564475041e-1, 7.480302931116e-3, 4.586366874155e-4]
    np.testing.assert_allclose(found.lie, published, rtol=1e-10)


@pytest.mark.parametrize("omega", [0.0, 7.088218e-5])
def test_table_6_integral(world, table5, orbiter_beacons, omega):
    from compass.entry.trajectory import fly

    model = world("coriolis" if omega else "none")
    flight = fly(model, table5, np.arange(241.0))
    # the index needs the zeroth order alone
    found = observability(model, flight.states, orbiter_beacons(omega), orders=1)
    assert found.index[0] == pytest.approx(0.942924962767, abs=1e-11)
    published = 236.8509921 if omega else 236.0080511
    assert simpson(found.index, x=flight.times) == pytest.approx(published, abs=1e-6)


def test_index_is_the_sum_over_triples(world, ground_flight):
    lat, lon = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4], [-27.0, -78.0]]).T
    beacons = surface_beacons(lat, lon, ground_flight.times, planet_radius=RADIUS)
    found = observability(world(), ground_flight.states, beacons, orders=1)
    line = cartesian_of(ground_flight.states)[:, None, :3] - beacons.r
    n = line / np.linalg.norm(line, axis=2, keepdims=True)
    triples = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
    total = sum(np.linalg.det(n[:, triple, :]) ** 2 for triple in triples)
    np.testing.assert_allclose(found.index, total, rtol=1e-10)


def test_turning_everything_about_the_pole_changes_nothing(world, ground_flight):
    states = ground_flight.states[::40]
    turned = states + np.array([0, 1.0, 0, 0, 0, 0, 0, 0])
    lat, lon = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4]]).T
    times = ground_flight.times[::40]
    a, b = (
        observability(world(), x, surface_beacons(lat, y, times, planet_radius=RADIUS))
        for x, y in ((states, lon), (turned, lon + 1.0))
    )
    np.testing.assert_allclose(a.singular_values, b.singular_values, rtol=1e-6)
    np.testing.assert_allclose(a.spherical_degree, b.spherical_degree, rtol=1e-6)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_any_turn_of_a_planet_at_rest_changes_nothing(world, ground_flight, seed):
    """Over the pole too, where longitudes and headings are nothing."""
    path, times = ground_flight.path[::60], ground_flight.times[::60]
    lat, lon = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4]]).T
    at = surface_beacons(lat, lon, times, planet_radius=RADIUS)
    if seed == 1:  # the second epoch on the polar axis itself
        up = path[1, :3] / np.linalg.norm(path[1, :3])
        turn, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])
    else:
        turn = Rotation.random(rng=np.random.default_rng(seed))
    m = turn.as_matrix()
    moved = np.concatenate([path[:, :3] @ m.T, path[:, 3:] @ m.T], axis=1)
    model = world("none")
    a = observability(model, spherical_of(path), at)
    b = observability(model, spherical_of(moved), replace(at, r=at.r @ m.T))
    np.testing.assert_allclose(b.singular_values, a.singular_values, rtol=1e-6)
    np.testing.assert_array_equal(b.rank, a.rank)
    words = [
        blind_spots(model, spherical_of(x[1]), seen, 1).weakest
        for x, seen in ((path, at), (moved, replace(at, r=at.r @ m.T)))
    ]
    assert all(words)


@pytest.mark.slow
def test_threads_and_order_of_beacons_change_nothing(world, ground_flight, ground_beacons):
    one = observability(world(), ground_flight.states, ground_beacons, threads=1)
    four = observability(world(), ground_flight.states, ground_beacons, threads=4)
    np.testing.assert_array_equal(one.singular_values, four.singular_values)
    other = observability(world(), ground_flight.states, ground_beacons.chosen([2, 0, 1]))
    np.testing.assert_allclose(one.degree, other.degree, rtol=1e-9)


def test_one_beacon_over_a_planet_at_rest_hides_a_rotation(world, ground_flight, ground_beacons):
    model, state = world("none"), ground_flight.states[60]
    found = blind_spots(model, state, ground_beacons.chosen([0]), 60)
    assert found.rank == 5
    assert len(found.words) == 1
    assert "rotation of position and velocity together" in found.words[0]
    assert found.words[0].endswith("to beacon B1")
    # the matrix really does not see it
    moved = found.matrix @ found.directions[0]
    assert np.all(np.abs(moved) <= 1e-12 * (np.abs(found.matrix) @ np.abs(found.directions[0])))
    # ... and that is the rotation: each radius vector turned about the beacon keeps its range
    assert observability(model, state, ground_beacons.chosen([0])).rank[0] == 5


def test_the_turning_planet_breaks_that_symmetry_unless_the_beacon_is_at_the_pole(
    world, ground_flight, ground_beacons
):
    state = ground_flight.states[60]
    assert blind_spots(world(), state, ground_beacons.chosen([0]), 60).rank == 6
    pole = surface_beacons(np.pi / 2, 0.0, [0.0], planet_radius=RADIUS, names=["pole"])
    found = blind_spots(world("full"), state, pole)
    assert found.rank == 5
    assert found.words[0].endswith("to beacon pole")


def test_full_rank_tells_the_weakest_direction(world, ground_flight, ground_beacons):
    found = blind_spots(world(), ground_flight.states[60], ground_beacons, 60)
    assert found.rank == 6
    assert found.words == ()
    assert "velocity" in found.weakest


def test_no_beacon_shows_nothing(world, ground_flight, ground_beacons):
    none = np.zeros(3, bool)
    for beacons, taken in ((ground_beacons, none), (ground_beacons.chosen([]), None)):
        found = blind_spots(world(), ground_flight.states[0], beacons, 0, taken)
        assert found.rank == 0
        assert "nothing at all" in found.words[0]
        many = observability(
            world(),
            ground_flight.states,
            beacons,
            None if taken is None else np.tile(none, (241, 1)),
        )
        assert np.all(many.degree == 0)
        assert np.all(many.rank == 0)


def test_few_lie_derivatives_leave_directions_to_be_named(world, ground_flight, ground_beacons):
    """Two orders of one range: four directions stay hidden, each in words."""
    found = blind_spots(world(), ground_flight.states[60], ground_beacons.chosen([0]), 60, orders=2)
    assert found.rank == 2
    assert len(found.words) == 4
    assert all("shift" in words or "rotation" in words for words in found.words)
    assert np.linalg.matrix_rank(found.directions / np.abs(found.directions).max(axis=0)) == 4


def test_range_rates_add_rank(world, orbiter_flight, orbiter_beacons):
    beacons = orbiter_beacons().chosen([0])
    state = orbiter_flight.states[0]
    both = blind_spots(world(), state, beacons, rates=True, orders=1)
    assert both.rank == 2
    assert both.matrix.shape == (2, 6)
    rates = blind_spots(world(), state, beacons, ranges=False, rates=True, orders=5)
    ranges = blind_spots(world(), state, beacons, orders=6)
    # the Lie derivatives of the rate are those of the range, one order on
    np.testing.assert_allclose(rates.lie, ranges.lie[1:], rtol=1e-9)

"""Errors of the satellites in a landing: considered, and every source's share of the whole."""

from dataclasses import replace

import numpy as np
import pytest

from compass.entry.assess import assess
from compass.entry.beacons import orbiting_beacons, surface_beacons
from compass.entry.budget import with_satellites
from compass.entry.consistency import FALSE_ALARM, nees_bounds
from compass.entry.covariance import axes_covariance
from compass.entry.filters import Filter
from compass.entry.layout import Part
from compass.entry.schedule import Measurements, in_view
from compass.entry.trajectory import fly
from compass.orbits import keplerian, states_mci
from tests.entry.one_run import ideal_measurements, run_filter

GM, RADIUS, OMEGA = 4.282829e13, 3397.2e3, 7.088218e-5

#: Radial, along, cross, clock, m.
SIGMAS = np.array([20.0, 80.0, 50.0, 30.0])
#: Turn of the frame that satellites share, about each axis, rad: 1 arcsecond, 16 m on the ground.
TURN = 4.8e-6

RADIO = Measurements(5.0, 0.05, 20.0)
LANDER = Filter(axes_covariance(1000.0, 0.5), np.zeros(6))


@pytest.fixture(scope="module")
def flight(world, table5):
    return fly(world(), table5, np.arange(0.0, 241.0, 20.0))


@pytest.fixture(scope="module")
def satellites(flight):
    """Satellites of half a sol in two planes, most of them over the lander."""
    node, anomaly = np.radians([[40, 40, 40, 330, 330, 330], [230, 260, 300, 250, 290, 320]])
    orbits = keplerian(20427e3, 0, np.radians(45), node, 0, anomaly, gm=GM)
    r, v = states_mci(orbits, flight.times)
    return orbiting_beacons(r, v, flight.times, omega=OMEGA, planet_radius=RADIUS)


def errors_of(beacons, sigmas=SIGMAS):
    return np.tile(np.diag(np.square(sigmas)), (beacons.size, 1, 1))


def landed(flight, beacons, settings=LANDER, measured=RADIO, **more):
    return assess(flight.model, flight, beacons, measured, settings, runs=1, **more)


def test_squares_of_all_shares_add_up_whatever_is_not_known(flight, satellites):
    lat, lon = np.radians([[-28.0, -90.0], [-26.0, -80.0]]).T
    ground = surface_beacons(lat, lon, flight.times, planet_radius=RADIUS)
    both = ground.with_others(satellites)
    errors = np.concatenate([np.zeros((2, 4, 4)), errors_of(satellites)])
    parts = (
        Part("air", (0.1,), False, (7e3, 1e5)),
        Part("lift", (0.01,), True),
        Part("clock", (300.0, 0.3)),
        Part("bias", (2.0,)),
    )
    lander = Filter(LANDER.covariance0, np.full(6, 1e-9), parts=parts)
    turns = np.concatenate([np.zeros(2), np.full(satellites.size, TURN)])
    found = landed(flight, both, lander, satellites=errors, turns=turns)
    whole = found.accuracy.knowledge.along_cross_down
    assert {share.name for share in found.budget} == {
        "first state", "process noise", "density", "lift-to-drag ratio", "receiver's clock",
        "satellites' orbits", "satellites' clocks", "satellites' frame", "biases of the ranges",
        "noise of the ranges", "noise of the range rates",
    }  # fmt: skip
    squares = np.sum([share.along_cross_down**2 for share in found.budget], axis=0)
    np.testing.assert_allclose(squares, whole**2, rtol=1e-8)


def test_a_better_clock_betters_the_landing_as_the_budget_says(flight, satellites):
    """Gains are the best: to first order their change counts for nothing, and shares scale."""

    def variance(factor):
        errors = errors_of(satellites, SIGMAS * [1, 1, 1, np.sqrt(factor)])
        found = landed(flight, satellites, satellites=errors)
        return found, float(np.sum(found.accuracy.knowledge.along_cross_down**2))

    found, here = variance(1.0)
    share = next(s for s in found.budget if s.name == "satellites' clocks").sigma ** 2
    assert share > 0.01 * here
    step = 0.02
    slope = (variance(1.0 + step)[1] - variance(1.0 - step)[1]) / (2 * step)
    assert slope == pytest.approx(share, rel=0.02)


def test_what_is_known_exactly_is_not_counted(flight, satellites):
    none = landed(flight, satellites)
    zero = landed(flight, satellites, satellites=errors_of(satellites, np.zeros(4)))
    assert none.known_exactly and not zero.known_exactly
    np.testing.assert_array_equal(none.bound.covariance, zero.bound.covariance)
    assert not any("satellites" in share.name for share in none.budget)


def turned_by(vector):
    """Of turns by w: columns of ``w x v``."""
    return np.cross(np.eye(3), vector).T


def test_a_turn_of_the_frame_moves_the_lander_with_its_satellites(flight, satellites):
    """Its covariance is that of a frame that stands still, and of ``w x r`` beside it.

    To what the first state, known to 1 km and 0.5 m/s, tells of the frame: the 16 m of the turn
    against 1 km, 3e-4; and to the Coriolis acceleration of a flight that is turned against Mars's
    axis, ``omega v t^2 / R = 7e-3``.
    """
    errors = errors_of(satellites)
    turns = np.full(satellites.size, TURN)
    still = landed(flight, satellites, satellites=errors)
    turned = landed(flight, satellites, satellites=errors, turns=turns)
    added = turned.bound.covariance[-1, :3, :3] - still.bound.covariance[-1, :3, :3]
    moved = TURN * turned_by(flight.path[-1, :3])
    wanted = moved @ moved.T
    assert np.trace(wanted) == pytest.approx(2 * (TURN * np.linalg.norm(flight.path[-1, :3])) ** 2)
    np.testing.assert_allclose(added, wanted, rtol=0, atol=8e-3 * np.trace(wanted))
    # over the place east and north alike, and not up
    at = still.accuracy.knowledge, turned.accuracy.knowledge
    along, across, _ = at[1].along_cross_down ** 2 - at[0].along_cross_down ** 2
    assert along == pytest.approx(np.trace(wanted) / 2, rel=8e-3)
    assert across == pytest.approx(np.trace(wanted) / 2, rel=8e-3)
    assert at[1].cep > at[0].cep and at[1].ellipse.semi_major > at[0].ellipse.semi_major
    share = next(s for s in turned.budget if s.name == "satellites' frame")
    assert np.sum(share.along_cross_down**2) == pytest.approx(np.trace(wanted), rel=8e-3)


def test_who_hears_beacons_on_the_ground_as_well_knows_more_of_the_frame(flight, satellites):
    lat, lon = np.radians([[-28.0, -90.0], [-26.0, -80.0], [-30.0, -85.0]]).T
    both = surface_beacons(lat, lon, flight.times, planet_radius=RADIUS).with_others(satellites)

    def shared(first):
        turns = np.full(both.size, 10 * TURN)
        turns[:first] = 0.0
        found = landed(flight, both, turns=turns)
        return next(s.sigma for s in found.budget if s.name == "satellites' frame")

    assert shared(3) < 0.2 * shared(0)


def test_a_filter_of_information_estimates_the_frame(flight, satellites):
    turns = np.full(satellites.size, TURN)
    lander = replace(LANDER, method="information")
    made = with_satellites(lander, None, satellites, flight.path, OMEGA, turns=turns).settings
    assert [part.considered for part in made.parts] == [False]
    plain = with_satellites(LANDER, None, satellites, flight.path, OMEGA, turns=turns).settings
    assert [part.considered for part in plain.parts] == [True]


def test_clocks_of_satellites_do_not_enter_what_is_measured_both_ways(flight, satellites):
    errors = errors_of(satellites, [0, 0, 0, 30.0])
    found = with_satellites(LANDER, errors, satellites, flight.path, OMEGA, one_way=False)
    assert found.settings is LANDER


def test_an_orbit_and_a_clock_that_make_up_for_each_other_are_one_source(flight, satellites):
    errors = errors_of(satellites)
    errors[:, 0, 3] = errors[:, 3, 0] = -0.9 * SIGMAS[0] * SIGMAS[3]
    apart = with_satellites(LANDER, errors_of(satellites), satellites, flight.path, OMEGA)
    found = with_satellites(LANDER, errors, satellites, flight.path, OMEGA)
    assert list(found.variances) == ["satellites' orbits and clocks"]
    # the lander looks up, at some 30 deg of nadir at most: a satellite too high and late is near
    whole = found.variances["satellites' orbits and clocks"]
    assert np.all(whole != sum(apart.variances.values()))


@pytest.mark.slow
def test_satellites_that_are_not_where_they_say_leave_the_claimed_errors(flight, satellites):
    """Ranges of displaced satellites, drawn: nothing of the filter's own model of them is used.

    All are turned alike besides, so far that it counts most.
    """
    rng, runs, turn = np.random.default_rng(5), 200, 5 * TURN
    errors, turns = errors_of(satellites), np.full(satellites.size, turn)
    settings = with_satellites(LANDER, errors, satellites, flight.path, OMEGA, turns=turns).settings
    measured = Measurements(5.0, None, 20.0)
    taken = in_view(satellites, flight.states, RADIUS)
    up = satellites.r / np.linalg.norm(satellites.r, axis=2, keepdims=True)
    cross = np.cross(satellites.r, satellites.v + np.cross([0, 0, OMEGA], satellites.r))
    cross /= np.linalg.norm(cross, axis=2, keepdims=True)
    axes = np.stack([up, np.cross(cross, up), cross], axis=3)  # columns
    squares = []
    for _ in range(runs):
        drawn = rng.standard_normal((satellites.size, 4)) * SIGMAS
        off = np.einsum("tnij,nj->tni", axes, drawn[:, :3])
        off += np.cross(turn * rng.standard_normal(3), satellites.r)
        true = replace(satellites, r=satellites.r + off)
        z = ideal_measurements(flight.path, true)
        z[..., 0] += drawn[:, 3] + 5.0 * rng.standard_normal(z.shape[:2])
        first = flight.path[0] + np.repeat([1000.0, 0.5], 3) * rng.standard_normal(6)
        x, p = run_filter(flight.model, first, satellites, taken, measured, settings, z)
        off = x[-1, :6] - flight.path[-1]
        squares.append(off @ np.linalg.solve(p[-1, :6, :6], off))
    low, high = nees_bounds(6, runs, 1.0 - FALSE_ALARM)
    assert low < np.mean(squares) < high

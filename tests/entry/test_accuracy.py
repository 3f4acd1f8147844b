"""Knowledge and delivery: ellipses and circles against draws, projections against flights."""

from dataclasses import replace

import numpy as np
import pytest

from compass.entry.accuracy import accuracy, circular_error, error_ellipse, projection
from compass.entry.consistency import consistency, nees_bounds
from compass.entry.covariance import axes_covariance, linear_covariance
from compass.entry.layout import Layout
from compass.entry.schedule import Measurements
from compass.entry.start import Trigger
from compass.entry.trajectory import airspeeds, fly
from compass.entry.views import along_cross_down, cartesian_of, local_axes, spherical_of
from compass.errors import ArgumentError

PRIOR = axes_covariance(100.0, 0.05)


def test_circle_holds_half():
    # a circle: sqrt(2 ln 2) sigma; a line: the quantile of a normal number
    assert circular_error(9.0 * np.eye(2)) == pytest.approx(3 * np.sqrt(2 * np.log(2)), rel=1e-9)
    assert circular_error(np.diag([4.0, 0.0])) == pytest.approx(2 * 0.6744897502, rel=1e-6)
    assert circular_error(np.zeros((2, 2))) == 0.0
    draws = np.random.default_rng(0).multivariate_normal([0, 0], [[9, 2], [2, 1]], size=200_000)
    found = circular_error(np.array([[9.0, 2.0], [2.0, 1.0]]), 0.9)
    inside = (np.linalg.norm(draws, axis=1) < found).mean()
    assert inside == pytest.approx(0.9, abs=4 * np.sqrt(0.09 / 200_000))


def test_projection_keeps_the_surface():
    rng = np.random.default_rng(1)
    f, g = rng.normal(size=6), rng.normal(size=6)
    m = projection(f, g)
    np.testing.assert_allclose(g @ m, np.zeros(6), atol=1e-12)
    np.testing.assert_allclose(m @ m, m, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trigger", "reached"),
    [
        (Trigger("high", "altitude", 40e3), True),
        (Trigger("fast", "speed", 1000.0), True),
        (Trigger("mach", "mach", 10.0), True),
        (Trigger("never", "speed", 1.0), False),
    ],
)
def test_delivery_is_the_scatter_of_flights(world, table5, orbiter_beacons, trigger, reached):
    """Flights from drawn starts to the trigger itself: their scatter is the projected covariance."""
    model, beacons = world(), orbiter_beacons()
    if trigger.quantity == "mach":  # through air that moves
        winds = ((3.40e6, 60.0, 20.0), (3.48e6, -90.0, -40.0))
        model = replace(model, atmosphere=replace(model.atmosphere, winds=winds))
    flight = fly(model, table5, np.arange(241.0), triggers=[trigger])
    none = np.zeros((241, 3), bool)
    bound = linear_covariance(model, flight.path, beacons, none, Measurements(50.0), PRIOR)
    found = accuracy(flight, bound, Layout(beacons=3), PRIOR, 0.0, trigger)
    assert found.projected is reached
    if trigger.quantity == "mach":
        [speed] = airspeeds(model, found.path[None])
        assert speed == pytest.approx(10.0 * model.atmosphere.speed_of_sound, rel=1e-9)
    # nothing was measured: what is known is what is delivered
    np.testing.assert_allclose(
        found.knowledge.along_cross_down, found.delivery.along_cross_down, rtol=1e-9
    )
    rng, start, places = np.random.default_rng(2), cartesian_of(table5), []
    for _ in range(60):
        drawn = start + np.sqrt(np.diag(PRIOR)) * rng.normal(size=6)
        one = fly(model, spherical_of(drawn), [0.0, 260.0], triggers=[trigger])
        event = next((e for e in one.events if e.name == trigger.name), None)
        whole = fly(model, spherical_of(drawn), [0.0, 240.0]).path[-1]
        places.append(cartesian_of(event.state[:6]) if event else whole)
    off = (np.array(places)[:, :3] - found.path[:3]) @ along_cross_down(found.path).T
    scatter = np.sqrt((off**2).mean(axis=0))
    # 60 draws: a root mean square is good to 1/sqrt(120)
    large = found.delivery.along_cross_down > 1.0
    np.testing.assert_allclose(
        scatter[large], found.delivery.along_cross_down[large], rtol=4 / np.sqrt(120)
    )
    if trigger.quantity == "altitude":  # on the surface nothing is left downwards
        assert found.delivery.along_cross_down[2] < 0.02 * found.delivery.along_cross_down[0]


def test_axes_of_vertical_flight_are_defined():
    path = np.array([3.4e6, 0.0, 0.0, -10.0, 0.0, 0.0])
    axes = along_cross_down(path)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(axes[0], local_axes(path[:3])[0], atol=1e-12)


def test_consistent_filters_are_believed_and_others_not():
    """Chi-square draws: two hundred flights of 50 runs, called inconsistent once in a thousand."""
    rng = np.random.default_rng(3)
    times, fine = np.arange(40.0), np.zeros(50, bool)
    calls = [consistency(rng.chisquare(6, size=(50, 40)), times, 6, fine).holds for _ in range(200)]
    assert sum(calls) >= 198
    told = consistency(1.5 * rng.chisquare(6, size=(50, 40)), times, 6, fine)
    assert not told.holds
    assert told.ratio == pytest.approx(np.sqrt(1.5), rel=0.3)
    assert "too sure of itself" in told.sentence


def test_error_ellipse_holds_what_it_says():
    rng = np.random.default_rng(1)
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    covariance = turn @ np.diag([1.0, 25.0]) @ turn.T
    ellipse = error_ellipse(np.array([3.0, -2.0]), covariance)
    assert ellipse.semi_major == pytest.approx(5 * np.sqrt(-2 * np.log(0.05)))
    points = rng.multivariate_normal([3.0, -2.0], covariance, 4000) - [3.0, -2.0]
    inside = np.einsum("ia,ab,ib->i", points, np.linalg.inv(covariance), points) <= -2 * np.log(
        0.05
    )
    assert inside.mean() == pytest.approx(0.95, abs=5 * np.sqrt(0.95 * 0.05 / 4000))
    outline = ellipse.outline() - [3.0, -2.0]
    level = np.einsum("ia,ab,ib->i", outline, np.linalg.inv(covariance), outline)
    np.testing.assert_allclose(level, -2 * np.log(0.05), rtol=1e-9)


def test_nees_bounds_are_the_chi_square_s():
    # Bar-Shalom et al. 2001, section 5.4.2: 50 runs of 2 states: [1.5, 2.6]
    low, high = nees_bounds(2, 50)
    assert (round(low, 1), round(high, 1)) == (1.5, 2.6)
    with pytest.raises(ArgumentError, match="runs = 0"):
        nees_bounds(8, 0)

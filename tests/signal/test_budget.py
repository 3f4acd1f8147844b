"""The budget of a range against lines of sight that are drawn one by one."""

from dataclasses import replace

import numpy as np
import pytest

from compass.bodies import BOLTZMANN
from compass.clocks import Clock
from compass.design import Design
from compass.errors import ArgumentError
from compass.links import Radio
from compass.orbits import walker_delta
from compass.ranging import Receiver, Signal
from compass.signal.budget import (
    aged_covariance,
    mean_age_covariance,
    range_budget,
    receiver_numbers,
)
from compass.signal.ionosphere import obliquity, zenith_delay
from compass.signal.weights import average_weights

R, ORBIT = 3.3962e6, 20.4277e6


def design(**signal):
    constellation = walker_delta(3, 3, 1, inclination_deg=45, radius_km=ORBIT / 1e3)
    return Design(
        name="d", constellation=constellation, figure="kelly2018-sphere", signal=Signal(**signal)
    )


def sights(mask, n=200_000, seed=3):
    """Unit vectors from users drawn over the cap to a satellite on the x axis, z its radial... x."""
    rng = np.random.default_rng(seed)
    rim = np.cos(np.arccos(R * np.cos(mask) / ORBIT) - mask)
    c, turn = rng.uniform(rim, 1, n), rng.uniform(0, 2 * np.pi, n)
    s = np.sqrt(1 - c * c)
    users = R * np.stack([c, s * np.cos(turn), s * np.sin(turn)], axis=1)
    d = np.array([ORBIT, 0, 0]) - users
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize("mask", [0.0, 5.0, 10.0])
def test_average_weights_are_means_over_users_drawn(mask):
    """Radial is x, along y, cross z. 2e5 users: the means are known to 0.2 %."""
    found, drawn = average_weights(ORBIT, R, np.radians(mask)), sights(np.radians(mask))
    assert found.radial**2 == pytest.approx((drawn[:, 0] ** 2).mean(), rel=1e-4)
    across = 0.5 * (drawn[:, 1] ** 2 + drawn[:, 2] ** 2).mean()
    assert found.across2 == pytest.approx(across, rel=0.01)


@pytest.mark.parametrize(
    ("radius", "mask", "radial", "inverse"),
    [
        # own values, from an integration outside this program
        (20427.7, 0, 0.9903, 104.0),
        (20427.7, 5, 0.9908, 109.4),
        (20427.7, 10, 0.9914, 116.3),
        (3396.2 + 800, 0, 0.661, 3.6),
    ],
)
def test_weights_about_mars(radius, mask, radial, inverse):
    found = average_weights(radius * 1e3, R, np.radians(mask))
    assert found.radial == pytest.approx(radial, abs=6e-5 if radial > 0.7 else 6e-4)
    assert 1 / found.across2 == pytest.approx(inverse, abs=0.06)


def test_a_satellite_below_the_surface_is_refused():
    with pytest.raises(ArgumentError, match="must be above the surface"):
        average_weights(R, R)


def test_one_user_is_not_the_average_user():
    """At the horizon an along error counts a fifth more than on average (root of 104/72)."""
    budget = range_budget(design(ephemeris=(0, 1, 1)), [0.0])
    average = np.sqrt(2 * average_weights(ORBIT, R).across2)
    assert budget.orbit[0] / average == pytest.approx(1.2, abs=0.01)


def test_the_budget_is_the_variance_along_the_line_of_sight():
    d = design(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=1.0)
    elevation = np.radians([5.0, 40.0, 90.0])
    b = range_budget(d, elevation)
    eta = np.arcsin(R * np.cos(elevation) / ORBIT)
    turn = np.linspace(0, 2 * np.pi, 361)[:-1]
    for k, e in enumerate(eta):
        lines = np.stack(
            [np.full(360, np.cos(e)), np.sin(e) * np.cos(turn), np.sin(e) * np.sin(turn)], axis=1
        )
        assert b.orbit[k] == pytest.approx(np.sqrt(((lines * [2, 8, 5]) ** 2).sum(1).mean()))
    assert b.clock == pytest.approx([3, 3, 3])
    assert b.receiver == pytest.approx(0.5 + 0.5 / np.sin(elevation))
    assert b.total**2 == pytest.approx(b.clock**2 + b.orbit**2 + b.receiver**2 + b.ionosphere**2)


def test_changing_the_clock_changes_the_total_by_its_own_share():
    base = {"ephemeris": (2, 8, 5), "receiver": Receiver(0.5), "update": 6 * 3600.0}
    one, two = (range_budget(design(clock=Clock(white=w), **base), [1.0]) for w in (1e-11, 3e-11))
    assert two.clock[0] == pytest.approx(3 * one.clock[0])
    assert two.total[0] ** 2 - one.total[0] ** 2 == pytest.approx(8 * one.clock[0] ** 2)


def test_ages_are_averaged_or_the_worst_is_taken():
    made = design(
        clock=Clock(white=1e-11), clock_sigma=1, update=7200.0,
        ephemeris=(2, 8, 5), ephemeris_rate=(1e-4, 2e-4, 3e-4),
    ).signal  # fmt: skip
    ages = (np.arange(1000) + 0.5) * 7.2
    mean = np.mean([aged_covariance(made, 1, a)[0] for a in ages], axis=0)
    assert mean_age_covariance(made, 1)[0] == pytest.approx(mean, rel=1e-5)
    worst = mean_age_covariance(replace(made, age="worst"), 1)[0]
    assert np.diag(worst)[:3] == pytest.approx([2.72**2, 9.44**2, 7.16**2])


def test_a_code_loop_has_the_noise_of_its_link():
    """Kaplan and Hegarty 2006, equation 5.16, at one distance, from C/N0 itself."""
    radio = Radio(("satellite", "station"), 2.2e9, 10.0, -20.0, 30.0)
    d = replace(design(receiver=Receiver(0.0, 0.0, 300.0, 2.0, 0.5, 0.01)), radios=(radio,))
    _, _, a, b = receiver_numbers(d)
    distance = 18e6
    loss = (4 * np.pi * distance * 2.2e9 / 299792458.0) ** 2
    cn0 = 10 ** (1.0 - 2.0) / BOLTZMANN.value / loss
    sigma = 300 * np.sqrt(2.0 * 0.5 / (2 * cn0) * (1 + 2 / (0.01 * cn0 * 1.5)))
    assert np.sqrt(a * distance**2 + b * distance**4) == pytest.approx(sigma)
    with pytest.raises(ArgumentError, match=r"add a \[\[link\]\]"):
        receiver_numbers(replace(d, radios=()))


def test_the_ionosphere():
    """2.5 m a TECU at 400 MHz, 0.08 m at 2.2 GHz; 3.5 times as much at the horizon."""
    assert zenith_delay(1.0, 4e8) == pytest.approx(2.5, abs=0.05)
    assert zenith_delay(1.0, 2.2e9) == pytest.approx(0.083, abs=0.0005)
    assert obliquity([0.0, np.pi / 2], R) == pytest.approx([3.475, 1.0], abs=0.005)
    assert range_budget(design(ionosphere=1.0, dual=True), [1.0]).ionosphere == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"ephemeris": (2, -8, 5)}, "ephemeris = -8: must be 0 or more"),
        ({"clock_sigma": -1}, "clock_m = -1"),
        ({"frequency": 0}, "frequency = 0 Hz: must be above 0"),
        ({"age": "old"}, "age = 'old': allowed mean, worst"),
        ({"clock_sigma": 1, "covariance": (np.eye(4).tolist(),)}, "keep one of them"),
        ({"covariance": (np.eye(3).tolist(),)}, "must be 4 by 4 finite numbers"),
        ({"covariance": ((-np.eye(4)).tolist(),)}, r"covariance_m2\[1\]: is no covariance"),
    ],
)
def test_what_no_signal_can_be(given, message):
    with pytest.raises(ArgumentError, match=message):
        Signal(**given)


def test_what_no_receiver_can_be():
    with pytest.raises(ArgumentError, match="spacing = 2"):
        Receiver(spacing=2.0)
    with pytest.raises(ArgumentError, match="2 matrices for 3 satellites"):
        Signal(covariance=(np.eye(4).tolist(),) * 2).of_satellites(3)
    assert Signal(covariance=(np.eye(4).tolist(),) * 3).of_satellites(3).shape == (3, 4, 4)

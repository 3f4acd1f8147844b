"""Clocks: published range errors, and the formulas against noise that is drawn."""

import math

import numpy as np
import pytest

from compass.bodies import SOLAR_DAY, SPEED_OF_LIGHT
from compass.clocks import CLOCK_NAMES, CLOCKS, PARAMETERS, Clock, clock_named
from compass.errors import ArgumentError

C = SPEED_OF_LIGHT.value
SPANS = (3600.0, SOLAR_DAY.value, 7 * SOLAR_DAY.value)


@pytest.mark.parametrize(
    ("name", "metres"),
    [
        # c tau sigma_y(tau) of the deviations that the registry's sources state, to their digits
        ("csac", (5.4, 27, 71)),
        ("mini-rafs", (0.18, 0.89, 2.4)),
        ("rafs", (0.035, 0.17, 0.45)),
        ("passive-maser", (0.012, 0.31, 2.1)),
        ("dsac", (0.011, 0.053, 0.14)),
    ],
)
def test_range_errors_after_an_hour_a_sol_and_seven(name, metres):
    clock = clock_named(name)
    for tau, expected in zip(SPANS, metres, strict=True):
        # half a unit of two digits, of the metres and (1.9e-12, say) of the deviation
        half = 0.5 * 10.0 ** (math.floor(math.log10(expected)) - 1) + 0.026 * expected
        assert C * tau * clock.deviation(tau) == pytest.approx(expected, abs=half)


def test_aging_is_named_apart_and_outruns_the_noise():
    """1e-13 a day left in is 67 m after seven sols, where the rubidium's noise says 0.45."""
    aging = Clock(drift_per_day=1e-13)
    assert math.sqrt(aging.variance(SPANS[2])) == pytest.approx(67.0, abs=0.05)


def test_flicker_predicts_worse_than_its_floor_by_the_root_of_the_logarithm_of_two():
    flicker = Clock(flicker=1e-14)
    assert math.sqrt(flicker.variance(1e4)) == pytest.approx(C * 1e-10 / math.sqrt(math.log(2)))


def test_white_and_walking_frequency_are_what_drawn_clocks_do():
    """10,000 clocks, time the sum of frequencies; a variance from them is known to 1.4 %."""
    rng, steps, dt = np.random.default_rng(5), 200, 60.0
    white = rng.standard_normal((10_000, steps)) * 1e-11 / math.sqrt(dt)
    time = (white * dt).sum(axis=1)
    assert np.var(C * time) == pytest.approx(Clock(white=1e-11).variance(steps * dt), rel=0.06)
    # a frequency that walks with variance q dt a step has the Allan variance q tau/3
    q = 3 * 1e-15**2
    walk = np.cumsum(rng.standard_normal((10_000, steps)) * math.sqrt(q * dt), axis=1)
    time = (walk * dt).sum(axis=1)
    assert np.var(C * time) == pytest.approx(Clock(walk=1e-15).variance(steps * dt), rel=0.06)


def test_the_mean_over_ages_is_the_integral():
    clock = Clock("x", 1e-12, 1e-14, 1e-17, 1e-13, 1e-14)
    ages = (np.arange(4000) + 0.5) / 4000 * 2e5
    assert clock.mean_variance(2e5) == pytest.approx(clock.variance(ages).mean(), rel=1e-6)


def test_every_clock_of_the_registry_has_numbers_and_a_source():
    for clock in CLOCKS:
        assert any(getattr(clock, p) for p in PARAMETERS) and len(clock.source) > 20
        assert clock_named(clock.name) == clock
    changed = clock_named("rafs", drift_per_day=1e-13)
    assert (changed.white, changed.drift_per_day) == (1.9e-12, 1e-13)
    assert clock_named("rafs").title == "RAFS"
    # whose numbers are not those of the name is not called by the name alone
    assert changed.title == "RAFS (drift_per_day 1e-13)"
    assert Clock(white=2e-12, walk=1e-17).title == "given (white 2e-12, walk 1e-17)"


def test_a_wrong_name_gets_the_right_ones():
    with pytest.raises(ArgumentError, match="did you mean rafs"):
        clock_named("raf")
    with pytest.raises(ArgumentError, match=", ".join(CLOCK_NAMES)):
        clock_named("sundial")
    with pytest.raises(ArgumentError, match="has no parameters"):
        Clock("mine")
    with pytest.raises(ArgumentError, match="white = -1e-12: allowed 0"):
        Clock(white=-1e-12)

"""Plasma, blackout and arrivals: published values, limits, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.entry import radio
from compass.errors import ArgumentError

#: n_c with which the check values of the arrival probability were computed: the printed one.
PRINTED = 1.9941e15


def test_critical_density_is_where_the_plasma_frequency_is_the_link_s():
    n = radio.critical_density()
    assert n == pytest.approx(1.99464412e15, rel=3e-9)  # CODATA 2022 against 2018
    assert radio.plasma_frequency(n) == pytest.approx(401e6, rel=1e-14)
    assert radio.published_critical_density() == pytest.approx(1.9941e9, rel=3e-5)  # per cm^3


def test_plasma_frequency_in_the_field_s_rule_of_thumb():
    # f_p [Hz] = 8.98 sqrt(n [1/m^3]), three digits
    assert radio.plasma_frequency(1e16) == pytest.approx(8.98 * np.sqrt(1e16), rel=2e-4)


def test_attenuation_of_the_check_case():
    # the check value 146.242979 was computed with the constant cut to 54.575
    value = float(radio.attenuation(1e16))
    exact = 40 * np.pi * np.log10(np.e)
    assert exact == pytest.approx(54.57505, abs=5e-6)
    assert value * 54.575 / exact == pytest.approx(146.242979, abs=5e-7)


def test_attenuation_is_that_of_an_evanescent_wave():
    # field exp(-2 pi / lambda sqrt(f_p^2/f^2 - 1) z): 20 log10 of it over a metre
    n = 3e15
    ratio = radio.plasma_frequency(n) / 401e6
    k = 2 * np.pi * 401e6 / radio.LIGHT_SPEED.value * np.sqrt(ratio**2 - 1)
    assert radio.attenuation(n) == pytest.approx(-20 * np.log10(np.exp(-k)), rel=1e-12)
    assert radio.attenuation(radio.critical_density() * (1 - 1e-9)) == 0.0


def test_arrival_probability_of_the_check_cases():
    beta = radio.arrival_probability([5e14, 1.5e15], blackout=PRINTED)
    np.testing.assert_allclose(beta, [0.787525973501, 1.00391218956e-4], rtol=1e-11)


@given(st.lists(st.floats(0, 1e17), min_size=2, max_size=20))
def test_more_electrons_never_help(densities):
    n = np.sort(densities)
    beta = radio.arrival_probability(n)
    assert np.all(np.diff(beta) <= 0)
    assert np.all((beta >= 1e-8 * (1 - 1e-12)) & (beta <= 1))
    assert np.all(beta[n <= 3.08e14] == 1)


def test_brownout_is_a_rayleigh_survival_function():
    from scipy.stats import rayleigh

    n = np.linspace(3.08e14, 1.99e15, 7)
    scale = (radio.critical_density() - 3.08e14) / np.sqrt(-2 * np.log(1e-8))
    assert scale / 1e14 == pytest.approx(2.78, abs=0.005)
    expected = rayleigh(loc=3.08e14, scale=scale).sf(n)
    np.testing.assert_allclose(radio.arrival_probability(n), expected, rtol=1e-9)


def test_surrogate_is_the_printed_power_law():
    n = radio.WAKE(2e-4, 4000.0)
    expected = np.exp(22.5284523533) * 2.0**0.9698219421 * 0.8**7.6641503307 * 1e6
    assert n == pytest.approx(expected, rel=1e-13)


def test_any_model_will_do():
    altitude, rho, v = np.array([40e3, 50e3]), np.array([1e-4, 5e-5]), np.array([5e3, 5.5e3])
    doubled = radio.electron_density(lambda d, s: 2 * radio.WAKE(d, s), altitude, rho, v)
    np.testing.assert_allclose(doubled, 2 * radio.electron_density(radio.WAKE, altitude, rho, v))
    table = radio.ElectronTable((30e3, 50e3), (1e16, 1e14))
    found = radio.electron_density(table, altitude, rho, v)
    np.testing.assert_allclose(found, [1e15, 1e14], rtol=1e-12)  # log-linear: the geometric mean


def test_crossings_are_exact_on_an_exponential():
    t = np.arange(0.0, 10.0, 1.0)
    values = np.exp(-((t - 5.2) ** 2))
    # log-linear between samples of a parabola in the logarithm: off by h^2/8 of curvature 2 at most
    found = radio.crossing_times(t, values, np.exp(-4.0))
    np.testing.assert_allclose(found, [3.2, 7.2], atol=0.25 / 4)
    np.testing.assert_allclose(radio.crossing_times(t, np.exp(-t), np.exp(-3.3)), [3.3], rtol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: radio.check_probabilities([0.5, 1.2]), "arrival probability = 1.2"),
        (lambda: radio.check_probabilities([np.nan]), "arrival probability = nan"),
        (lambda: radio.arrival_probability(1.0, in_blackout=0.0), "above 0 to 1"),
        (lambda: radio.arrival_probability(1.0, brownout=3e15), "below the second"),
        (lambda: radio.ElectronTable((1.0, 3.0, 2.0), (1e9, 1e9, 1e9)), "altitude 2 m after 3 m"),
        (lambda: radio.ElectronTable((1.0, 2.0), (1e9,)), "as many of each"),
        (lambda: radio.ElectronTable((1.0, 2.0), (1e9, 0.0)), "must be positive"),
        (lambda: radio.electron_density(lambda d, s: -d, [1.0], [1.0], [1.0]), "0 or more"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()

"""Fisher information: closed forms against search, identities and the paper's Table 1."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.entry.best_directions import best_directions_found
from compass.entry.fisher import (
    TIGHT_CONE,
    best_determinant,
    best_directions,
    best_eigenvalues,
    best_rate_determinant,
    position_variance_bound,
    range_information,
    rate_information,
    two_beacon_eigenvalues,
)
from compass.errors import ArgumentError

TABLE_1 = {3: "1.0000", 4: "2.3704", 5: "4.6296", 6: "8.0000", 7: "12.7037", 8: "18.9630"}


@pytest.mark.parametrize("count", TABLE_1)
def test_table_1(count):
    sigma = np.ones(count)
    assert best_determinant(sigma) == pytest.approx(float(TABLE_1[count]), abs=5e-5)
    assert best_determinant(sigma) == pytest.approx((count / 3) ** 3, rel=1e-14)
    information = range_information(best_directions(count), 1.0)
    np.testing.assert_allclose(information, count / 3 * np.eye(3), atol=1e-14)
    assert best_directions_found(sigma).value == pytest.approx((count / 3) ** 3, rel=1e-9)


@pytest.mark.parametrize(("weights", "expected"), [((2, 1, 1, 1), 4.5), ((5, 1, 1, 1), 11.25)])
def test_unequal_noise(weights, expected):
    sigma = np.array(weights, float) ** -0.5
    assert best_determinant(sigma) == pytest.approx(expected, rel=1e-14)
    assert best_directions_found(sigma).value == pytest.approx(expected, rel=1e-9)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(0.1, 10.0), min_size=3, max_size=9), st.integers(0, 2**31))
def test_no_directions_beat_the_closed_form(sigmas, seed):
    n = np.random.default_rng(seed).normal(size=(len(sigmas), 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    information = range_information(n, sigmas)
    assert np.linalg.det(information) <= best_determinant(sigmas) * (1 + 1e-9)
    best = best_eigenvalues(sigmas)
    assert best.sum() == pytest.approx(np.trace(information))
    if np.linalg.cond(information) < 1e10:
        trace = np.trace(np.linalg.inv(information))
        assert trace >= (1 / best).sum() * (1 - 1e-6)
        assert trace >= position_variance_bound(sigmas) * (1 - 1e-6)
        # as printed (eqs. 28, 32, 35, 41 of Yu et al. 2018): true, but a third of it
        assert position_variance_bound(sigmas) > 3 / np.sum(np.array(sigmas) ** -2.0)


def test_too_few_beacons_have_no_bound():
    assert position_variance_bound([1.0, 1.0]) == float("inf")
    assert best_determinant([1.0, 1.0]) == 0.0
    assert best_rate_determinant(2, 1.0, 1.0, 1.0) == 0.0
    np.testing.assert_allclose(best_eigenvalues([1.0]), [1.0, 0.0, 0.0])
    with pytest.raises(ArgumentError, match="at least 3 beacons determine a position"):
        best_directions(2)
    with pytest.raises(ArgumentError, match="2 beacons; the determinant is zero"):
        best_directions_found([1.0, 1.0])


@pytest.mark.parametrize("sigma", [0.0, -1.0, np.nan, np.inf])
def test_noise_must_be_positive_and_finite(sigma):
    with pytest.raises(ArgumentError, match="measurement noise must be positive"):
        range_information([[1.0, 0, 0]], sigma)


@settings(deadline=None, max_examples=40)
@given(st.floats(0.1, 10), st.floats(0.1, 10), st.floats(0.01, 3.1))
def test_two_beacons(sigma_1, sigma_2, angle):
    n = [[1.0, 0, 0], [np.cos(angle), np.sin(angle), 0]]
    exact = np.linalg.eigvalsh(range_information(n, [sigma_1, sigma_2]))[::-1]
    found = two_beacon_eigenvalues(sigma_1, sigma_2, angle)
    np.testing.assert_allclose(found, exact[:2], rtol=1e-9, atol=1e-12 * exact[0])


def test_rate_information_is_the_gradient_of_the_range_rate():
    rng = np.random.default_rng(2)
    b, r, w = rng.normal(size=(4, 3)) * 1e6, rng.normal(size=3) * 1e6, rng.normal(size=3) * 1e3
    line = r - b
    distance = np.linalg.norm(line, axis=1)
    n = line / distance[:, None]

    def rates(at):
        d = at - b
        return (d @ w) / np.linalg.norm(d, axis=1)

    h = 10.0
    gradient = np.array([(rates(r + h * e) - rates(r - h * e)) / (2 * h) for e in np.eye(3)]).T
    found = rate_information(n, distance, w, 0.1)
    np.testing.assert_allclose(found, gradient.T @ gradient / 0.01, rtol=1e-6)


@pytest.mark.parametrize("count", [3, 5, 8])
def test_best_range_rate_geometry(count):
    v, distance, sigma = 5000.0, 8e5, 0.2
    n = best_directions(count)  # on the cone about z at 54.7356 deg
    assert np.degrees(TIGHT_CONE) == pytest.approx(54.7356, abs=5e-5)
    reached = np.linalg.det(rate_information(n, np.full(count, distance), [0, 0, v], sigma))
    assert reached == pytest.approx(best_rate_determinant(count, sigma, v, distance), rel=1e-12)
    rng = np.random.default_rng(count)
    for _ in range(200):
        other = rng.normal(size=(count, 3))
        other /= np.linalg.norm(other, axis=1, keepdims=True)
        information = rate_information(other, np.full(count, distance), [0, 0, v], sigma)
        assert np.linalg.det(information) <= reached
        # eq. 47 mended: the trace of the information is at most the sum of (v / R sigma)^2
        assert np.trace(np.linalg.inv(information)) >= 9 * (sigma * distance / v) ** 2 / count

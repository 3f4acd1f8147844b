"""Covariance intersection: never overconfident, equal to Stone Soup's, bad input refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.entry.intersection import covariance_intersection, intersection_weights
from compass.errors import ArgumentError


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 100_000), st.integers(2, 4), st.integers(1, 4))
def test_never_overconfident_for_any_cross_correlation(seed, m, n):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((m * n, m * n)) * 10.0 ** rng.uniform(-1, 1, (m * n, 1))
    joint = root @ root.T + 1e-6 * np.eye(m * n)  # errors of all estimates, any correlation
    own = np.stack([joint[k * n : k * n + n, k * n : k * n + n] for k in range(m)])
    for rule in ("determinant", "trace", "fast", "equal"):
        weights = intersection_weights(own, rule)
        states = rng.standard_normal((m, n))
        fused, claimed = covariance_intersection(states, own, weights)
        gains = np.concatenate(
            [w * claimed @ np.linalg.inv(p) for w, p in zip(weights, own, strict=True)], axis=1
        )
        true = gains @ joint @ gains.T
        slack = np.linalg.eigvalsh(claimed - true).min()
        assert slack >= -1e-9 * np.linalg.eigvalsh(claimed).max()
        expected = gains @ states.ravel()
        np.testing.assert_allclose(fused, expected, rtol=0, atol=1e-7 * np.abs(states).max())


def test_fusion_is_stone_soup_s():
    from stonesoup.mixturereducer.gaussianmixture import CovarianceIntersection
    from stonesoup.types.state import GaussianState

    rng = np.random.default_rng(5)
    roots = rng.standard_normal((2, 3, 3))
    covariances = roots @ roots.transpose(0, 2, 1) + np.eye(3)
    states = rng.standard_normal((2, 3))
    for omega in (0.3, 0.5, 0.9):
        theirs = CovarianceIntersection().merge_components(
            *(GaussianState(x[:, None], p) for x, p in zip(states, covariances, strict=True)),
            weights=[omega, 1 - omega],
        )
        x, p = covariance_intersection(states, covariances, [omega, 1 - omega])
        np.testing.assert_allclose(x, np.asarray(theirs.state_vector, float)[:, 0], rtol=1e-12)
        np.testing.assert_allclose(p, np.asarray(theirs.covar, float), rtol=1e-12)


def test_weights_depend_on_units_except_by_the_determinant():
    covariances = np.stack([np.diag([1.0, 4.0]), np.diag([4.0, 1.0])])
    units = np.array([1.0, 100.0])
    in_other_units = covariances * np.outer(units, units)
    for rule, same in (("determinant", True), ("trace", False), ("fast", False)):
        plain = intersection_weights(covariances, rule)
        assert np.allclose(plain, intersection_weights(in_other_units, rule), atol=1e-6) == same
        scaled = intersection_weights(in_other_units, rule, units)
        np.testing.assert_allclose(plain, scaled, atol=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: intersection_weights([np.eye(2), np.diag([1.0, 0.0])]), "covariance 2 of 2"),
        (lambda: intersection_weights(np.eye(2)), "must be"),
        (lambda: intersection_weights([np.eye(2)], "best"), "weighting = 'best'"),
        (lambda: intersection_weights([np.eye(2)], "fast", [1.0, -1.0]), "positive sizes"),
        (lambda: covariance_intersection(np.zeros((2, 2)), [np.eye(2)] * 2, [0, 0]), "sum 1"),
        (lambda: covariance_intersection(np.zeros((2, 2)), [np.eye(2)] * 2, [2, -1]), "negative"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()

"""Fusion weights: exact values, optimality against SciPy, and the rules every weight obeys."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from compass.core.entry.weights import (
    equal_weights,
    fast_weights,
    infinity_norm,
    make_scratch,
    optimal_weights,
)

#: Information matrices of the exact check, and of two sensors.
FOUR = np.array(
    [
        [[4.0, 0.0], [0.0, 1.0]],
        [[1.0, 0.5], [0.5, 2.0]],
        [[0.5, 0.0], [0.0, 3.0]],
        [[2.0, -0.3], [-0.3, 0.7]],
    ]
)
TWO = np.array([[[4.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 2.0]]])


def fast(information, alive=None):
    m, n = information.shape[:2]
    weights, total = np.empty(m), np.empty((n, n))
    fast_weights(information, np.ones(m, bool) if alive is None else alive, weights, total)
    return weights


def optimal(information, by_trace=False, alive=None):
    m, n = information.shape[:2]
    weights, work = np.empty(m), make_scratch(n, m)
    here = np.ones(m, bool) if alive is None else alive
    assert optimal_weights(information, here, by_trace, weights, work)
    return weights


def random_information(seed, m, n):
    rng = np.random.default_rng(seed)
    roots = rng.standard_normal((m, n, n)) * 10.0 ** rng.uniform(-2, 2, (m, 1, n))
    return roots @ roots.transpose(0, 2, 1) + 1e-3 * np.eye(n)


def test_fast_weights_of_the_check_case_are_exact():
    np.testing.assert_allclose(fast(FOUR), np.array([29, 17, 17.5, 17.5]) / 81, rtol=1e-15)
    assert fast(TWO)[0] == pytest.approx(0.7, rel=1e-15)


def test_determinant_weight_of_the_check_case_is_five_sixths():
    # det(w diag(4,1) + (1-w) diag(1,2)) = (1 + 3w)(2 - w); the stop leaves at most 1e-10 nats,
    # so by the curvature -27/49 there at most sqrt(2e-10 * 49/27) = 1.9e-5, in practice far less
    np.testing.assert_allclose(optimal(TWO), [5 / 6, 1 / 6], atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 5), st.integers(1, 6))
def test_weights_are_never_negative_and_sum_to_one(seed, m, n):
    information = random_information(seed, m, n)
    for weights in (fast(information), optimal(information), optimal(information, by_trace=True)):
        assert np.all(weights >= 0)
        assert weights.sum() == pytest.approx(1.0, abs=1e-14)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_no_other_weights_do_better(seed, by_trace):
    information = random_information(seed, 4, 3)

    def loss(free):
        w = np.abs(free) / np.abs(free).sum()
        y = np.einsum("i,iab->ab", w, information)
        p = np.linalg.inv(y)
        return np.log(np.trace(p)) if by_trace else -np.linalg.slogdet(y)[1]

    best = min(
        minimize(loss, start, method="Nelder-Mead", options={"fatol": 1e-12, "xatol": 1e-9}).fun
        for start in (np.ones(4), optimal(information, by_trace) + 1e-3)
    )
    assert loss(optimal(information, by_trace)) <= best + 1e-9


def test_the_dead_take_no_part():
    alive = np.array([True, False, True, False])
    for weights in (fast(FOUR, alive), optimal(FOUR, alive=alive), optimal(FOUR, True, alive)):
        assert not weights[~alive].any()
        assert weights.sum() == pytest.approx(1.0)
    shared = np.empty(4)
    equal_weights(alive, shared)
    np.testing.assert_array_equal(shared, [0.5, 0, 0.5, 0])


def test_twins_share_alike():
    twins = np.stack([np.eye(3), np.eye(3)])
    np.testing.assert_allclose(optimal(twins), 0.5, atol=1e-9)


def test_a_useless_estimate_is_left_out():
    information = np.stack([np.eye(2) * 1e6, np.eye(2)])
    np.testing.assert_allclose(optimal(information), [1.0, 0.0], atol=1e-12)


def test_indefinite_information_has_no_weights():
    nothing = np.zeros((2, 2, 2))
    assert not optimal_weights(nothing, np.ones(2, bool), False, np.empty(2), make_scratch(2, 2))
    assert not optimal_weights(nothing, np.ones(2, bool), True, np.empty(2), make_scratch(2, 2))


def test_infinity_norm_is_the_largest_row_sum():
    a, b = FOUR[1], FOUR[3]
    assert infinity_norm(a, b, -1.0) == pytest.approx(np.abs(a - b).sum(axis=1).max())

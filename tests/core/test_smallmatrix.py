"""Small matrices against NumPy, over wildly mixed units."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.smallmatrix import (
    cholesky,
    cholesky_solve,
    invert,
    log_determinant,
    matmul,
    solve_general,
)

UNITS = np.array([1e3, 3e-4, 3e-4, 10.0, 3e-3, 3e-3, 0.1, 0.02])


def random_covariance(seed, n=8):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((n, n)) + n * np.eye(n) * 0.3
    return root @ root.T


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 8))
def test_invert_agrees_with_numpy_in_any_units(seed, n):
    plain = random_covariance(seed, n)
    a = plain * np.outer(UNITS[:n], UNITS[:n])
    out, work = np.empty((n, n)), np.empty((n, n))
    assert invert(a, out, work)
    expected = np.linalg.inv(plain) / np.outer(UNITS[:n], UNITS[:n])
    # relative to the diagonal: condition number times rounding, whatever the units
    allowed = 1e-14 * n * np.linalg.cond(plain)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs(out - expected).max(initial=0, where=scale > 0) <= (allowed * scale).max()
    assert np.all(np.abs(out - expected) <= allowed * scale)
    np.testing.assert_array_equal(out, out.T)


def test_cholesky_solves_and_gives_the_determinant():
    a = random_covariance(3)
    factor = np.zeros((8, 8))
    assert cholesky(a, factor)
    np.testing.assert_allclose(np.tril(factor), np.linalg.cholesky(a), rtol=1e-12, atol=1e-14)
    b = np.arange(8.0)
    cholesky_solve(factor, b)
    np.testing.assert_allclose(a @ b, np.arange(8.0), atol=1e-11)
    assert log_determinant(factor) == pytest.approx(np.linalg.slogdet(a)[1], rel=1e-13)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_what_is_not_positive_definite_is_refused(bad):
    a = np.eye(3)
    a[1, 1] = bad
    assert not cholesky(a, np.empty((3, 3)))
    assert not invert(a, np.empty((3, 3)), np.empty((3, 3)))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000))
def test_solve_general_pivots(seed):
    rng = np.random.default_rng(seed)
    a = rng.standard_normal((5, 5))
    a[0, 0] = 0.0
    b = rng.standard_normal((5, 2))
    expected = np.linalg.solve(a, b)
    x = b.copy()
    assert solve_general(a.copy(), x)
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-14 * np.linalg.cond(a) * 10)


def test_solve_general_refuses_a_singular_matrix():
    assert not solve_general(np.zeros((2, 2)), np.eye(2))


def test_matmul_is_the_product():
    rng = np.random.default_rng(0)
    a, b, out = rng.standard_normal((4, 4)), rng.standard_normal((4, 4)), np.empty((4, 4))
    matmul(a, b, out)
    np.testing.assert_allclose(out, a @ b, rtol=0, atol=1e-14)

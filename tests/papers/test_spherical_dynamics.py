"""Entry dynamics against the companions' check values, differences and limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.entry.rates import CENTRIFUGAL, CORIOLIS, SWAPPED
from compass.core.papers.spherical import (
    entry_jacobian,
    entry_rates,
    rk4_step,
    rk4_step_transition,
)

OMEGA = 7.088218e-5
X = np.array([3450e3, 0.1, 0.2, 5000.0, -0.2, 0.3, np.log(2e-4), 0.156])
TABLE = [3.40e6, 3.42e6, 3.46e6, 3.52e6, 4.9, 2.4, -3.1, -12.0]


def parameters(omega=0.0, rotation=CORIOLIS, bank=0.3, table=()):
    return np.array([4.282829e13, 3437.2e3, 7500.0, 0.016, bank, omega, rotation, *table])


def rates(x, p):
    out = np.empty(8)
    entry_rates(x, p, out)
    return out


def jacobian(x, p):
    out = np.empty((8, 8))
    entry_jacobian(x, p, out)
    return out


def test_rates_at_the_companion_papers_check_point():
    published = [-993.346653975, 4.28290154582e-4, 1.35694690375e-3, -6.54392346873]
    published += [9.31438500949e-4, 1.53377042778e-4, 0.0, 0.0]
    np.testing.assert_allclose(rates(X, parameters()), published, rtol=1e-11)


def test_jacobian_at_the_companion_papers_check_point():
    found = jacobian(X, parameters())
    assert found[3, 0] == pytest.approx(9.67423903577e-4, rel=1e-11)
    assert found[4, 3] == pytest.approx(4.68410451646e-7, rel=1e-11)
    assert found[5, 2] == pytest.approx(4.37001081626e-4, rel=1e-11)


def test_rk4_reaches_the_companion_papers_state_at_100_s():
    x = np.array(
        [3518.2e3, 0.0, 0.0, 5515.0, np.radians(-11.8), np.radians(5.156), np.log(2e-4), 0.156]
    )
    p = parameters(bank=0.0)
    for _ in range(1000):
        rk4_step(x, p, 0.1, x)
    found = [x[0], x[2], x[3], x[4]]
    # 0.1 s steps: the RK4 error is below the last printed digit (1e-5 m)
    np.testing.assert_allclose(
        found, [3433267.35809352, 0.153831568353, 4637.78559565, -0.0876876241801], rtol=2e-11
    )


@pytest.mark.parametrize("table", [(), TABLE])
@pytest.mark.parametrize("rotation", [CORIOLIS, CENTRIFUGAL, SWAPPED])
@settings(deadline=None, max_examples=20)
@given(
    st.tuples(
        st.floats(3.405e6, 3.515e6).filter(lambda r: min(abs(r - 3.42e6), abs(r - 3.46e6)) > 50),
        st.floats(-3.0, 3.0),
        st.floats(-1.2, 1.2),
        st.floats(300.0, 7000.0),
        st.floats(-1.2, 1.2),
        st.floats(-3.0, 3.0),
        st.floats(-9.0, -8.0),
        st.floats(-0.5, 0.5),
    )
)
def test_jacobian_is_the_derivative_of_the_rates(table, rotation, state):
    x, p = np.array(state), parameters(OMEGA, rotation, table=table)
    exact = jacobian(x, p)
    steps = np.array([20.0, 1e-4, 1e-4, 0.05, 1e-4, 1e-4, 1e-4, 1e-4])
    for k, h in enumerate(steps):
        e = h * np.eye(8)[k]
        # Richardson's extrapolation of central differences: error of order h^4
        wide = (rates(x + 2 * e, p) - rates(x - 2 * e, p)) / (4 * h)
        narrow = (rates(x + e, p) - rates(x - e, p)) / (2 * h)
        differences = (4 * narrow - wide) / 3
        scale = np.abs(rates(x, p)) / h  # cancellation: eps times the rate over the step
        assert np.all(
            np.abs(exact[:, k] - differences) <= 1e-6 * np.abs(exact[:, k]) + 3e-15 * scale + 1e-18
        )


@pytest.mark.parametrize("dt", [0.1, 1.0])
@pytest.mark.parametrize("rotation", [CORIOLIS, CENTRIFUGAL, SWAPPED])
def test_transition_is_the_derivative_of_the_step(dt, rotation):
    p = parameters(OMEGA, rotation)
    after, plain, phi = np.empty(8), np.empty(8), np.empty((8, 8))
    rk4_step_transition(X, p, dt, after, phi)
    rk4_step(X, p, dt, plain)
    np.testing.assert_array_equal(after[6:], X[6:])
    np.testing.assert_allclose(after, plain, rtol=1e-15)
    steps = np.array([10.0, 1e-5, 1e-5, 0.05, 1e-5, 1e-5, 1e-5, 1e-5])
    low, high = np.empty(8), np.empty(8)
    for k, h in enumerate(steps):
        rk4_step(X - h * np.eye(8)[k], p, dt, low)
        rk4_step(X + h * np.eye(8)[k], p, dt, high)
        differences = (high - low) / (2 * h)
        bound = 1e-6 * np.abs(phi[:, k]).max() + 4e-16 * np.abs(X) / h
        assert np.all(np.abs(phi[:, k] - differences) <= bound)


def test_a_table_of_the_exponential_gives_the_exponential():
    radii = np.linspace(3.40e6, 3.52e6, 25)
    table = np.concatenate([radii, (3437.2e3 - radii) / 7500.0])
    for r in (3.39e6, 3.40e6, 3.4333e6, 3.52e6, 3.53e6):
        x = X.copy()
        x[0] = r
        np.testing.assert_allclose(
            rates(x, parameters(table=table)), rates(x, parameters()), rtol=1e-11
        )


def test_turning_the_planet_changes_nothing_without_rotation():
    """The longitude is cyclic: rates do not depend on it; mirror symmetry north-south holds."""
    p = parameters(bank=0.0)
    mirrored = X * np.array([1, 1, -1, 1, 1, 1, 1, 1.0])
    mirrored[5] = np.pi - X[5]
    expected = rates(X, p) * np.array([1, 1, -1, 1, 1, -1, 1, 1.0])
    np.testing.assert_allclose(rates(mirrored, p), expected, rtol=1e-13)

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from compass.core.kepler import eccentric_anomaly, elliptic_states


@given(st.floats(-50.0, 50.0), st.floats(0.0, 0.999999))
def test_solves_keplers_equation(m, e):
    big_e = eccentric_anomaly(m, e)
    # the residual is rounded like the largest term; a unit in the last place of M is 7e-15
    assert big_e - e * math.sin(big_e) == pytest.approx(m, abs=4e-14)


@pytest.mark.parametrize("e", [0.0, 0.3, 0.9, 0.9999])
def test_ends_of_a_revolution_are_exact(e):
    assert eccentric_anomaly(0.0, e) == 0.0
    assert eccentric_anomaly(math.pi, e) == pytest.approx(math.pi, abs=1e-15)


def test_two_body_motion_equals_integration():
    gm, a, e = 4.2828e13, 8e6, 0.5
    n = math.sqrt(gm / a**3)
    args = [np.array([v]) for v in (a, e, 1.1, 0.7, 2.0, 0.3, 0.0, 0.0, n)]
    times = np.linspace(0, 20000, 7)
    r, v = elliptic_states(*args, times)

    def pull(_, y):
        return np.concatenate([y[3:], -gm * y[:3] / np.linalg.norm(y[:3]) ** 3])

    start = np.concatenate([r[0, 0], v[0, 0]])
    exact = solve_ivp(pull, (0, 20000), start, "DOP853", times, rtol=1e-13, atol=1e-6).y.T
    # the integrator's own error at 1e-13 a step over some hundred steps: below a millimetre
    np.testing.assert_allclose(r[0], exact[:, :3], rtol=0, atol=2e-2)
    np.testing.assert_allclose(v[0], exact[:, 3:], rtol=0, atol=2e-5)


def test_velocity_is_the_derivative_of_the_drifting_position():
    args = [np.array([v]) for v in (8e6, 0.3, 1.1, 0.7, 2.0, 0.3, 1e-6, -2e-6, 3e-4)]
    h = 1.0
    r, v = elliptic_states(*args, np.array([100.0 - h, 100.0, 100.0 + h]))
    numeric = (r[0, 2] - r[0, 0]) / (2 * h)
    # central difference: h^2/6 times the third derivative, about n^3 a = 2e-4 m/s^3
    np.testing.assert_allclose(v[0, 1], numeric, rtol=0, atol=1e-3)

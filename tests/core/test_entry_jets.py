"""Jets against mpmath, one-sided Jacobi against mpmath and NumPy."""

import mpmath as mp
import numpy as np
import pytest

from compass.core import jets
from compass.core.entry.flow import rk4_step_transition
from compass.core.entry.rates import World
from compass.core.entry.series import flow_series, orbit_series, range_series
from compass.core.jacobi_svd import jacobi_svd
from compass.core.papers.spherical_geometry import cartesian, cartesian_jacobian, range_rows
from compass.entry.atmosphere import Atmosphere
from compass.entry.model import EntryModel
from compass.entry.vehicle import Vehicle
from compass.entry.views import cartesian_of, spherical_jacobian

ORDERS, DUALS = 6, 3


def random_series(seed, first):
    series = np.random.default_rng(seed).normal(size=(ORDERS, 1 + DUALS))
    series[0, 0] = first
    return series


def mpmath_series(function, *arguments):
    """Coefficients and gradients of a function of series, differentiated by mpmath."""
    with mp.workdps(40):
        out = np.empty((ORDERS, 1 + DUALS))

        def value(t, q, e):
            return function(
                *(
                    sum((mp.mpf(a[k, 0]) + (e * a[k, q] if q else 0)) * t**k for k in range(ORDERS))
                    for a in arguments
                )
            )

        out[:, 0] = [float(c) for c in mp.taylor(lambda t: value(t, 0, 0), 0, ORDERS - 1)]
        for q in range(1, 1 + DUALS):
            slope = lambda t, q=q: mp.diff(lambda e: value(t, q, e), 0)  # noqa: E731
            out[:, q] = [float(c) for c in mp.taylor(slope, 0, ORDERS - 1)]
    return out


def grown(kernel, *arguments, outputs=1):
    outs = [np.zeros((ORDERS, 1 + DUALS)) for _ in range(outputs)]
    for k in range(ORDERS):
        kernel(*arguments, k, *outs)
    return outs[0] if outputs == 1 else outs


A, B = random_series(1, 1.7), random_series(2, -0.8)


@pytest.mark.parametrize(
    ("kernel", "function", "arguments"),
    [
        (jets.multiply, lambda a, b: a * b, (A, B)),
        (jets.reciprocal, lambda b: 1 / b, (B,)),
        (jets.square_root, mp.sqrt, (A,)),
        (jets.exponential, mp.exp, (A,)),
    ],
)
def test_jets_equal_mpmath(kernel, function, arguments):
    exact = mpmath_series(function, *arguments)
    np.testing.assert_allclose(grown(kernel, *arguments), exact, rtol=1e-10, atol=1e-11)


STATE = np.array([3450e3, 0.1, 0.2, 5000.0, -0.2, 0.3, np.log(2e-4), 0.156])


TABLE = ((3.40e6, 3.42e6, 3.46e6, 3.52e6), (9e-3, 5e-3, 2e-4, 3e-6))
WINDS = ((3.40e6, 30.0, -20.0), (3.47e6, -50.0, 70.0), (3.52e6, 10.0, 20.0))


@pytest.mark.parametrize(
    ("rotation", "j2", "air"),
    [
        ("coriolis", 0.0, {}),
        ("published-coriolis", 0.0, {}),
        ("full", 1.96e-3, {"table_radius": TABLE[0], "table_density": TABLE[1], "winds": WINDS}),
    ],
)
def test_the_flow_series_is_the_flow(rotation, j2, air):
    """Summed over a second it meets small Runge-Kutta steps; its gradient, their transition."""
    model = EntryModel(
        Vehicle(0.016, 0.156), Atmosphere(2e-4, 3437.2e3, 7500.0, **air), rotation, 4.282829e13,
        3397.2e3, 7.088218e-5, j2,
    )  # fmt: skip
    p, c, s = model.flight_parameters(), np.cos(0.4), np.sin(0.4)
    x = np.concatenate([cartesian_of(STATE), [0.1, 0.156]])
    w = flow_series(x, p, c, s, 10, 8)
    after, whole, step = x[:6].copy(), np.eye(8), np.empty((6, 8))
    for _ in range(100):
        rk4_step_transition(after.copy(), World(p, 0.1, 0.156), c, s, 0.01, after, step)
        whole[:6] = step @ whole
    np.testing.assert_allclose(w[:6, :, 0].sum(axis=1), after, rtol=1e-12, atol=1e-8)
    found = w[:6, :, 1:].sum(axis=1)
    scale = np.abs(whole[:6]).max(axis=0)
    np.testing.assert_allclose(found / scale, whole[:6] / scale, atol=1e-10)


def test_the_orbit_series_is_two_body_motion_in_turning_axes():
    gm, omega = 4.282829e13, 7.088218e-5
    r = np.array([4.1e6, 2e5, -3e5])
    v = np.array([100.0, 3100.0, 400.0])
    spin = np.array([0, 0, omega])
    from compass.frames import mcmf_from_mci
    from compass.orbits import states_mci
    from compass.orbits.states import from_states

    orbit = from_states(r, v + np.cross(spin, r), gm=gm)
    exact = mcmf_from_mci(states_mci(orbit, [5.0])[0][0, 0], omega * 5.0)
    series = orbit_series(r, v, gm, omega, 8) @ 5.0 ** np.arange(8)
    np.testing.assert_allclose(series, exact, rtol=1e-12)


def test_range_series_starts_with_range_and_range_rate():
    model = EntryModel(Vehicle(0.016, 0.156), Atmosphere(2e-4, 3437.2e3, 7500.0))
    x = np.concatenate([cartesian_of(STATE), [0.0, 0.156]])
    w = flow_series(x, model.flight_parameters(), 1.0, 0.0, 4, 6)
    beacon, drift = np.array([3.3e6, 4.2e5, 1.35e6]), np.array([10.0, -20.0, 30.0])
    series = np.zeros((3, 4))
    series[:, 0], series[:, 1] = beacon, drift
    out = np.empty((4, 7))
    range_series(w[:3], series, out)
    c, jacobian, row, rate_row = np.empty(6), np.empty((6, 6)), np.empty(6), np.empty(6)
    cartesian(STATE, c)
    cartesian_jacobian(STATE, jacobian)
    distance, rate = range_rows(c, beacon, drift, jacobian, row, rate_row)
    # spec entry-fusion.md, exact check value 3
    assert distance == pytest.approx(672767.920257521, abs=1e-8)
    found = np.column_stack([out[:2, 0], out[:2, 1:] @ jacobian])
    np.testing.assert_allclose(found[0], [distance, *row], rtol=1e-12, atol=1e-9)
    # range rate = next coefficient; the velocity of the jet is that of the dynamics
    np.testing.assert_allclose(found[1], [rate, *rate_row], rtol=1e-11, atol=1e-9)


def test_states_of_numpy_are_those_of_the_kernels():
    rng, kernel = np.random.default_rng(3), (np.empty((20, 6)), np.empty((20, 6, 6)))
    low = [3.4e6, -np.pi, -1.5, 10.0, -1.5, -np.pi]
    states = rng.uniform(low, [3.6e6, np.pi, 1.5, 6e3, 1.5, np.pi], (20, 6))
    for k, state in enumerate(states):
        cartesian(state, kernel[0][k])
        cartesian_jacobian(state, kernel[1][k])
    found = cartesian_of(states)
    np.testing.assert_allclose(found, kernel[0], rtol=1e-12, atol=1e-9)
    scale = np.abs(kernel[1]).max(axis=(0, 2))[:, None]  # metres and metres per second
    assert np.abs((spherical_jacobian(found) - kernel[1]) / scale).max() < 1e-12


def test_cartesian_jacobian_is_the_derivative():
    jacobian = np.empty((6, 6))
    cartesian_jacobian(STATE, jacobian)
    for j, h in enumerate([100.0, 1e-5, 1e-5, 1.0, 1e-5, 1e-5]):
        e = h * np.eye(8)[j]
        differences = (cartesian_of(STATE + e) - cartesian_of(STATE - e)) / (2 * h)
        np.testing.assert_allclose(jacobian[:, j], differences, rtol=1e-7, atol=2e-9 / h * 3.5)


def singular_values(a):
    """Singular values of a matrix, zero rows put below those of a wide one."""
    m, n = np.shape(a)
    work = np.zeros((n, max(m, n)))
    work[:, :m] = np.transpose(a)
    values, vectors = np.empty(n), np.empty((n, n))
    jacobi_svd(work, values, vectors)
    return values


@pytest.mark.parametrize("spread", [0, 4, 10])
def test_small_singular_values_are_accurate_under_bad_column_scaling(spread):
    """Against 40 digits: relative accuracy of each value, where LAPACK's is lost."""
    a = np.random.default_rng(7).normal(size=(18, 6)) * 10.0 ** np.linspace(0, spread, 6)
    with mp.workdps(60):
        exact = np.array([float(s) for s in mp.svd_r(mp.matrix(a.tolist()), compute_uv=False)])
    np.testing.assert_allclose(singular_values(a), exact, rtol=2e-14)


def test_right_singular_vectors():
    a = np.random.default_rng(3).normal(size=(9, 6))
    values, vectors, work = np.empty(6), np.empty((6, 6)), a.T.copy()
    jacobi_svd(work, values, vectors)
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(6), atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(a @ vectors.T, axis=0), values, rtol=1e-14)
    np.testing.assert_allclose(values, np.linalg.svd(a, compute_uv=False), rtol=1e-13)


def test_a_wide_matrix_has_zero_singular_values():
    a = np.random.default_rng(3).normal(size=(2, 6))
    np.testing.assert_allclose(singular_values(a)[2:], 0.0, atol=1e-15)

"""Speed of the entry kernels against plain NumPy twins measured in the same run."""

import time

import numpy as np
import pytest

from compass.core.papers.spherical import entry_rates, rk4_step
from compass.core.papers.spherical_geometry import cartesian, cartesian_jacobian
from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import surface_beacons
from compass.entry.covariance import axes_covariance, linear_covariance
from compass.entry.filters import Filter
from compass.entry.model import EntryModel
from compass.entry.navigation import run_monte_carlo
from compass.entry.observability import observability
from compass.entry.schedule import Measurements
from compass.entry.trajectory import fly
from compass.entry.vehicle import Vehicle
from compass.papers.spherical import spherical_parameters

RADIUS = 3397.2e3


@pytest.fixture(scope="module")
def case():
    air = Atmosphere(2e-4, 3437.2e3, 7500.0)
    model = EntryModel(Vehicle(0.016, 0.156), air, "coriolis", 4.282829e13, RADIUS, 7.088218e-5)
    angles = np.radians([-89.872, -28.02, -11.8, 90 - 5.156])
    state = np.array([3518.2e3, angles[0], angles[1], 5515.0, angles[2], angles[3]])
    flight = fly(model, state, np.arange(241.0))
    lat, lon = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4]]).T
    return model, flight, surface_beacons(lat, lon, flight.times, planet_radius=RADIUS)


def plain_rates(x, p):
    """The equations of motion in plain NumPy and mathematics, rotation of first order."""
    r, _, lat, v, gamma, psi, log_density, kappa = x
    mu, r0, h, area, bank, omega, _ = p
    drag = 0.5 * np.exp(log_density + (r0 - r) / h) * area * v**2
    lift, g = kappa * drag, mu / r**2
    turn = np.sin(lat) - np.tan(gamma) * np.cos(psi) * np.cos(lat)
    return np.array(
        [
            v * np.sin(gamma),
            v * np.cos(gamma) * np.sin(psi) / (r * np.cos(lat)),
            v * np.cos(gamma) * np.cos(psi) / r,
            -drag - g * np.sin(gamma),
            (v / r - g / v) * np.cos(gamma)
            + lift * np.cos(bank) / v
            + 2 * omega * np.sin(psi) * np.cos(lat),
            v / r * np.sin(psi) * np.cos(gamma) * np.tan(lat)
            + lift * np.sin(bank) / (v * np.cos(gamma))
            + 2 * omega * turn,
            0.0,
            0.0,
        ]
    )


def plain_step(x, p, dt):
    k1 = plain_rates(x, p)
    k2 = plain_rates(x + dt / 2 * k1, p)
    k3 = plain_rates(x + dt / 2 * k2, p)
    k4 = plain_rates(x + dt * k3, p)
    return x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def plain_series(x, p, beacons, orders=6):
    """Lie derivatives by nested central differences of the flow in NumPy: gradients of ranges.

    Taylor coefficients from a polynomial through stepped points; crude, but the plain way.
    """
    rows = []
    times = np.linspace(-1, 1, 2 * orders - 1)
    for j, h in enumerate([10.0, 1e-6, 1e-6, 0.1, 1e-6, 1e-6]):
        ranges = []
        for sign in (1, -1):
            start = x + sign * h * np.eye(8)[j]
            path = np.array([plain_step(start, p, t) for t in times])
            c = np.stack(
                [
                    path[:, 0] * np.cos(path[:, 2]) * np.cos(path[:, 1]),
                    path[:, 0] * np.cos(path[:, 2]) * np.sin(path[:, 1]),
                    path[:, 0] * np.sin(path[:, 2]),
                ],
                axis=1,
            )
            ranges.append(np.linalg.norm(c[:, None] - beacons, axis=2))
        slope = (ranges[0] - ranges[1]) / (2 * h)
        rows.append(np.polynomial.polynomial.polyfit(times, slope, orders - 1))
    return np.linalg.svd(np.array(rows).reshape(6, -1).T, compute_uv=False)


def once(function):
    began = time.perf_counter()
    function()
    return time.perf_counter() - began


def best_of(function, count=9):
    return min(once(function) for _ in range(count))


def test_observability_of_241_epochs_and_3_beacons(benchmark, case):
    model, flight, beacons = case
    arguments = (model, flight.states, beacons)
    found = benchmark(observability, *arguments)
    assert found.spherical_degree[60] == pytest.approx(1.085359223315e-7, rel=1e-7)
    seconds = best_of(lambda: observability(*arguments))
    assert seconds <= 10e-3  # the chapter: more than 10 000 s
    p = spherical_parameters(model)
    few = flight.states[::20]
    twin = once(lambda: [plain_series(x, p, beacons.r[0]) for x in few]) * 241 / len(few)
    benchmark.extra_info |= {"seconds": seconds, "ratio_to_numpy": twin / seconds}
    assert twin / seconds > 20


def test_monte_carlo_of_500_runs_and_240_steps(benchmark, case):
    model, flight, beacons = case
    measurements = Measurements(50.0)
    taken = measurements.taken(np.ones((241, 3), bool), flight.times)
    covariance0 = axes_covariance(1000.0, 0.5)
    settings = Filter(covariance0, np.zeros(6))

    def runs():
        return run_monte_carlo(model, flight, beacons, taken, measurements, settings, runs=500)

    assert not benchmark(runs).diverged.any()
    seconds = best_of(runs, 3)
    assert seconds <= 2.0

    def plain_run():
        """One run: the same filter with the rates by NumPy and the transition by differences."""
        x, covariance = flight.states[0].copy(), covariance0.copy()
        p = spherical_parameters(model)
        scale = np.array([10.0, 1e-6, 1e-6, 0.1, 1e-6, 1e-6])
        c, jc = np.empty(6), np.empty((6, 6))
        for k in range(1, 241):
            phi = np.empty((6, 6))
            for j, h in enumerate(scale):
                e = h * np.eye(8)[j]
                phi[:, j] = (plain_step(x + e, p, 1.0) - plain_step(x - e, p, 1.0))[:6] / (2 * h)
            x = plain_step(x, p, 1.0)
            covariance = phi @ covariance @ phi.T
            cartesian(x, c)
            cartesian_jacobian(x, jc)
            line = c[:3] - beacons.r[k]
            distance = np.linalg.norm(line, axis=1)
            rows = line / distance[:, None] @ jc[:3]
            gain = (
                covariance @ rows.T @ np.linalg.inv(rows @ covariance @ rows.T + 2500 * np.eye(3))
            )
            x[:6] += gain @ np.zeros(3)
            covariance = (np.eye(6) - gain @ rows) @ covariance

    twin = 500 * once(plain_run)
    benchmark.extra_info |= {"seconds": seconds, "ratio_to_numpy": twin / seconds}
    assert twin / seconds > 50


@pytest.fixture(scope="module")
def six(case):
    """Six beacons about the track, all heard at every epoch."""
    model, flight, _ = case
    lat = np.radians([-25.8, -28.6, -25.6, -27.0, -24.5, -29.5])
    lon = np.radians([-82.7, -82.2, -73.4, -78.0, -77.0, -76.0])
    beacons = surface_beacons(lat, lon, flight.times, planet_radius=RADIUS)
    return model, flight, beacons, np.ones((241, 6), bool), Measurements(50.0)


def test_a_filter_step_with_six_beacons(benchmark, six):
    """The two filters before this one took 2.5 to 4.4 microseconds; 1.5 times that is allowed."""
    settings = Filter(axes_covariance(1000.0, 0.5), np.zeros(6))

    def runs():
        return run_monte_carlo(*six, settings, runs=100, threads=1)

    assert not benchmark(runs).diverged.any()
    seconds = min(cpu(runs) for _ in range(5)) / (100 * 241)
    benchmark.extra_info |= {"microseconds": 1e6 * seconds}
    print(f"\n{1e6 * seconds:.2f} microseconds a step")
    assert seconds < 1.5 * 4.4e-6


def test_linear_covariance_of_an_entry(benchmark, six):
    model, flight, *heard = six
    given = (model, flight.path, *heard, axes_covariance(1000.0, 0.5))
    found = benchmark(linear_covariance, *given)
    assert found.covariance.shape == (241, 6, 6)
    seconds = min(cpu(lambda: linear_covariance(*given)) for _ in range(9))
    benchmark.extra_info |= {"milliseconds": 1e3 * seconds}
    print(f"\n{1e3 * seconds:.2f} ms an entry")
    assert seconds < 5e-3


def cpu(function):
    """Seconds of the processor, which other programs do not lengthen as they do a clock's."""
    start = time.process_time()
    function()
    return time.process_time() - start


def test_adaptive_flight(benchmark, case):
    model, flight, _ = case
    start, times = flight.states[0, :6], flight.times
    benchmark(fly, model, start, times)
    from scipy.integrate import solve_ivp

    p = spherical_parameters(model)
    seconds = best_of(lambda: fly(model, start, times))
    twin = best_of(
        lambda: solve_ivp(
            lambda _, x: plain_rates(x, p),
            (0, 240),
            flight.states[0],
            method="DOP853",
            rtol=1e-13,
            atol=1e-9,
            t_eval=times,
        ),
        1,
    )
    benchmark.extra_info |= {"seconds": seconds, "ratio_to_scipy": twin / seconds}
    assert twin / seconds > 10


def test_the_plain_twin_is_right(case):
    model, flight, _ = case
    p, out, after = spherical_parameters(model), np.empty(8), np.empty(8)
    entry_rates(flight.states[60], p, out)
    np.testing.assert_allclose(plain_rates(flight.states[60], p), out, rtol=1e-12)
    rk4_step(flight.states[60], p, 1.0, after)
    np.testing.assert_allclose(plain_step(flight.states[60], p, 1.0), after, rtol=1e-13)

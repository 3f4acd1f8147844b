"""The chapter's own filter, on its spherical states: against Stone Soup, its bound, itself."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from compass.core.papers.spherical import rk4_step_transition
from compass.core.papers.spherical_geometry import cartesian_jacobian, range_rows
from compass.core.papers.yu2018_filter import Course, Sights, filter_run, measure
from compass.entry.beacons import Beacons
from compass.entry.schedule import Measurements
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError
from compass.papers import yu2018_case as paper
from compass.papers.spherical import spherical_parameters
from compass.papers.yu2018_filter import (
    Filter,
    cramer_rao_bound,
    initial_covariance,
    run_monte_carlo,
)

MEASUREMENTS = Measurements(50.0)


def ideal_measurements(states, beacons):
    """Ranges (m) and range rates (m/s) without noise, shape (t, n, 2)."""
    out = np.empty((*beacons.r.shape[:2], 2))
    measure(np.ascontiguousarray(states, dtype=float), beacons.r, beacons.v, out)
    return out


def run_published_filter(model, estimate, beacons, taken, measurements, settings, z):
    """States (t, 6) and covariances (t, 6, 6) after each epoch's measurements."""
    count = beacons.times.size
    states, covariances = np.empty((count, 6)), np.empty((count, 6, 6))
    filter_run(
        model.full_state(estimate),
        np.array(settings.covariance0, dtype=float),
        Course(
            spherical_parameters(model),
            model.vehicle.bank(beacons.times),
            beacons.times,
            np.array(settings.noise, dtype=float),
        ),
        Sights(
            beacons.r,
            beacons.v,
            np.asarray(taken, dtype=bool),
            measurements.radio_variances()[:2],
        ),
        np.asarray(z, dtype=float),
        settings.iterations,
        states,
        covariances,
    )
    return states, covariances


@pytest.fixture(scope="module")
def world():
    return paper.model


@pytest.fixture(scope="module")
def orbiter_flight():
    return paper.orbiter_flight()


@pytest.fixture(scope="module")
def orbiter_beacons():
    return paper.orbiters


@pytest.fixture(scope="module")
def table5():
    return paper.table_5()


@pytest.fixture(scope="module")
def orbiter_case(world, orbiter_flight, orbiter_beacons, table5):
    beacons = orbiter_beacons()
    taken = MEASUREMENTS.taken(np.ones((241, 3), bool), beacons.times)
    return world(), orbiter_flight, beacons, taken, initial_covariance(table5, 1000.0, 0.5)


@pytest.fixture(scope="module")
def coarse_case(world, orbiter_flight, orbiter_beacons, table5):
    """Make the same case with epochs 24 s apart, ranges and rates, and any process noise."""
    fine = orbiter_beacons()
    beacons = Beacons(fine.names, fine.times[::24], fine.r[::24], fine.v[::24], fine.moving)
    taken = np.ones((11, 3), bool)
    covariance0 = initial_covariance(table5, 1000.0, 0.5)

    def run(measurements=MEASUREMENTS, noise=0.0, iterations=1, truth=None, **options):
        settings = Filter(covariance0, np.full(6, noise) * np.diag(covariance0), iterations)
        return run_monte_carlo(
            world(), table5, beacons, taken, measurements, settings, truth=truth, **options
        )

    return run


def test_small_runs_are_consistent_in_every_mode(coarse_case):
    """NEES averages over epochs within four sigma of 6 for ranges, rates, noise, iterations."""
    for options in (
        {"measurements": Measurements(50.0, 0.05)},
        {"measurements": Measurements(None, 0.05)},
        {"noise": 1e-4},
        {"iterations": 3},
    ):
        mc = coarse_case(runs=30, **options)
        assert not mc.diverged.any()
        # epochs are correlated: count the runs alone, sigma sqrt(12/30)
        assert abs(mc.mean_nees.mean() - 6) < 4 * np.sqrt(12 / 30)


def test_ekf_equals_stone_soup(orbiter_case):
    """Six epochs of three ranges by another program's filter; its models call our dynamics."""
    from stonesoup.base import Property
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.models.transition.base import TransitionModel
    from stonesoup.predictor.kalman import ExtendedKalmanPredictor
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import ExtendedKalmanUpdater

    model, flight, beacons, taken, covariance0 = orbiter_case
    steps = 6
    noise = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
    p = spherical_parameters(model)
    # the filters see states in these units, so that neither suffers from the mixture
    unit = np.array([1e3, 3e-4, 3e-4, 10.0, 3e-3, 3e-3])

    def stepped(six):
        after, phi = np.empty(8), np.empty((8, 8))
        rk4_step_transition(model.full_state(six), p, 1.0, after, phi)
        return after[:6], phi[:6, :6]

    class Entry(TransitionModel):
        ndim_state = 6

        def function(self, state, noise=False, **kwargs):
            return (stepped(np.ravel(state.state_vector).astype(float) * unit)[0] / unit)[:, None]

        def jacobian(self, state, **kwargs):
            phi = stepped(np.ravel(state.state_vector).astype(float) * unit)[1]
            return phi * unit / unit[:, None]

        def covar(self, **kwargs):
            return np.diag(noise / unit**2)

        def rvs(self, *args, **kwargs):
            raise NotImplementedError

        def pdf(self, *args, **kwargs):
            raise NotImplementedError

    class Range(NonLinearGaussianMeasurement):
        place: object = Property()

        @property
        def ndim_meas(self):
            return 1

        def function(self, state, noise=False, **kwargs):
            at = cartesian_of(np.ravel(state.state_vector).astype(float) * unit)[:3]
            return np.array([[np.linalg.norm(at - self.place)]])

        def jacobian(self, state, **kwargs):
            six = np.ravel(state.state_vector).astype(float) * unit
            jc, row, rate = np.empty((6, 6)), np.empty(6), np.empty(6)
            cartesian_jacobian(six, jc)
            range_rows(cartesian_of(six), self.place, np.zeros(3), jc, row, rate)
            return (row * unit)[None]

    rng = np.random.default_rng(0)
    z = ideal_measurements(flight.states, beacons)[:steps]
    z[..., 0] += 50 * rng.normal(size=z.shape[:2])
    estimate = flight.states[0, :6] + np.linalg.cholesky(covariance0) @ rng.normal(size=6)
    few = type(beacons)(
        beacons.names, beacons.times[:steps], beacons.r[:steps], beacons.v[:steps], beacons.moving
    )
    found, covariances = run_published_filter(
        model, estimate, few, taken[:steps], MEASUREMENTS, Filter(covariance0, noise), z
    )

    began = datetime(2030, 1, 1)
    state = GaussianState(
        (estimate / unit)[:, None], covariance0 / np.outer(unit, unit), timestamp=began
    )
    predictor = ExtendedKalmanPredictor(Entry())
    for k in range(steps):
        now = began + timedelta(seconds=k)
        if k:
            state = predictor.predict(state, timestamp=now)
        # all ranges of an epoch are linearised at its prior: stack them in one measurement
        rows = [
            Range(ndim_state=6, mapping=(0,), noise_covar=np.array([[2500.0]]), place=place)
            for place in beacons.r[k]
        ]

        class Stack(Range):
            @property
            def ndim_meas(self):
                return 3

            def function(self, state, noise=False, **kwargs):
                return np.vstack([row.function(state) for row in self.place])

            def jacobian(self, state, **kwargs):
                return np.vstack([row.jacobian(state) for row in self.place])

        stack = Stack(ndim_state=6, mapping=(0,), noise_covar=2500.0 * np.eye(3), place=rows)
        detection = Detection(z[k, :, 0][:, None], measurement_model=stack, timestamp=now)
        updater = ExtendedKalmanUpdater(stack)
        state = updater.update(SingleHypothesis(state, detection))
        sigma = np.sqrt(np.diag(covariances[k]))
        mean = np.ravel(state.state_vector).astype(float) * unit
        # two algebraically equal filters: within 1e-6 of a sigma, covariances to 1e-8
        assert np.all(np.abs(found[k] - mean) < 1e-6 * sigma)
        scale = np.outer(sigma, sigma)
        other = np.asarray(state.covar, float) * np.outer(unit, unit)
        np.testing.assert_allclose(covariances[k] / scale, other / scale, atol=1e-8)


@pytest.mark.slow
def test_monte_carlo_meets_the_cramer_rao_bound(orbiter_case):
    model, flight, beacons, taken, covariance0 = orbiter_case
    bound = cramer_rao_bound(model, flight.states, beacons, taken, MEASUREMENTS, covariance0)
    runs = 200
    mc = run_monte_carlo(
        model,
        flight.states[0],
        beacons,
        taken,
        MEASUREMENTS,
        Filter(covariance0, np.zeros(6)),
        runs=runs,
    )
    assert not mc.diverged.any()
    # the error of an RMS over 200 runs of three correlated axes is at most 1/sqrt(2 200) = 5 %
    for rms, sigma in (
        (mc.position_rms, bound.position_sigma),
        (mc.velocity_rms, bound.velocity_sigma),
    ):
        ratio = rms / sigma
        assert np.all((ratio > 1 - 4 * 0.05) & (ratio < 1 + 4 * 0.05))
        assert 0.93 < ratio.mean() < 1.07
    # NEES: chi-square of 6 x 200 degrees of freedom over 200, sigma sqrt(12/200) = 0.24
    assert abs(mc.mean_nees[60:].mean() - 6) < 4 * 0.25
    np.testing.assert_allclose(mc.sigmas[:, -1, 0].mean(), bound.position_sigma[-1], rtol=0.02)


@pytest.mark.slow
def test_process_noise_keeps_the_filter_consistent(orbiter_case):
    model, flight, beacons, taken, covariance0 = orbiter_case
    noise = np.array([4.0, 1e-12, 1e-12, 0.25, 1e-8, 1e-8])
    mc = run_monte_carlo(
        model, flight.states[0], beacons, taken, MEASUREMENTS, Filter(covariance0, noise), runs=100
    )
    assert abs(mc.mean_nees[20:].mean() - 6) < 4 * np.sqrt(12 / 100)


def test_numbers_do_not_depend_on_threads_nor_on_later_runs(coarse_case):
    one = coarse_case(runs=25, seed=3, threads=1)
    four = coarse_case(runs=25, seed=3, threads=4)
    np.testing.assert_array_equal(one.errors, four.errors)
    fewer = coarse_case(runs=6, seed=3)
    np.testing.assert_array_equal(one.errors[:6], fewer.errors)
    other = coarse_case(runs=6, seed=4)
    assert not np.allclose(other.errors, fewer.errors)


@pytest.mark.slow
def test_iterating_helps_where_first_errors_are_large(world):
    """Table 4: 0.2 deg are 12 km. The iterated filter is consistent at once, the plain one not."""
    ground_beacons, table2 = paper.ground_beacons(), paper.table_2()
    sigma = np.array([1000.0, *np.radians([0.2, 0.2]), 10.0, *np.radians([0.2, 0.2])])
    measurements = Measurements(100.0)
    taken = measurements.taken(np.ones((241, 3), bool), ground_beacons.times)
    nees = {}
    for passes in (1, 10):
        settings = Filter(np.diag(sigma**2), np.zeros(6), passes)
        mc = run_monte_carlo(
            world(), table2, ground_beacons, taken, measurements, settings, runs=150
        )
        nees[passes] = mc.mean_nees[0]
    assert nees[1] > 12
    assert abs(nees[10] - 6) < 4 * np.sqrt(12 / 150)


@pytest.mark.slow
def test_range_rates_sharpen_the_velocity(orbiter_case):
    model, flight, beacons, taken, covariance0 = orbiter_case
    settings = Filter(covariance0, np.zeros(6))
    both = Measurements(50.0, 0.05)
    runs = {
        kind: run_monte_carlo(model, flight.states[0], beacons, taken, kind, settings, runs=40)
        for kind in (MEASUREMENTS, both, Measurements(None, 0.05))
    }
    assert runs[both].velocity_rms[60] < 0.3 * runs[MEASUREMENTS].velocity_rms[60]
    assert abs(runs[both].mean_nees[100:].mean() - 6) < 4 * np.sqrt(12 / 40)


def test_a_wrong_density_is_told_by_the_nees(coarse_case, world):
    mc = coarse_case(runs=10, truth=world().truth(density_bias=0.1))
    assert mc.mean_nees[-1] > 60


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"iterations": 0}, "iterations = 0"),
        ({"noise": -np.ones(6)}, "every variance must be 0 or more"),
        ({"covariance0": np.zeros((6, 6))}, "not positive definite"),
    ],
)
def test_impossible_filters_are_refused(change, message):
    with pytest.raises(ArgumentError, match=message):
        Filter(**{"covariance0": np.eye(6), "noise": np.zeros(6)} | change)


def test_at_least_one_run(coarse_case):
    with pytest.raises(ArgumentError, match="runs = 0: must be at least 1"):
        coarse_case(runs=0)

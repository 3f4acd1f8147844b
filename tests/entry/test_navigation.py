"""The filter on Cartesian states: against Stone Soup, against the bound, and against itself."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from compass.core.entry.flow import advance, advance_spread, advance_transition
from compass.core.entry.predict import spread_factor
from compass.core.entry.rates import World
from compass.entry import navigation
from compass.entry.beacons import Beacons
from compass.entry.consistency import consistency
from compass.entry.covariance import axes_covariance, linear_covariance
from compass.entry.filters import Filter
from compass.entry.layout import Layout, Part
from compass.entry.navigation import MonteCarlo, run_monte_carlo
from compass.entry.schedule import Measurements
from compass.entry.trajectory import fly
from compass.errors import ArgumentError
from tests.entry.one_run import ideal_measurements, run_filter

MEASUREMENTS = Measurements(50.0)
PRIOR = axes_covariance(1000.0, 0.5)


@pytest.fixture(scope="module")
def orbiter_case(world, orbiter_flight, orbiter_beacons):
    return world(), orbiter_flight, orbiter_beacons(), np.ones((241, 3), bool)


@pytest.fixture(scope="module")
def coarse_case(world, orbiter_beacons, table5):
    """Make the same case with epochs 24 s apart, ranges and rates, and any process noise."""
    fine = orbiter_beacons()
    beacons = Beacons(fine.names, fine.times[::24], fine.r[::24], fine.v[::24], fine.moving)
    taken = np.ones((11, 3), bool)

    def run(
        measurements=MEASUREMENTS, noise=0.0, iterations=1, truth=None, parts=(), method="plain",
        prior=PRIOR, **options,
    ):  # fmt: skip
        shares = np.array([1e6, 1e-7, 1e-7, 0.25, 1e-8, 1e-8])
        settings = Filter(prior, noise * shares, iterations, parts, method)
        flight = fly(truth or world(), table5, beacons.times)
        return run_monte_carlo(world(), flight, beacons, taken, measurements, settings, **options)

    return run


@pytest.mark.slow
def test_small_runs_are_consistent_in_every_mode(coarse_case):
    """NEES averages over epochs within four sigma of 6 for ranges, rates, noise, iterations."""
    further = (Part("clock", (30.0, 0.1)), Part("bias", (10.0,), considered=True))
    for options in (
        {"measurements": Measurements(50.0, 0.05)},
        {"measurements": Measurements(None, 0.05)},
        {"noise": 1e-4},
        {"iterations": 3},
        {"parts": further},
    ):
        mc = coarse_case(runs=30, **options)
        assert not mc.diverged.any() and not mc.broken.any()
        # epochs are correlated: count the runs alone, sigma sqrt(12/30)
        assert abs(mc.mean_nees.mean() - 6) < 4 * np.sqrt(12 / 30)
        assert abs(mc.nees_all.mean() - mc.estimated) < 4 * np.sqrt(2 * mc.estimated / 30)


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

    model, flight, beacons, taken = orbiter_case
    steps = 6
    p, bank = model.flight_parameters(), model.vehicle.bank_schedule()

    def stepped(state):
        after, phi = np.empty(6), np.empty((6, 8))
        x = np.ravel(state.state_vector).astype(float)
        advance_transition(x, World(p, 0.0, 0.156), bank, 0.0, 1.0, 1.0, after, phi)
        return after, phi[:, :6].copy()

    class Entry(TransitionModel):
        ndim_state = 6

        def function(self, state, noise=False, **kwargs):
            return stepped(state)[0][:, None]

        def jacobian(self, state, **kwargs):
            return stepped(state)[1]

        def covar(self, **kwargs):
            return np.zeros((6, 6))

        def rvs(self, *args, **kwargs):
            raise NotImplementedError

        def pdf(self, *args, **kwargs):
            raise NotImplementedError

    class Ranges(NonLinearGaussianMeasurement):
        places: object = Property()

        @property
        def ndim_meas(self):
            return len(self.places)

        def lines(self, state):
            return np.ravel(state.state_vector).astype(float)[:3] - self.places

        def function(self, state, noise=False, **kwargs):
            return np.linalg.norm(self.lines(state), axis=1)[:, None]

        def jacobian(self, state, **kwargs):
            lines = self.lines(state)
            unit = lines / np.linalg.norm(lines, axis=1)[:, None]
            return np.concatenate([unit, np.zeros_like(unit)], axis=1)

    rng = np.random.default_rng(0)
    z = ideal_measurements(flight.path, beacons)[:steps]
    z[..., 0] += 50 * rng.normal(size=z.shape[:2])
    estimate = flight.path[0] + np.sqrt(np.diag(PRIOR)) * rng.normal(size=6)
    few = Beacons(
        beacons.names, beacons.times[:steps], beacons.r[:steps], beacons.v[:steps], beacons.moving
    )
    settings = Filter(PRIOR, np.zeros(6))
    found, covariances = run_filter(model, estimate, few, taken[:steps], MEASUREMENTS, settings, z)
    began = datetime(2030, 1, 1)
    state = GaussianState(estimate[:, None], PRIOR, timestamp=began)
    predictor = ExtendedKalmanPredictor(Entry())
    for k in range(steps):
        now = began + timedelta(seconds=k)
        if k:
            state = predictor.predict(state, timestamp=now)
        kind = Ranges(
            ndim_state=6, mapping=(0,), noise_covar=2500.0 * np.eye(3), places=beacons.r[k]
        )
        detection = Detection(z[k, :, 0][:, None], measurement_model=kind, timestamp=now)
        state = ExtendedKalmanUpdater(kind).update(SingleHypothesis(state, detection))
        sigma = np.sqrt(np.diag(covariances[k]))
        mean = np.ravel(state.state_vector).astype(float)
        # two algebraically equal filters: within 1e-6 of a sigma, covariances to 1e-8
        assert np.all(np.abs(found[k] - mean) < 1e-6 * sigma)
        scale = np.outer(sigma, sigma)
        np.testing.assert_allclose(
            covariances[k] / scale, np.asarray(state.covar, float) / scale, atol=1e-8
        )


@pytest.mark.slow
def test_monte_carlo_meets_the_linear_covariance(orbiter_case):
    model, flight, beacons, taken = orbiter_case
    bound = linear_covariance(model, flight.path, beacons, taken, MEASUREMENTS, PRIOR)
    runs = 200
    mc = run_monte_carlo(
        model, flight, beacons, taken, MEASUREMENTS, Filter(PRIOR, np.zeros(6)), runs=runs
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
    assert consistency(mc.nees, flight.times, 6, mc.diverged).holds


@pytest.mark.parametrize("step", [1.0, 24.0])
def test_truth_is_the_flight_whatever_the_step(world, table5, orbiter_beacons, step):
    """Bank switches between epochs: with nearly perfect measurements the filter finds the flight."""
    model = world(bank_times=(0.0, 80.5, 140.5), bank_angles=(-1.0, 1.0, -1.0))
    fine, every = orbiter_beacons(), int(step)
    beacons = Beacons(
        fine.names, fine.times[::every], fine.r[::every], fine.v[::every], fine.moving
    )
    flight = fly(model, table5, beacons.times)
    whole = fly(model, table5, [0.0, 240.0])
    np.testing.assert_allclose(flight.path[-1], whole.path[-1], rtol=0, atol=1e-5)
    taken = np.ones((beacons.times.size, 3), bool)
    settings = Filter(PRIOR, np.zeros(6))
    z = ideal_measurements(flight.path, beacons)
    states, _ = run_filter(model, flight.path[0], beacons, taken, Measurements(1.0), settings, z)
    # fed with exact ranges of the flight from its true start, all that is left are the filter's
    # Runge-Kutta steps of a second: millimetres
    assert np.abs(states - flight.path)[:, :3].max() < 0.02
    assert np.abs(states - flight.path)[:, 3:].max() < 2e-3


def test_runs_with_arrivals_of_their_own_are_those_runs_one_by_one(orbiter_case):
    model, flight, beacons, taken = orbiter_case
    settings = Filter(PRIOR, np.zeros(6), method="relinearised", parts=(Part("lift", (0.01,)),))
    arrived = taken & (np.random.default_rng(5).random((3, *taken.shape)) < 0.5)
    streams = np.random.SeedSequence(7).spawn(3)

    def errors(taken, streams):
        return run_monte_carlo(
            model, flight, beacons, taken, MEASUREMENTS, settings, runs=len(streams),
            streams=streams,
        ).errors  # fmt: skip

    together = errors(arrived, streams)
    for one, stream, found in zip(arrived, streams, together, strict=True):
        np.testing.assert_array_equal(errors(one, [stream])[0], found)
    assert np.abs(together[0] - errors(arrived[:1] | True, streams[:1])[0]).max() > 1.0


def test_numbers_do_not_depend_on_threads_nor_on_later_runs(coarse_case, monkeypatch):
    monkeypatch.setattr(navigation, "BLOCK", 2)
    one = coarse_case(runs=5, seed=3, threads=1)
    four = coarse_case(runs=5, seed=3, threads=4)
    np.testing.assert_array_equal(one.errors, four.errors)
    fewer = coarse_case(runs=3, seed=3)
    np.testing.assert_array_equal(one.errors[:3], fewer.errors)
    other = coarse_case(runs=3, seed=4)
    assert not np.allclose(other.errors, fewer.errors)


def test_a_wrong_density_is_told_and_estimating_it_mends(coarse_case, world):
    truth = world().truth(density_bias=0.2)
    mc = coarse_case(runs=10, truth=truth)
    assert mc.mean_nees[-1] > 60
    assert not consistency(mc.nees, np.arange(11.0), 6, mc.diverged).holds
    mended = coarse_case(runs=10, truth=truth, parts=(Part("air", (0.2,)),), iterations=3)
    assert mended.mean_nees[-1] < 1e-3 * mc.mean_nees[-1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "scales"), [("relinearised", ()), ("unscented", (8200.0, 300e3))]
)
def test_badly_known_air_leaves_claims_that_hold(orbiter_case, method, scales):
    """Density known to 20 %, one factor or a profile: the extended filter is tens too sure."""
    model, flight, beacons, taken = orbiter_case
    parts, runs = (Part("air", (0.2,), scales=scales),), 150
    plain, other = (
        run_monte_carlo(
            model, flight, beacons, taken, MEASUREMENTS,
            Filter(PRIOR, np.zeros(6), parts=parts, method=name), runs=runs,
        )
        for name in ("plain", method)
    )  # fmt: skip
    assert not consistency(plain.nees, flight.times, 6, plain.diverged).holds
    assert plain.mean_nees.max() > 15
    assert consistency(other.nees, flight.times, 6, other.diverged).holds
    # at deployment all that is estimated is known as well as is claimed: 4 sigma of chi-square
    assert abs(other.nees_all[:, -1].mean() - 7) < 4 * np.sqrt(14 / runs)
    layout = Layout(parts, beacons.size)
    bound = linear_covariance(
        model, flight.path, beacons, taken, MEASUREMENTS, PRIOR, layout=layout
    )
    assert 0.8 < other.position_rms[-1] / bound.position_sigma[-1] < 1.25


def test_looking_back_is_the_extended_filter_where_nothing_is_to_be_seen(coarse_case):
    """Without density or L/D to learn bit for bit; with them, unlike it, and nearer the truth."""
    plain, back = (coarse_case(runs=2, method=name) for name in ("plain", "relinearised"))
    np.testing.assert_array_equal(plain.errors, back.errors)
    air = (Part("air", (0.3,)), Part("lift", (0.01,)))
    plain, back = (
        coarse_case(runs=3, parts=air, seed=2, method=name) for name in ("plain", "relinearised")
    )
    assert back.nees_all[:, -1].mean() < plain.nees_all[:, -1].mean()
    considered = (Part("air", (0.02,), considered=True),)
    plain, back = (
        coarse_case(runs=2, parts=considered, method=name) for name in ("plain", "relinearised")
    )
    np.testing.assert_array_equal(plain.errors, back.errors)


def test_spread_points_of_what_is_known_well_are_the_extended_filter(coarse_case):
    """Both move a belief of centimetres alike; one that wanders by a tenth they do not."""
    fine = {
        "prior": axes_covariance(0.1, 1e-4), "parts": (Part("air", (1e-6,)),), "runs": 2,
        "measurements": Measurements(1.0),
    }  # fmt: skip
    plain, spread = (coarse_case(method=name, **fine) for name in ("plain", "unscented"))
    np.testing.assert_allclose(plain.sigmas, spread.sigmas, rtol=1e-5)
    assert np.abs(plain.errors - spread.errors)[..., :3].max() < 1e-3
    wide = {"parts": (Part("air", (0.2,), scales=(8200.0, np.inf)),), "runs": 2, "noise": 1e-4}
    plain, spread = (coarse_case(method=name, **wide) for name in ("plain", "unscented"))
    assert not np.allclose(plain.sigmas, spread.sigmas, rtol=1e-3)


def test_flights_go_back_the_way_they_came(world, table5):
    """Through switches of the bank, from one and to one, to the error of Runge-Kutta steps."""
    model = world(bank_times=(0.0, 60.0, 80.5), bank_angles=(-1.0, 1.0, -0.4))
    p, bank = model.flight_parameters(), model.vehicle.bank_schedule()
    start, there, back = fly(model, table5, [0.0]).path[0], np.empty(6), np.empty(6)
    for begin, end in ((0.0, 90.0), (60.0, 80.5), (55.0, 60.0)):
        advance(start, World(p, 0.1, 0.156), bank, begin, end, 1.0, there)
        advance(there, World(p, 0.1, 0.156), bank, end, begin, 1.0, back)
        # a second's step is off by 2 mm at 13 g, which drag flown backwards magnifies by some tens
        np.testing.assert_allclose(back[:3], start[:3], rtol=0, atol=0.1)
        np.testing.assert_allclose(back[3:], start[3:], rtol=0, atol=0.01)


def test_a_spread_moves_as_its_points_do(world, table5):
    """Mean and covariance of the ends of cubature's points, by numpy."""
    model = world()
    p, bank = model.flight_parameters(), model.vehicle.bank_schedule()
    places = Layout((Part("air", (0.2,)),)).numbers()
    root = np.diag([500.0, 300.0, 400.0, 2.0, 3.0, 1.0, 0.2]) @ (
        np.eye(7) + 0.1 * np.random.default_rng(1).normal(size=(7, 7))
    )
    covariance, x = root @ root.T, fly(model, table5, [0.0, 80.0]).path[1]
    factor = np.empty((8, 8))
    spread_factor(covariance, places, factor)
    np.testing.assert_allclose(factor[:7, :7], np.linalg.cholesky(covariance), rtol=1e-9)
    out, phi, bend = np.empty(6), np.empty((6, 8)), np.empty((6, 8))
    advance_spread(x, factor, World(p, 0.1, 0.156), bank, 0.0, 2.0, 1.0, out, phi, bend)
    ends = np.empty((14, 6))
    for k in range(14):
        point = (
            np.append(x, 0.1) + (-1) ** k * np.sqrt(7) * np.linalg.cholesky(covariance)[:, k // 2]
        )
        advance(point[:6], World(p, point[6], 0.156), bank, 0.0, 2.0, 1.0, ends[k])
    np.testing.assert_allclose(out, ends.mean(axis=0), rtol=1e-12)
    found = phi[:, :7] @ covariance @ phi[:, :7].T + bend @ bend.T
    scale = np.sqrt(np.diag(np.cov(ends.T, bias=True)))
    np.testing.assert_allclose(
        found / np.outer(scale, scale),
        np.cov(ends.T, bias=True) / np.outer(scale, scale),
        atol=1e-6,
    )
    assert np.linalg.norm(bend) > 1e-4 * np.linalg.norm(phi @ factor)


@pytest.mark.slow
def test_iterating_helps_where_first_errors_are_large(world, ground_flight, ground_beacons):
    """12 km, as Table 4 has it. The iterated filter is consistent at once, the plain one not."""
    measurements = Measurements(100.0)
    taken = measurements.taken(np.ones((241, 3), bool), ground_beacons.times)
    nees = {}
    for passes in (1, 10):
        settings = Filter(axes_covariance(12e3, 10.0), np.zeros(6), passes)
        mc = run_monte_carlo(
            world(), ground_flight, ground_beacons, taken, measurements, settings, runs=100
        )
        nees[passes] = mc.mean_nees[0]
    assert nees[1] > 12
    assert abs(nees[10] - 6) < 4 * np.sqrt(12 / 100)


def test_noise_in_a_single_run_follows_the_estimate(orbiter_case):
    """The same covariance as along the flight, to the estimate's first error."""
    model, flight, beacons, taken = orbiter_case
    noise = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
    z = ideal_measurements(flight.path, beacons)
    settings = Filter(PRIOR, noise)
    _, found = run_filter(model, flight.path[0], beacons, taken, MEASUREMENTS, settings, z)
    bound = linear_covariance(model, flight.path, beacons, taken, MEASUREMENTS, PRIOR, noise)
    sigma = np.sqrt(np.einsum("tii->ti", found))
    np.testing.assert_allclose(sigma, np.sqrt(np.einsum("tii->ti", bound.covariance)), rtol=1e-5)


def test_diverged_runs_are_set_apart():
    errors = np.zeros((2, 1, 6))
    errors[1] = np.nan
    ones = np.ones((2, 1))
    mc = MonteCarlo(errors, ones, np.ones((2, 1, 2)), np.array([False, True]), ones)
    assert mc.position_rms == 0
    assert mc.mean_nees == 1
    lost = MonteCarlo(errors, ones, np.ones((2, 1, 2)), np.array([True, True]), ones)
    assert np.isnan(lost.position_rms).all()
    assert np.isnan(lost.mean_nees).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"iterations": 0}, "iterations = 0"),
        ({"method": "magic"}, "method = 'magic': allowed plain, unscented, relinearised"),
        ({"method": "relinearised", "noise": np.ones(6)}, "no one flight to look back along"),
        ({"noise": -np.ones(6)}, "every variance must be 0 or more"),
        ({"covariance0": np.zeros((6, 6))}, "not positive definite"),
        ({"covariance0": np.ones((6, 6))}, "not positive definite"),
    ],
)
def test_impossible_filters_are_refused(change, message):
    with pytest.raises(ArgumentError, match=message):
        Filter(**{"covariance0": np.eye(6), "noise": np.zeros(6)} | change)


def test_at_least_one_run(coarse_case):
    with pytest.raises(ArgumentError, match="runs = 0: must be at least 1"):
        coarse_case(runs=0)

"""Filters step by step: published check values, identities between filters, Stone Soup."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.entry.weights import DETERMINANT, EQUAL, FAST, TRACE
from compass.core.papers import lou_steps as steps
from compass.core.papers.lou_common import (
    Epoch,
    Settings,
    add_noise,
    make_bank,
    make_work,
    predict_state,
    propagate,
    start_bank,
    update,
)
from compass.core.papers.lou_information import (
    add_information,
    information_start,
    predict_information,
)
from compass.core.papers.lou_measurement import predict_measurements
from compass.papers import lou2019_case as paper
from compass.papers.lou_filters import SCALE, FilterSettings
from compass.papers.spherical import spherical_parameters

RULES = {"equal": EQUAL, "fast": FAST, "determinant": DETERMINANT, "trace": TRACE}


def measured(case, noise_seed=None):
    """Measurements along the nominal flight, noise-free unless a seed is given."""
    z, slopes = np.zeros((case.times.size, 7)), np.empty((7, 8))
    for k, x in enumerate(case.nominal):
        predict_measurements(
            x, 8, spherical_parameters(case.truth), False, case.beacons.r[k], z[k], slopes
        )
    if noise_seed is not None:
        sigma = np.concatenate([np.full(3, 1e-3), case.range_sigma])
        z += sigma * np.random.default_rng(noise_seed).standard_normal(z.shape)
    return z


CASE = paper.case()
Z = measured(CASE)
NOISY = measured(CASE, 1)


def run(filter_settings: FilterSettings, count, z=Z, arrived=None, alive=None, algorithm=None):
    """Bank after `count` steps, and whether every step was sound."""
    number, kernel_settings, belief = filter_settings.kernel_arguments(1.0)
    number = number if algorithm is None else algorithm
    n = filter_settings.states
    bank, work = make_bank(n, belief.x0.size, 4), make_work(n, belief.x0.size, 4, belief.p.size)
    start_bank(bank, belief.x0, belief.p0)
    ok = steps.start(number, kernel_settings, bank, work)
    for k in range(1, count + 1):
        here = np.ones(7, bool) if arrived is None else arrived[k]
        works = np.ones(4, bool) if alive is None else alive[k]
        epoch = Epoch(
            belief.p, belief.p, CASE.beacons.r[k], z[k], here, works, kernel_settings.gate
        )
        ok = ok and steps.step(number, kernel_settings, epoch, bank, work)
    return bank, ok


def apart(a, b):
    """Largest difference of two fused estimates, in sigma, and of their sigmas, relative."""
    sigma = np.sqrt(np.diag(a.P))
    return (
        np.abs((a.x - b.x)[: sigma.size] / sigma).max(),
        np.abs(np.sqrt(np.diag(b.P)) / sigma - 1).max(),
    )


def test_published_ekf_after_ten_seconds():
    bank, ok = run(paper.published_filter("ekf"), 10)
    assert ok
    # given to 12 digits; relative 1e-9 is the requirement
    np.testing.assert_allclose(bank.x[[0, 3]], [3507164.19797, 5529.16659749], rtol=2e-12)
    assert np.sqrt(bank.P[0, 0]) == pytest.approx(6.31071761743, rel=1e-11)


def test_published_dcifaif_after_one_second():
    bank, ok = run(paper.published_filter("dcifaif"), 1)
    assert ok
    expected = [0.437857461023, 0.438955155491, 0.00622545036145, 0.116961933125]
    np.testing.assert_allclose(bank.weights, expected, rtol=1e-9)
    assert np.sqrt(bank.P[0, 0]) == pytest.approx(62.5519129820, rel=1e-9)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 1000))
def test_information_filter_is_the_ekf_that_skips_missing_rows(seed):
    arrived = np.random.default_rng(seed).random((301, 7)) < 0.6
    ekf, _ = run(paper.recommended_filter("ekf"), 8, NOISY, arrived)
    other, ok = run(paper.recommended_filter("intermittent"), 8, NOISY, arrived)
    assert ok
    # sigmas fall from 1 km to metres: information of condition 1e7 to 1e9 in scaled units
    state, sigma = apart(ekf, other)
    assert state < 1e-7
    assert sigma < 1e-8


@settings(max_examples=4, deadline=None)
@given(st.integers(0, 1000))
def test_federated_filter_is_the_centralised_ekf(seed):
    z = measured(CASE, seed)
    ekf, _ = run(paper.recommended_filter("ekf"), 6, z)
    other, ok = run(paper.recommended_filter("federated"), 6, z)
    assert ok
    state, sigma = apart(ekf, other)
    assert state < 1e-7
    assert sigma < 1e-8


def test_federated_filter_loses_a_dead_subsystem_s_range_and_no_more():
    alive = np.ones((301, 4), bool)
    alive[3:, 2] = False
    arrived = np.ones((301, 7), bool)
    arrived[3:, 5] = False
    ekf, _ = run(paper.recommended_filter("ekf"), 6, NOISY, arrived)
    other, ok = run(paper.recommended_filter("federated"), 6, NOISY, alive=alive)
    assert ok
    assert apart(ekf, other)[0] < 1e-7


def test_iterated_filter_with_one_pass_is_the_ekf():
    ekf, _ = run(paper.recommended_filter("ekf"), 4, NOISY)
    once, _ = run(paper.recommended_filter("iterated").changed(iterations=1), 4, NOISY)
    more, _ = run(paper.recommended_filter("iterated"), 4, NOISY)
    np.testing.assert_array_equal(once.x, ekf.x)
    assert not np.array_equal(more.x, ekf.x)


def test_iterated_update_is_the_least_squares_fit():
    from scipy.optimize import least_squares

    chosen = paper.recommended_filter("iterated").changed(iterations=20, start=CASE.start * 1.0001)
    bank, _ = run(chosen, 1, NOISY)
    _, kernel_settings, belief = chosen.kernel_arguments(1.0)
    prior, work = make_bank(8, 8, 4), make_work(8, 8, 4, 7)
    start_bank(prior, belief.x0, belief.p0)
    predict_state(kernel_settings, belief.p, prior.x, work)
    propagate(work.phi, prior.P, work.a)
    add_noise(prior.P, kernel_settings.q, 1.0)
    whiten = np.linalg.inv(np.linalg.cholesky(prior.P))
    noise = np.sqrt(np.concatenate([kernel_settings.r_acc, kernel_settings.r_range]))
    sigma = np.sqrt(np.diag(prior.P))

    def residuals(d):
        x, h, slopes = prior.x + sigma * d, np.empty(7), np.empty((7, 8))
        predict_measurements(x, 8, belief.p, False, CASE.beacons.r[1], h, slopes)
        return np.concatenate([(NOISY[1] - h) / noise, whiten @ (sigma * d)])

    fit = least_squares(residuals, np.zeros(8), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    posterior = np.sqrt(np.diag(bank.P))
    assert np.abs((prior.x + sigma * fit.x - bank.x) / posterior).max() < 1e-3


def test_rows_one_by_one_are_the_batch_update_in_joseph_form():
    _, s, belief = paper.recommended_filter("ekf").kernel_arguments(1.0)
    bank, work = make_bank(8, 8, 4), make_work(8, 8, 4, 7)
    start_bank(bank, belief.x0, belief.p0)
    predict_measurements(bank.x, 8, belief.p, False, CASE.beacons.r[1], work.h, work.big_h)
    work.used[:] = True
    big_h, h, p, x = work.big_h.copy(), work.h.copy(), bank.P.copy(), bank.x.copy()
    assert update(s, NOISY[1], bank.x, bank.P, 1.0, work)
    r = np.diag(np.concatenate([s.r_acc, s.r_range]))
    gain = np.linalg.solve(big_h @ p @ big_h.T + r, big_h @ p).T
    rest = np.eye(8) - gain @ big_h
    batch = rest @ p @ rest.T + gain @ r @ gain.T
    sigma = np.sqrt(np.diag(batch))
    np.testing.assert_allclose(
        bank.P / np.outer(sigma, sigma), batch / np.outer(sigma, sigma), atol=1e-6
    )
    assert np.abs((bank.x - x - gain @ (NOISY[1] - h)) / sigma).max() < 1e-5


@pytest.mark.parametrize("algorithm", ["ci", "ci-feedback", "dcifaif", "federated"])
def test_with_every_subsystem_dead_the_estimate_is_only_predicted(algorithm):
    alive = np.ones((301, 4), bool)
    alive[2] = False
    bank, ok = run(paper.recommended_filter(algorithm), 2, NOISY, alive=alive)
    before, _ = run(paper.recommended_filter(algorithm), 1, NOISY)
    _, s, belief = paper.recommended_filter(algorithm).kernel_arguments(1.0)
    work = make_work(8, 8, 4, 7)
    predict_state(s, belief.p, before.x, work)
    propagate(work.phi, before.P, work.a)
    add_noise(before.P, s.q, 1.0)
    assert ok
    np.testing.assert_allclose(bank.x, before.x, rtol=1e-15)
    np.testing.assert_allclose(bank.P, before.P, rtol=1e-13)


@pytest.mark.parametrize("algorithm", ["ci", "ci-feedback", "dcifaif", "federated"])
def test_a_subsystem_comes_back(algorithm):
    alive = np.ones((301, 4), bool)
    alive[2:4, 1] = False
    during, _ = run(paper.recommended_filter(algorithm), 3, NOISY, alive=alive)
    assert during.weights[1] == 0.0
    after, ok = run(paper.recommended_filter(algorithm), 5, NOISY, alive=alive)
    assert ok
    assert after.weights.sum() == pytest.approx(1.0)


def test_feedback_changes_nothing_before_there_is_any():
    """Over the first epoch the subsystems of both intersections start from the same estimate."""
    without, _ = run(paper.recommended_filter("ci"), 1, NOISY)
    fed, _ = run(paper.recommended_filter("ci-feedback"), 1, NOISY)
    assert max(apart(without, fed)) < 1e-9


def test_without_feedback_a_subsystem_comes_back_from_the_fused_estimate():
    alive = np.ones((301, 4), bool)
    alive[2:4, 1] = False
    before, _ = run(paper.recommended_filter("ci"), 3, NOISY, alive=alive)
    after, _ = run(paper.recommended_filter("ci"), 4, NOISY, alive=alive)
    _, s, belief = paper.recommended_filter("ekf").kernel_arguments(1.0)
    work = make_work(8, 8, 4, 7)
    only_its_own = np.array([True, True, True, False, True, False, False])
    epoch = Epoch(
        belief.p, belief.p, CASE.beacons.r[4], NOISY[4], only_its_own, np.ones(4, bool), np.inf
    )
    assert steps.step(steps.EKF, s, epoch, before, work)
    sigma = np.sqrt(np.diag(before.P))
    assert np.abs((after.local_x[1] - before.x) / sigma).max() < 1e-9


@pytest.mark.parametrize("bad", [-1.0, np.nan])
@pytest.mark.parametrize("algorithm", range(7))
def test_a_covariance_that_is_none_is_said(algorithm, bad):
    bank, ok = run(paper.recommended_filter("ekf"), 1, NOISY, algorithm=algorithm)
    assert ok
    _, s, belief = paper.recommended_filter("dcifaif").kernel_arguments(1.0)
    for matrix in (bank.P, bank.local_cov, bank.Y):
        matrix *= bad
    works, here = np.ones(4, bool), np.ones(7, bool)
    epoch = Epoch(belief.p, belief.p, CASE.beacons.r[2], NOISY[2], here, works, np.inf)
    assert not steps.step(algorithm, s, epoch, bank, make_work(8, 8, 4, 7))


def test_an_information_filter_needs_a_covariance_to_start_from():
    _, s, belief = paper.recommended_filter("intermittent").kernel_arguments(1.0)
    bank, work = make_bank(8, 8, 4), make_work(8, 8, 4, 7)
    start_bank(bank, belief.x0, 0 * belief.p0)
    assert not steps.start(steps.INFORMATION, s, bank, work)


@pytest.mark.parametrize("rule", sorted(RULES))
def test_every_weighting_gives_a_sound_estimate(rule):
    bank, ok = run(paper.recommended_filter("ci-feedback", weighting=rule), 3, NOISY)
    assert ok
    assert bank.weights.sum() == pytest.approx(1.0)
    assert np.linalg.eigvalsh(bank.P / np.outer(SCALE[:8], SCALE[:8])).min() > 0


def test_gate_refuses_a_spike_and_says_which():
    spiked = NOISY.copy()
    spiked[4, 5] += 5e4
    for algorithm in ("ekf", "intermittent", "federated"):
        chosen = paper.recommended_filter(algorithm).changed(gate_sigma=6.0)
        clean, _ = run(chosen, 4, NOISY, arrived=_without(4, 5))
        bank, ok = run(chosen, 4, spiked)
        assert ok
        np.testing.assert_array_equal(np.flatnonzero(bank.gated), [5])
        assert apart(clean, bank)[0] < 1e-6
        believed, _ = run(chosen.changed(gate_sigma=np.inf), 4, spiked)
        assert apart(clean, believed)[0] > 10


def _without(epoch, row):
    arrived = np.ones((301, 7), bool)
    arrived[epoch, row] = False
    return arrived


@pytest.mark.parametrize(
    "algorithm", ["ekf", "iterated", "intermittent", "ci", "ci-feedback", "dcifaif", "federated"]
)
def test_a_lost_state_is_said(algorithm):
    broken = NOISY.copy()
    broken[2, 4] = np.nan
    _, ok = run(paper.recommended_filter(algorithm), 2, broken)
    assert not ok


def test_six_and_eleven_states_keep_to_their_part():
    eight = paper.recommended_filter("ekf")
    six = eight.changed(
        p0=paper.RECOMMENDED_P0[:6], process_noise=paper.RECOMMENDED_Q[:6], scale=None
    )
    bank, ok = run(six, 5, NOISY)
    assert ok
    assert bank.P.shape == (6, 6)
    np.testing.assert_array_equal(bank.x[6:], CASE.nominal[0, 6:])
    biased = NOISY.copy()
    biased[:, :3] += np.array([0.02, -0.01, 0.03])
    eleven = eight.changed(
        p0=np.concatenate([paper.RECOMMENDED_P0, np.full(3, 1e-2)]),
        process_noise=np.concatenate([paper.RECOMMENDED_Q, np.zeros(3)]),
        scale=None,
    )
    bank, ok = run(eleven, 12, biased)
    assert ok
    # drag is about a millimetre per second squared there: what is measured is the bias
    assert np.abs((bank.x[8:] - [0.02, -0.01, 0.03]) / np.sqrt(np.diag(bank.P))[8:]).max() < 4


def test_density_may_cross_zero_on_the_linear_state():
    _, s, belief = paper.published_filter("ekf").kernel_arguments(1.0)
    work = make_work(8, 8, 4, 7)
    for rho0 in (-2e-4, 0.0):
        x, plus = belief.x0.copy(), belief.x0.copy()
        x[3:5], plus[3:5] = (5500.0, -0.2), (5500.0, -0.2)
        x[0] = plus[0] = 3440e3
        x[6], plus[6] = rho0, rho0 + 1e-6
        predict_state(s, belief.p, x, work)
        phi = work.phi.copy()
        predict_state(s, belief.p, plus, work)
        assert abs(x[6] - rho0) <= 1e-300
        assert np.all(np.isfinite(phi))
        # a chord over 1e-6 of 2e-4: second order is 5e-3 of the first
        assert (plus[3] - x[3]) / 1e-6 == pytest.approx(phi[3, 6], rel=2e-2)


def linear_case(seed):
    rng = np.random.default_rng(seed)
    n = 4
    root = rng.standard_normal((n, n))
    phi = np.eye(n) + 0.2 * rng.standard_normal((n, n))
    return (
        phi,
        root @ root.T + np.eye(n),
        rng.uniform(0.1, 1.0, n),
        rng.standard_normal((3, n)),
        rng.uniform(0.5, 2.0, 3),
        rng.standard_normal(n),
        rng.standard_normal(3),
    )


@pytest.mark.parametrize("seed", range(3))
def test_information_step_is_stone_soup_s(seed):
    from datetime import datetime, timedelta

    from stonesoup.models.measurement.linear import LinearGaussian
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.information import InformationKalmanPredictor
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import InformationState
    from stonesoup.updater.information import InformationKalmanUpdater

    phi, p0, q, big_h, r, x0, z = linear_case(seed)
    y0 = np.linalg.inv(p0)
    then = datetime(2030, 1, 1)
    motion = LinearGaussianTimeInvariantTransitionModel(
        transition_matrix=phi, covariance_matrix=np.diag(q)
    )
    sensor = LinearGaussian(ndim_state=4, mapping=(0, 1, 2), noise_covar=np.diag(r))
    sensor.matrix = lambda **_: big_h
    prior = InformationState(state_vector=(y0 @ x0)[:, None], precision=y0, timestamp=then)
    predicted = InformationKalmanPredictor(motion).predict(
        prior, timestamp=then + timedelta(seconds=1)
    )
    seen = Detection(z[:, None], timestamp=then + timedelta(seconds=1), measurement_model=sensor)
    updated = InformationKalmanUpdater(sensor).update(SingleHypothesis(predicted, seen))

    work, bank = make_work(4, 4, 0, 0), make_bank(4, 4, 0)
    s = _settings(4, q, r)
    start_bank(bank, x0, p0)
    assert information_start(s, bank, work)
    work.phi[:, :] = phi
    assert predict_information(s, bank.Y, work)
    np.testing.assert_allclose(4 * bank.Y, np.asarray(predicted.precision), rtol=0, atol=1e-11)
    bank.x[:] = phi @ x0
    work.big_h[:, :] = big_h
    work.h[:] = big_h @ bank.x
    work.used[:] = True
    assert add_information(s, z, bank, work)
    np.testing.assert_allclose(4 * bank.Y, np.asarray(updated.precision), rtol=0, atol=1e-11)
    mean = np.linalg.solve(np.asarray(updated.precision), np.asarray(updated.state_vector)[:, 0])
    np.testing.assert_allclose(bank.x, mean.astype(float), rtol=0, atol=1e-11)


def _settings(n, q, r):
    return Settings(
        n, False, 1.0, q, np.asarray(r), np.empty(0), np.full(n, 0.5), np.inf, 0.0, EQUAL, 1e-3, 1
    )

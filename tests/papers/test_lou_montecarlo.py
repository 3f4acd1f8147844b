"""The papers' Monte Carlo: reproducible, streaming, honest about divergence; filters' settings checked."""

from dataclasses import fields, replace

import numpy as np
import pytest

from compass.core.papers.lou_measurement import predict_measurements
from compass.core.papers.lou_montecarlo import fly, make_trace, run_block
from compass.core.papers.spherical import BANK, rk4_step
from compass.entry.beacons import Beacons
from compass.entry.consistency import nees_bounds
from compass.entry.faults import Fault
from compass.errors import ArgumentError
from compass.papers import lou2017_case
from compass.papers import lou2019_case as paper
from compass.papers.lou_montecarlo import BLOCK, _draws, _empty_tally, monte_carlo


def shortened(case, epochs):
    b = case.beacons
    beacons = Beacons(b.names, b.times[:epochs], b.r[:epochs], b.v[:epochs], b.moving)
    arrival = None if case.arrival is None else case.arrival[:epochs]
    return replace(case, beacons=beacons, arrival=arrival)


EPS = np.finfo(float).eps
SHORT = shortened(paper.case(noisy_truth=True), 7)
EKF = paper.recommended_filter("ekf")


def same(a, b):
    for name in a.data_vars:
        np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=name)


def test_threads_do_not_change_the_numbers():
    runs = BLOCK + 5
    one = monte_carlo(SHORT, EKF, runs, seed=3, threads=1)
    same(one, monte_carlo(SHORT, EKF, runs, seed=3, threads=3))
    assert not np.array_equal(one.rmse, monte_carlo(SHORT, EKF, runs, seed=4).rmse)
    assert one.attrs["diverged"] == 0


def test_streaming_statistics_are_those_of_all_the_runs():
    """Each run alone, then NumPy over all of them."""
    runs = BLOCK + 3
    data = monte_carlo(SHORT, EKF, runs, seed=9)
    number, kernel_settings, belief = EKF.kernel_arguments(1.0)
    world = SHORT.world()
    errors, variances, nees, miss = [], [], [], []
    normals, uniforms = _draws(9, 0, runs, 6, 4)
    for k in range(runs):
        trace = make_trace(8, 8, 7, 4)
        one, end, last = slice(k, k + 1), np.empty(1, np.int64), np.zeros((1, 8))
        run_block(
            number, kernel_settings, world, belief, normals[one], uniforms[one], trace,
            _empty_tally(7, 8, 4), end, last,
        )  # fmt: skip
        assert end[0] == -1
        errors.append(trace.error.copy())
        variances.append(np.diagonal(trace.cov, axis1=1, axis2=2))
        nees.append(trace.nees.copy())
        r, lat = trace.truth[-1, 0], trace.truth[-1, 2]
        miss.append(errors[-1][-1, [1, 2, 0]] * [r * np.cos(lat), r, 1.0])
    e, v = np.array(errors), np.array(variances)
    np.testing.assert_allclose(data.rmse, np.sqrt((e**2).mean(0)), rtol=1e-12)
    np.testing.assert_allclose(data.bias, e.mean(0), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(data.sigma, np.sqrt(v.mean(0)), rtol=1e-12)
    np.testing.assert_allclose(data.capture, (e**2 <= 9 * v).mean(0), rtol=1e-12)
    np.testing.assert_allclose(data.nees, np.mean(nees, axis=0), rtol=1e-10)
    np.testing.assert_allclose(data.miss, np.mean(miss, axis=0), rtol=1e-9)
    np.testing.assert_allclose(data.miss_covariance, np.cov(np.array(miss).T), rtol=1e-9)


def test_start_errors_have_the_covariance_they_are_drawn_from():
    runs = 400
    two = shortened(paper.case(), 2)
    data = monte_carlo(two, EKF, runs, seed=1)
    sigma = np.sqrt(paper.RECOMMENDED_P0)
    # a standard deviation from 400 draws is good to 1/sqrt(800) = 3.5 %
    np.testing.assert_allclose(data.rmse[0] / sigma, 1.0, atol=5 * 0.0354)
    low, high = nees_bounds(8, runs, 1 - 1e-6)
    assert low <= float(data.nees[0]) <= high


def test_runs_do_not_depend_on_how_many_there_are_or_on_the_filter():
    a = monte_carlo(SHORT, EKF, 1, seed=5)
    b = monte_carlo(SHORT, paper.recommended_filter("federated"), 1, seed=5)
    np.testing.assert_allclose(a.rmse[1:], b.rmse[1:], rtol=1e-4)
    np.testing.assert_array_equal(a.arrival, b.arrival)


def test_every_error_is_a_draw_of_its_own():
    """What is added to the states and to what is measured of them, one by one, is what was drawn."""
    world = SHORT.world()
    normals, uniforms = _draws(9, 0, 1, 6, 4)
    trace = make_trace(8, 8, 7, 4)
    fly(1.0, world, normals[0], uniforms[0], trace)
    p, moved = world.p.copy(), np.empty(8)
    z, slopes = np.empty(7), np.empty((7, 8))
    sigma = np.concatenate([world.noise, world.acc_sigma, world.range_sigma])
    offset = np.zeros((7, 7))
    offset[:, :3], offset[:, 3:] = world.bias, world.offset
    assert trace.arrived[1:].all() and (sigma > 0.0).all()
    for k, drawn in enumerate(normals[0, 11:].reshape(6, 15), start=1):
        p[BANK] = world.bank[k - 1]
        rk4_step(trace.truth[k - 1], p, 1.0, moved)
        p[BANK] = world.bank[k]
        predict_measurements(trace.truth[k], 8, p, False, world.beacons[k], z, slopes)
        added = np.concatenate([trace.truth[k] - moved, trace.z[k] - z - offset[k]])
        size = np.abs(np.concatenate([moved, z])) + np.abs(added)
        # each of a few sums is off by its last digit at most
        np.testing.assert_array_less(np.abs(added - sigma * drawn), 4 * EPS * size + 1e-300)


def test_what_does_not_arrive_is_counted_and_skipped():
    dark = monte_carlo(SHORT, EKF, 2, faults=[Fault("outage", "surface 1", 3, 4)])
    assert dark.arrival.sel(sensor="surface 1").values.tolist()[1:] == [1, 1, 0, 0, 1, 1]
    none = monte_carlo(SHORT, EKF, 2, faults=[Fault("all-ranges-lost")])
    assert not none.arrival[1:, 3:].any()
    assert none.position_rmse[-1] > 100 * dark.position_rmse[-1]


def test_a_silent_bias_is_caught_by_the_gate_and_reported():
    faults = [Fault("bias", "orbiter 2", 3, size=5000.0)]
    blind = monte_carlo(SHORT, EKF, 6, faults=faults)
    gated = monte_carlo(SHORT, EKF.changed(gate_sigma=5.0), 6, faults=faults)
    assert gated.refused.sel(sensor="orbiter 2")[3:].values.min() > 0.8
    times = 6 * gated.refused.values  # one run is one refusal
    np.testing.assert_allclose(times, np.round(times), atol=1e-12)
    assert times.max() <= 6
    assert gated.position_rmse[-1] < 0.2 * blind.position_rmse[-1]


def test_the_gate_is_open_until_it_is_shut():
    faults = [Fault("bias", "orbiter 2", 3, size=5000.0)]
    late = EKF.changed(gate_sigma=5.0, gate_start=5.0)
    data = monte_carlo(SHORT, late, 4, faults=faults)
    assert not data.refused[:5].any()
    assert data.refused[5:].any()


def test_the_gate_goes_by_time_and_not_by_epochs():
    b = SHORT.beacons
    half = replace(SHORT, beacons=Beacons(b.names, b.times / 2, b.r, b.v, b.moving))
    late = EKF.changed(gate_sigma=5.0, gate_start=2.5)
    data = monte_carlo(half, late, 4, faults=[Fault("bias", "orbiter 2", 1, size=5000.0)])
    assert not data.refused[:5].any()
    assert data.refused[5].any()


def test_a_run_that_diverges_is_told_and_the_others_go_on():
    trusting = paper.recommended_filter("information")
    faults = [Fault("all-ranges-lost", start=3)]
    data = monte_carlo(SHORT, trusting, 5, faults=faults)
    assert data.attrs["diverged"] == 5, data.attrs
    assert "information: diverged at" in data.attrs["divergences"][0]
    assert "radius" in data.attrs["divergences"][0]
    assert np.isnan(data.rmse.values).all()
    half = replace(SHORT, arrival=np.where(np.arange(7)[:, None] == 5, 0.8, 1.0))
    some = monte_carlo(half, trusting, 12, seed=2)
    assert 0 < some.attrs["diverged"] < 12
    assert np.isfinite(some.rmse.values).all()


def test_six_states_draw_the_errors_of_what_they_take_as_known():
    case = shortened(lou2017_case.case(), 3)
    settings = lou2017_case.six_state_filter("intermittent")
    data = monte_carlo(case, settings, 3)
    assert data.sizes["state"] == 6
    with pytest.raises(ArgumentError, match="parameter_sigma"):
        EKF.changed(parameter_sigma=(0.1, 0.0))


def test_linear_density_is_judged_as_linear():
    case = shortened(paper.case(), 3)
    data = monte_carlo(case, paper.published_filter("ekf"), 2)
    assert "rho0" in data.state.values
    assert data.rmse.sel(state="rho0")[0] == pytest.approx(2e-5, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"algorithm": "magic"}, "algorithm = 'magic'"),
        ({"weighting": "best"}, "weighting = 'best'"),
        ({"process_noise": np.ones(7)}, "process_noise: 7 values"),
        ({"process_noise": -np.ones(8)}, "every variance must be 0 or more"),
        ({"p0": np.zeros(8)}, "variance of radius = 0: not positive definite"),
        ({"p0": np.ones((8, 8))}, "not positive definite"),
        ({"p0": np.ones(6)}, "p0: shape"),
        ({"p0": np.triu(np.ones((8, 8)))}, "symmetric"),
        ({"start": np.zeros(7)}, "start"),
        ({"start": np.full(6, np.nan)}, "start"),
        ({"acceleration_variance": np.ones(2)}, "acceleration_variance: 2 values"),
        ({"range_variance": np.zeros(4)}, "range_variance: every variance must be positive"),
        ({"scale": np.ones(3)}, "scale: give 8"),
        ({"weight_floor": 0.0}, "weight_floor = 0.0"),
        ({"gate_sigma": 0.0}, "gate_sigma"),
        ({"iterations": 0}, "iterations = 0"),
    ],
)
def test_bad_settings_are_refused(changes, message):
    with pytest.raises(ArgumentError, match=message):
        EKF.changed(**changes)


def test_bad_experiments_are_refused():
    with pytest.raises(ArgumentError, match="runs = 0: allowed 1 to"):
        monte_carlo(SHORT, EKF, 0)
    with pytest.raises(ArgumentError, match="range_variance: 1 values for 4 beacons"):
        monte_carlo(SHORT, EKF.changed(range_variance=[1.0]), 1)


def test_settings_are_what_they_say():
    assert EKF.states == 8
    assert paper.recommended_filter("ci").chosen_weighting == "determinant"
    assert paper.recommended_filter("dcifaif").chosen_weighting == "fast"
    gated = EKF.changed(gate_sigma=3.0)
    assert gated.gate_sigma == 3.0
    before, after = (
        {f.name: getattr(settings, f.name) for f in fields(settings)} for settings in (EKF, gated)
    )
    others = [
        name
        for name, value in before.items()
        if not (after[name] is value or np.array_equal(after[name], value))
    ]
    assert others == ["gate_sigma"]

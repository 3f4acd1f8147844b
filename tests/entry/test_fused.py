"""Fused filters: against each other, against the plain filter and the papers' own, turned."""

from dataclasses import replace
from types import SimpleNamespace
from typing import get_args

import numpy as np
import pytest

from compass.core.entry.fuse import fuse_run
from compass.core.entry.groups import Told
from compass.core.entry.measure import acceleration_row, ideal_values
from compass.core.entry.rates import World, through_air
from compass.entry.beacons import surface_beacons
from compass.entry.consistency import nees_bounds
from compass.entry.covariance import axes_covariance
from compass.entry.faults import Fault
from compass.entry.filters import Filter
from compass.entry.fused import FusedFilter
from compass.entry.fused_runs import BLOCK, monte_carlo
from compass.entry.inertial import InertialCase
from compass.entry.instruments import Features, Instrument
from compass.entry.layout import Layout
from compass.entry.radio import ElectronTable
from compass.entry.schedule import Measurements
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError
from compass.papers import lou2019_case, lou_montecarlo
from tests.entry.one_run import run_filter

TIMES = np.arange(0.0, 14.0, 2.0)
NOISE = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10, 1e-6, 1e-6])


def case_of(model, state, beacons=None, **changes):
    flight = fly(model, state, TIMES)
    lat, lon = np.array([[-0.47, -1.43], [-0.49, -1.5], [-0.40, -1.52]]).T
    radius = model.planet_radius
    here = beacons or surface_beacons(lat, lon, TIMES, planet_radius=radius, height=3e5)
    values = {
        "name": "short",
        "flight": flight,
        "beacons": here,
        "measurements": Measurements(),
        "sigma": np.tile([5.0, np.nan], (here.size, 1)),
        "imu_sigma": np.full(3, 1e-3),
        "imu_bias": np.zeros(3),
        "noise": NOISE,
    }
    return InertialCase(**values | changes)


@pytest.fixture(scope="module")
def case(world, table2):
    return case_of(world("none"), table2)


@pytest.fixture(scope="module")
def low(table2):
    """A start 60 km up, where the air is felt."""
    return table2 - [61e3, 0, 0, 0, 0, 0]


def filter_of(case, algorithm="ekf", **changes):
    values = {
        "algorithm": algorithm,
        "model": case.flight.model,
        "first": case.flight.path[0],
        "covariance0": axes_covariance(1000.0, 10.0),
        "further": np.array([0.04, 4e-4]),
        "noise": NOISE,
        "imu_variance": np.full(3, 1e-6),
        "random_start": True,
    }
    return FusedFilter(**values | changes)


@pytest.mark.parametrize("winds", [(), ((3.4e6, 90.0, -30.0), (3.6e6, -80.0, 60.0))])
def test_rows_of_accelerometers_are_their_derivatives(world, table2, winds):
    """In still air against the formula, and in winds that change with height too."""
    model = world("none", bank_angles=(0.7,))
    model = replace(model, atmosphere=replace(model.atmosphere, winds=winds))
    x = np.concatenate([cartesian_of(table2), [0.1, 0.02], [1e-3, 2e-3, 3e-3]])
    places = np.array([11, 6, 7, -1, -1, 8])
    p, angle = model.flight_parameters(), (np.cos(0.7), np.sin(0.7))

    def read(x, rows):
        there = World(p, x[6], 0.156 + x[7])
        return np.array([acceleration_row(k, x, there, *angle, places, rows[k]) for k in range(3)])

    rows = np.zeros((3, 11))
    here = read(x, rows)
    drag = 0.5 * model.atmosphere.density(np.linalg.norm(x[:3])) * np.exp(0.1) * 0.016
    through = np.array(through_air(x, p))
    assert (np.linalg.norm(through - x[3:6]) > 1.0) == bool(winds)
    drag *= through @ through
    lift = (0.156 + 0.02) * drag
    expected = [-drag + 1e-3, -lift * angle[1] + 2e-3, lift * angle[0] + 3e-3]
    np.testing.assert_allclose(here, expected, rtol=1e-12)
    for j, step in enumerate([10.0] * 3 + [0.1] * 3 + [1e-4] * 5):
        d = step * np.eye(11)[j]
        slope = (read(x + d, np.zeros((3, 11))) - read(x - d, np.zeros((3, 11)))) / (2 * step)
        np.testing.assert_allclose(
            rows[:, j], slope, rtol=1e-6, atol=1e-9 * np.abs(rows[:, j]).max()
        )


def test_one_filter_without_accelerometers_is_the_plain_filter(case):
    """The kernel that lands, given the same readings of everything there is."""
    kinds = (
        Instrument("two_way_range", 7.0),
        Instrument("altimeter", 10.0),
        Instrument("velocimeter", 0.2, interval=4.0),
        Instrument("features", 1e-3),
    )
    known = filter_of(case, further=np.empty(0), noise=np.zeros(6), random_start=False)
    deaf = replace(known, imu_variance=np.full(3, 1e30))
    rng, sigma = np.random.default_rng(0), np.array([5.0, 0.1])
    lat, lon = case.flight.states[-1, 2], case.flight.states[-1, 1]
    seen = Features(("a", "b"), (lat, lat - 0.02), (lon, lon + 0.03), (0.0, 1e3))
    measured = Measurements(*sigma, instruments=kinds, features=seen)
    both = replace(case, sigma=np.tile(sigma, (3, 1)), measurements=measured)
    path = np.ascontiguousarray(case.flight.path)
    sources, variances, numbers = measured.heard(
        case.beacons, case.visible, path, case.flight.model
    )
    z = np.empty(variances.shape)
    model, nothing = case.flight.model, Layout().numbers()
    p, bank = model.flight_parameters(), model.vehicle.bank_schedule()
    times = np.array(case.times)
    ideal_values(path, sources, numbers, nothing, p, bank, times, z)
    z += np.sqrt(np.nan_to_num(variances)) * rng.standard_normal(z.shape)
    first = case.flight.path[0] + np.repeat([300.0, 3.0], 3)
    states, covariances = run_filter(
        case.flight.model, first, case.beacons, case.visible, measured,
        Filter(known.covariance0, np.zeros(6)), z,
    )  # fmt: skip
    rows = np.pad(np.where(np.isnan(variances), np.nan, z), ((0, 0), (0, 0), (0, 3)))
    rows[:, :-1, -3:] = np.nan
    xs, ps = np.empty((TIMES.size, 6)), np.empty((TIMES.size, 6, 6))
    alive = np.ones((TIMES.size, 3), dtype=bool)
    end = fuse_run(
        deaf.arrangement(), deaf.problem(both), first, deaf.covariance, rows, alive,
        Told(xs, ps, np.empty((TIMES.size, 3)), np.empty(rows.shape, dtype=bool)),
    )  # fmt: skip
    assert end == -1
    sigmas = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    np.testing.assert_allclose(np.sqrt(np.diagonal(ps, axis1=1, axis2=2)), sigmas, rtol=1e-9)
    assert np.abs((xs - states) / sigmas).max() < 1e-6


@pytest.mark.slow
def test_claims_are_those_of_the_papers_own_filter():
    """Eight spherical states and another dynamics: the same covariance at the end, turned."""
    theirs = lou2019_case.case(noisy_truth=True)
    model = theirs.truth
    ours = InertialCase(
        "lou2019", fly(model, theirs.start, theirs.times), theirs.beacons, Measurements(),
        np.stack([theirs.range_sigma, np.full(4, np.nan)], axis=1), np.full(3, 1e-3), np.zeros(3),
        theirs.process_noise,
    )  # fmt: skip
    from compass.entry.views import spherical_jacobian

    first = cartesian_of(theirs.start)
    turned = spherical_jacobian(first) * np.sqrt(lou2019_case.RECOMMENDED_P0[:6])
    for algorithm in ("ekf", "ci-feedback", "dcifaif"):
        settings = filter_of(
            ours, algorithm, covariance0=turned @ turned.T, first=first,
            further=lou2019_case.RECOMMENDED_P0[6:],
        )  # fmt: skip
        mine = monte_carlo(ours, settings, 8, 1)[0].claimed_covariance
        own = lou2019_case.recommended_filter(algorithm)
        other = lou_montecarlo.monte_carlo(theirs, own, 8, 1).claimed_covariance
        # 8 flights of each, each linearised about its own estimates
        np.testing.assert_allclose(np.sqrt(np.diag(mine)), np.sqrt(np.diag(other)), rtol=0.01)


def test_federated_is_the_filter_that_hears_all(case):
    one, shared = (
        monte_carlo(case, filter_of(case, name), 3, 4)[0] for name in ("ekf", "federated")
    )
    np.testing.assert_allclose(shared.rmse, one.rmse, rtol=1e-5)
    np.testing.assert_allclose(shared.sigma, one.sigma, rtol=1e-6)
    np.testing.assert_allclose(shared.weight, 1 / 3)
    skips = monte_carlo(case, filter_of(case, "intermittent"), 3, 4)[0]
    np.testing.assert_array_equal(skips.rmse, one.rmse)


def test_a_turned_entry_is_the_same_entry(case, world, table2):
    """Over the pole too: a planet at rest knows no direction."""
    over = table2 * [1, 1, 0, 1, 1, 0] + [0, 0, np.radians(89.8), 0, 0, 0]
    plain = table2 * [1, 1, 0, 1, 1, 0] + [0, 0, 0.1, 0, 0, 0]
    model = world("none")
    found = []
    lat, lon = plain[2], plain[1]
    for state in (plain, over):
        turn = cartesian_axes(state) @ cartesian_axes(plain).T
        flat = surface_beacons(
            lat + np.array([0.1, 0.05, -0.05]), lon + np.array([0.1, -0.1, 0.0]), TIMES,
            planet_radius=model.planet_radius, height=3e5,
        )  # fmt: skip
        here = case_of(model, state, replace(flat, r=flat.r @ turn.T), noise=np.zeros(8))
        settings = filter_of(here, "dcifaif", noise=np.zeros(8), random_start=False)
        aside = replace(settings, first=here.flight.path[0] + np.kron(np.eye(2), turn) @ SHIFT)
        found.append(monte_carlo(here, aside, 2, 7)[0])
    assert spherical_of(case_of(model, over, flat).flight.path[-1])[2] < np.radians(89.8)
    np.testing.assert_allclose(found[1].rmse, found[0].rmse, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(found[1].sigma, found[0].sigma, rtol=1e-6)


SHIFT = np.array([500.0, -300.0, 200.0, 3.0, 2.0, -1.0])


def cartesian_axes(state):
    """Columns up, along and to the right of a state."""
    x = cartesian_of(state)
    up = x[:3] / np.linalg.norm(x[:3])
    right = np.cross(x[3:], up)
    right /= np.linalg.norm(right)
    return np.stack([up, np.cross(up, right), right], axis=1)


def test_at_a_switch_accelerometers_read_the_bank_from_then_on(world, low):
    """Of truth and filter alike, ranges good to 1 cm: claims hold at the switch and after it."""
    model = world("none", bank_times=(0.0, 6.0), bank_angles=(0.5, -0.9))
    case = case_of(model, low, noise=np.zeros(8), sigma=np.tile([0.01, np.nan], (3, 1)))
    settings = filter_of(case, "iterated", noise=np.zeros(8))
    data, first = monte_carlo(case, settings, 8)
    assert data.attrs["diverged"] == 0
    small, great = nees_bounds(8, 8, 1 - 1e-4)
    assert np.all((data.nees > small) & (data.nees < great))
    # a filter that reads the accelerometers by the bank until then: off by more than it claims
    late = replace(model.vehicle, bank_times=(0.0, 6.0 + 1e-6))
    wrong = replace(settings, model=replace(model, vehicle=late))
    assert monte_carlo(case, wrong, 8)[0].nees[3] > 100 * great
    assert np.isfinite(first.error).all()


def test_threads_and_runs_do_not_change_the_numbers(case):
    runs = BLOCK + 3
    ekf = filter_of(case)
    one, single = monte_carlo(case, ekf, runs, 3, threads=1)
    two = monte_carlo(case, ekf, runs, 3, threads=3)[0]
    for name in one.data_vars:
        np.testing.assert_array_equal(one[name].values, two[name].values)
    alone, same = monte_carlo(case, ekf, 1, 3)
    np.testing.assert_array_equal(single.error, same.error)
    np.testing.assert_allclose(alone.rmse, np.abs(same.error), rtol=1e-12)
    # 35 draws of three numbers: 17 % by four standard deviations, halved for the root, and some
    assert one.position_rmse[0] < 40  # three ranges of 5 m at the first epoch already
    assert one.attrs["diverged"] == 0


@pytest.mark.parametrize("algorithm", ["ci", "ci-feedback", "dcifaif", "federated"])
def test_dead_subsystems_wait_and_come_back(case, algorithm):
    dead = [Fault("subsystem-dead", name, 4.0, 6.0) for name in case.beacons.names]
    data = monte_carlo(case, filter_of(case, algorithm), 2, faults=dead)[0]
    some = monte_carlo(case, filter_of(case, algorithm), 2, faults=dead[:1])[0]
    assert data.sigma[3, 0] > data.sigma[1, 0] and data.sigma[5, 0] < data.sigma[3, 0]
    assert some.weight[2, 0] == 0 and some.weight[5, 0] > 0
    np.testing.assert_allclose(some.weight[1:].sum("beacon"), 1.0)


def test_what_is_lost_refused_or_silent_is_told(case):
    ekf = filter_of(case)
    dark = monte_carlo(case, ekf, 2, faults=[Fault("outage", "B1", 4, 6)])[0]
    assert dark.arrival.sel(sensor="B1").values.tolist() == [1, 1, 0, 0, 1, 1, 1]
    wrong = [Fault("bias", "B2", 6, size=5000.0)]
    blind = monte_carlo(case, ekf, 3, faults=wrong)[0]
    gated = monte_carlo(case, replace(ekf, gate_sigma=6.0, gate_start=4.0), 3, faults=wrong)[0]
    assert gated.refused.sel(sensor="B2")[3:].values.min() == 1 and not gated.refused[:2].any()
    assert blind.attrs["diverged"] or gated.position_rmse[-1] < 0.2 * blind.position_rmse[-1]
    trusting = filter_of(case, "information")
    lost, first = monte_carlo(case, trusting, 2, faults=[Fault("all-ranges-lost", start=4)])
    assert lost.attrs["diverged"] == 2 and np.isnan(lost.rmse.values).all()
    assert lost.attrs["divergences"][0].startswith("run 0: information: ")
    assert first.attrs["divergence"]
    table = ElectronTable((0.0, 2e5), (1e20, 1e20))
    through = case.through_plasma(table)
    assert through.arrival.max() < 1e-7
    assert not monte_carlo(through, ekf, 1)[0].arrival[:, 3:].any()


def test_a_covariance_that_is_none_is_lost(case):
    bad = filter_of(case, noise=np.concatenate([NOISE[:6], [1e300, 1e300]]))
    for name in ("ekf", "federated"):
        data, first = monte_carlo(case, replace(bad, algorithm=name), 1)
        assert data.attrs["diverged"] == 1 and np.isnan(first.nees.values[-1])


def test_six_states_take_density_and_lift_as_known(world, low):
    case = case_of(world("none"), low)
    sure = filter_of(case, further=np.empty(0), noise=NOISE[:6], imu_variance=np.full(3, 1.0))
    vague = replace(sure, known_to=(0.2, 0.02))
    ends = [monte_carlo(case, each, 4, 2)[0].position_rmse[-1] for each in (sure, vague)]
    assert ends[1] > 1.05 * ends[0]
    wrong = replace(
        filter_of(case),
        model=replace(
            case.flight.model, atmosphere=case.flight.model.atmosphere.of_density(2.4e-4)
        ),
    )
    np.testing.assert_allclose(wrong.offset(case)[:, 6], -np.log(1.2))
    far = case.flight.states + 9e9 * np.eye(1, 8)  # where both densities are 0
    flight = SimpleNamespace(model=case.flight.model, states=far)
    out = wrong.offset(SimpleNamespace(flight=flight, times=case.times, imu_bias=case.imu_bias))
    np.testing.assert_allclose(out[:, 6], -np.log(1.2), rtol=1e-6)


def test_bad_cases_and_settings_are_refused(case, world, table2):
    with pytest.raises(ArgumentError, match="at one place"):
        case_of(world("none"), table2, case.beacons.chosen([0, 0]))
    with pytest.raises(ArgumentError, match="before the last epoch at 12 s; shorten"):
        case_of(world("none"), table2 - [118e3, 0, 0, 0, 1, 0])
    with pytest.raises(ArgumentError, match="not positive definite"):
        filter_of(case, covariance0=np.zeros((6, 6)))
    with pytest.raises(ArgumentError, match="values; give 6"):
        filter_of(case, further=np.ones(3))
    with pytest.raises(ArgumentError, match="known_to"):
        filter_of(case, known_to=(0.1, 0.0))
    with pytest.raises(ArgumentError, match="runs = 0: allowed"):
        monte_carlo(case, filter_of(case), 0)


def test_every_algorithm_of_files_is_one_record():
    from compass.entry.fused_kinds import KINDS_OF_FILTER, Algorithm

    assert get_args(Algorithm) == tuple(KINDS_OF_FILTER)

"""The papers' entries: check values along the flights, visibility, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compass.core.papers.spherical import entry_rates
from compass.entry.radio import STAGNATION, WAKE, ElectronTable, critical_density, crossing_times
from compass.errors import ArgumentError
from compass.papers import lou2017_case, lou2019_case
from compass.papers.lou_case import Imu, beacons_from_states
from compass.papers.spherical import spherical_parameters

TIMES = np.arange(11.0)
NAMES = ("a", "b")


def exact(case, seconds):
    """State of the flow itself, by an integrator that adapts its steps."""

    def rates(_, x):
        out = np.empty(8)
        entry_rates(x, spherical_parameters(case.truth), out)
        return out

    start = case.nominal[0]
    return solve_ivp(rates, (0, seconds), start, method="DOP853", rtol=1e-13, atol=1e-9).y[:, -1]


def test_lou2019_flight_at_100_s():
    case = lou2019_case.case()
    expected = [3433267.35809352, 0.153831568353, 4637.78559565, -0.0876876241801]
    np.testing.assert_allclose(exact(case, 100)[[0, 2, 3, 4]], expected, rtol=2e-11)
    # one fourth-order step a second: what the filters and their truth take
    np.testing.assert_allclose(case.nominal[100, [0, 2, 3, 4]], expected, rtol=2e-8)


def test_lou2017_flight():
    case = lou2017_case.case(plasma=False)
    expected = [3431667.75229, 5275.61427847, -0.193232435586]
    np.testing.assert_allclose(exact(case, 64)[[0, 3, 4]], expected, rtol=2e-11)
    np.testing.assert_allclose(case.nominal[64, [0, 3, 4]], expected, rtol=5e-8)
    last = case.nominal[-1]
    assert (last[0] - 3397.2e3) / 1e3 == pytest.approx(9.16, abs=5e-3)
    assert last[3] == pytest.approx(221.07, abs=5e-3)
    drag = 0.5 * case.density * 0.016 * case.nominal[:, 3] ** 2
    assert drag.argmax() == 74
    assert drag.max() == pytest.approx(152.6, abs=0.05)


def test_every_beacon_is_hidden_from_the_printed_start():
    printed, seen = lou2019_case.case(lou2019_case.PRINTED_POINT), lou2019_case.case()
    assert not printed.visible.any()
    assert seen.visible.all()
    assert not printed.world().arrival.any()
    assert printed.world(see_through=True).arrival.all()
    assert lou2017_case.case().visible.sum(axis=0).tolist() == [44, 251, 251]


@pytest.mark.parametrize(
    ("model", "fade", "lost"),
    [
        (STAGNATION, (5.98, 97.74), (15.20, 91.44)),
        (WAKE, (30.33, 87.22), (40.54, 80.74)),
    ],
)
def test_blackout_begins_and_ends_when_published(model, fade, lost):
    case = lou2017_case.case(plasma=False)
    n = case.electrons(model)
    # check values to 0.01 s (from a finer interpolation); the paper's own within 1 s
    np.testing.assert_allclose(crossing_times(case.times, n, 3.08e14), fade, atol=0.011)
    np.testing.assert_allclose(crossing_times(case.times, n, critical_density()), lost, atol=0.011)


def test_plasma_lets_ranges_through_now_and_then():
    case = lou2017_case.case()
    beta = case.arrival[:, 0]
    partial = (beta < 1) & (beta > 1.0001e-8)
    assert partial.sum() == 17
    assert beta[partial].sum() == pytest.approx(6.5, abs=0.05)
    table = ElectronTable((0.0, 100e3), (1e10, 1e10))
    assert np.all(lou2017_case.case(plasma=False).through_plasma(table).arrival == 1.0)


def test_orbiters_move_as_kepler_says():
    gm, r = 4.282829e13, 7e6
    speed = np.sqrt(gm / r)
    found = beacons_from_states(
        NAMES, [[r, 0, 0], [4e6, 0, 0]], [[0, speed, 0], [0, 0, 0]], TIMES, gm
    )
    angle = speed / r * TIMES
    expected = r * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    np.testing.assert_allclose(found.r[:, 0], expected, rtol=0, atol=1e-5)
    assert found.moving.tolist() == [True, False]
    assert np.all(found.r[:, 1] == [4e6, 0, 0])


def test_bad_cases_are_refused():
    case = lou2019_case.case()
    twins = beacons_from_states(NAMES, [[4e6, 0, 0], [4e6, 0, 0]], np.zeros((2, 3)), TIMES, 4.28e13)
    uneven = beacons_from_states(("a",), [[4e6, 0, 0]], [[0, 0, 0]], np.array([0.0, 1, 3]), 4.28e13)
    for changes, message in (
        ({"beacons": twins, "range_sigma": np.ones(2)}, "beacons a and b: at one place"),
        ({"beacons": uneven, "range_sigma": np.ones(1)}, "evenly spaced"),
        ({"range_sigma": np.array([1.0, 1, 1, -1])}, "range_sigma"),
        ({"process_noise": -np.ones(8)}, "process_noise"),
        ({"arrival": np.full((301, 1), 1.5)}, "arrival probability = 1.5"),
    ):
        with pytest.raises(ArgumentError, match=message):
            replace(case, **changes)
    buried = replace(case, start=np.array([3398e3, 0, 0, 5515.0, -0.5, 0.1]))
    with pytest.raises(ArgumentError, match="the flight ends at 1 s"):
        buried.nominal  # noqa: B018


def test_bad_sensors_are_refused():
    with pytest.raises(ArgumentError, match=r"sigma = -1\.0"):
        Imu((1e-3, -1.0, 1e-3))
    with pytest.raises(ArgumentError, match="bias = inf"):
        Imu(bias=(0.0, np.inf, 0.0))

"""The companions' papers: every row judged, and the Monte Carlo figures behind them."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from compass.entry.beacons import Beacons
from compass.entry.consistency import nees_bounds
from compass.entry.faults import Fault
from compass.entry.montecarlo import monte_carlo
from compass.papers import lou2017, lou2017_case, lou2019, lou2019_case, lou2019_runs

RUNS = 300


def settled(data):
    return float(data.position_rmse[50:].mean())


@pytest.mark.slow
def test_every_row_of_2019_holds():
    rows = lou2019.rows()
    assert len(rows) == 28
    assert all(row.holds for row in rows)
    verdicts = {row.item: row.verdict.split(":")[0] for row in rows}
    assert verdicts["order of position RMSE, settings as printed"] == "reproduced"
    assert verdicts["EKF after the last orbiter falls silent at 200 s"] == "erratum"
    assert verdicts["CPU time of one step, one core"] == "erratum"


@pytest.mark.slow
def test_every_row_of_2017_holds():
    rows = lou2017.rows()
    assert all(row.holds for row in rows)
    crossings = [row for row in rows if row.unit == "s" and "signal" in row.item]
    assert len(crossings) == 8
    assert all(row.verdict == "reproduced" for row in crossings)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("linear", "expected"),
    [
        (True, {"ekf": 9.17, "dcifaif": 9.29, "ci": 109.0}),
        (False, {"ekf": 9.15, "dcifaif": 16.4, "ci": 18.7e3}),
    ],
)
def test_published_settings_give_the_spec_s_errors(linear, expected):
    case = lou2019_case.case(bias=-0.03)
    for algorithm, value in expected.items():
        settings = lou2019_case.published_filter(algorithm, linear=linear)
        # the diverging CI is ruled by few runs: two seeds at 300 runs give 98 and 108 m
        runs, share = (100, 0.12) if algorithm == "ci" else (RUNS, 0.04)
        found = settled(monte_carlo(case, settings, runs, 1))
        assert found == pytest.approx(value, rel=share)


@pytest.mark.slow
def test_recommended_settings_give_the_spec_s_errors_and_are_consistent():
    case = lou2019_case.case(noisy_truth=True)
    found = {}
    for algorithm, error, nees in (
        ("ekf", 3.72, None),
        ("federated", 3.72, None),
        ("iterated", None, None),
        ("ci-feedback", 4.15, 6.64),
        ("dcifaif", 8.42, 3.30),
    ):
        data = monte_carlo(case, lou2019_case.recommended_filter(algorithm), RUNS, 1)
        found[algorithm] = data
        if error:
            assert settled(data) == pytest.approx(error, rel=0.04)
        if nees:
            assert float(data.nees[20:].mean()) == pytest.approx(nees, rel=0.06)
    # the spec's 8.96 is a mean that holds the first transient of a start 12 km off
    assert float(found["ekf"].nees[20:].mean()) == pytest.approx(8.96, rel=0.03)
    low, high = nees_bounds(8, RUNS)
    for algorithm in ("ekf", "federated"):
        assert low <= float(found[algorithm].nees[50:].mean()) <= high
        inside = (found[algorithm].nees[50:] >= low) & (found[algorithm].nees[50:] <= high)
        assert float(inside.mean()) > 0.85
    assert low <= float(found["iterated"].nees[1:].mean()) <= high
    np.testing.assert_allclose(found["federated"].rmse, found["ekf"].rmse, rtol=1e-5, atol=1e-12)


@pytest.mark.slow
def test_blackout_widens_the_errors_and_the_filter_reconverges():
    case = lou2017_case.case()
    settings = lou2017_case.recommended_filter("intermittent")
    data = monte_carlo(case, settings, RUNS, 1, see_through=True)
    alone = monte_carlo(case, settings, RUNS, 1, faults=[Fault("all-ranges-lost")])
    # Q and R are this project's own: the spec's 17.6, 6.5, 6.1 and 782 m within 30 %
    radius = data.rmse.sel(state="radius")
    assert float(radius[80]) == pytest.approx(17.6, rel=0.3)
    assert float(radius[95]) == pytest.approx(6.5, rel=0.3)
    assert float(radius[-1]) == pytest.approx(6.1, rel=0.3)
    assert float(alone.rmse.sel(state="radius")[-1]) == pytest.approx(782, rel=0.3)
    assert float(data.capture[1:].mean("time").min()) > 0.98


def told(errors, diverged=()):
    """A Monte Carlo that finds the given errors: the rows must judge what they are given."""

    def fake(case, settings, runs, seed, *, faults=(), see_through=False):
        n, epochs, m = settings.states, case.times.size, case.beacons.size
        error = errors[settings.algorithm]
        lost = runs if settings.algorithm in diverged else 0
        state = ["radius", "longitude", "latitude", "speed", "flight-path angle", "azimuth"]
        state = [*state, "ln rho0", "L/D"][:n]
        by_state = ("time", "state")
        ones = np.ones((epochs, n))
        return xr.Dataset(
            {
                "position_rmse": ("time", np.full(epochs, error)),
                "rmse": (by_state, error * ones * np.linspace(2, 1, epochs)[:, None]),
                "sigma": (by_state, ones),
                "capture": (by_state, ones if error < 50 else 0.5 * ones),
                "nees": ("time", np.full(epochs, 8.0 * error / errors["ekf"])),
                "weight": (("time", "beacon"), np.full((epochs, m), 1 / m)),
                "miss": ("direction", np.zeros(3)),
                "miss_covariance": (("direction", "direction_2"), np.eye(3)),
            },
            coords={"state": state},
            attrs={"diverged": lost},
        )

    return fake


USUAL = {
    "ekf": 4.0,
    "iterated": 4.0,
    "federated": 4.0,
    "ci-feedback": 5.0,
    "dcifaif": 8.0,
    "ci": 800.0,
    "information": np.nan,
}


def verdicts(monkeypatch, module, fake):
    monkeypatch.setattr(lou2019_runs if module is lou2019 else module, "monte_carlo", fake)
    if module is lou2019:
        times = {"ekf": 4e-6, "dcifaif": 1e-5, "ci": 4e-5}
        monkeypatch.setattr(lou2019, "step_seconds", lambda s, case: times[s.algorithm])
    return {row.item: row.verdict.split(":")[0] for row in module.rows()}


def test_2019_rows_follow_the_numbers(monkeypatch):
    order = "order of position RMSE, recommended settings"
    ekf_fault = "EKF after the last orbiter falls silent at 200 s"
    found = verdicts(monkeypatch, lou2019, told(USUAL, ("information",)))
    assert found[order] == "reproduced"
    assert found[ekf_fault] == "erratum"
    assert found["mean NEES of ekf, recommended settings"] == "reproduced"
    assert found["mean NEES of ci, recommended settings"] == "erratum"
    assert found["CPU time of one step, one core"] == "erratum"
    swapped = verdicts(monkeypatch, lou2019, told(USUAL | {"ekf": 5000.0}))
    assert swapped[order] == "erratum"
    assert swapped[ekf_fault] == "reproduced"


def test_2017_rows_follow_the_numbers(monkeypatch):
    lost = "runs of the information filter that takes lost ranges as arrived"
    final = "final altitude RMSE, eight states: IMU alone, IFIM"
    errors = USUAL | {"intermittent": 7.0}
    found = verdicts(monkeypatch, lou2017, told(errors, ("information",)))
    assert found[lost] == "reproduced"
    # the same error with and without ranges: ranges would not help
    assert next(v for item, v in found.items() if item.startswith(final)) == "erratum"
    kept = verdicts(monkeypatch, lou2017, told(errors))
    assert kept[lost] == "erratum"
    assert kept["signal lost, wake"] == "reproduced"


def test_a_step_takes_time():
    case = lou2019_case.case()
    b = case.beacons
    short = Beacons(b.names, b.times[:4], b.r[:4], b.v[:4], b.moving)
    settings = lou2019_case.recommended_filter("ekf")
    assert 0 < lou2019.step_seconds(settings, replace(case, beacons=short), 1) < 1


def test_noiseless_measurements_start_at_entry():
    z = lou2019.noiseless(lou2019_case.case())
    assert z.shape == (301, 7)
    assert z[1, 3] == pytest.approx(1425175.20592, abs=5.1e-6)

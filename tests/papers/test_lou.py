"""The companions' papers: every row judged, and the Monte Carlo figures behind them."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from compass.entry.beacons import Beacons
from compass.entry.consistency import nees_bounds
from compass.entry.faults import Fault
from compass.papers import lou2017, lou2017_case, lou2019, lou2019_case, lou2019_runs
from compass.papers.line_of_sight import misses
from compass.papers.lou_montecarlo import monte_carlo

RUNS = 300
ORDER = "position RMSE of EKF, DCIFAIF, CI, mean of 50 to 300 s"
EKF_FAULT = (
    "position RMSE of the EKF, 200 to 300 s, after the last orbiter fell silent; runs of 200 lost "
    "that take the silence for a range"
)


def settled(data):
    return float(data.position_rmse[50:].mean())


@pytest.mark.slow
def test_rows_of_2019(every_row_can_fail):
    rows = lou2019.rows()
    every_row_can_fail(rows)
    assert {row.item for row in rows if not row.holds} == {
        "observability degree of all measurements, smallest",
        "CPU time of one step, one core: ekf, dcifaif, ci",
    }
    verdicts = {row.item: row.verdict for row in rows}
    assert verdicts[f"{ORDER}, settings as printed"] == "reproduced"
    assert verdicts[EKF_FAULT] == "erratum"


@pytest.mark.slow
def test_rows_of_2017(every_row_can_fail):
    rows = lou2017.rows()
    every_row_can_fail(rows)
    assert all(row.holds for row in rows)


def test_rows_that_were_fitted_say_so(every_row_can_fail):
    rows = lou2017.crossing_rows()
    every_row_can_fail(rows)
    crossings = [row for row in rows if "signal" in row.item]
    assert len(crossings) == 8
    assert {row.verdict for row in rows} == {"fitted", "computed"}


@pytest.mark.parametrize(
    "rows",
    [lou2017.plasma_rows, lou2017.setting_rows, lambda: [lou2017.exchanged_row()],
     lou2019.setting_rows],
    ids=["plasma", "2017's setting", "transposes", "2019's setting"],
)  # fmt: skip
def test_rows_without_runs(rows, every_row_can_fail):
    found = rows()
    every_row_can_fail(found)
    assert all(row.holds for row in found)


def test_other_physics_changes_the_verdicts(monkeypatch):
    monkeypatch.setattr(lou2017, "critical_density", lambda: 1.9941e15)
    verdicts = {row.item: row.verdict for row in lou2017.plasma_rows()}
    assert verdicts["critical electron density at 401 MHz"] == "reproduced"
    monkeypatch.setattr(lou2017, "published_critical_density", lambda: 2.0e9)
    monkeypatch.setattr(lou2017, "critical_density", lambda: 1.8e15)
    verdicts = {row.item: row.verdict for row in lou2017.plasma_rows()}
    assert verdicts["critical electron density at 401 MHz"] == "differs"
    monkeypatch.setattr(lou2017, "WAKE", lou2017.STAGNATION)
    verdicts = {row.item: row.verdict for row in lou2017.crossing_rows()}
    assert verdicts["blackout"] == verdicts["signal lost, wake"] == "differs"
    assert verdicts["peak electron density, wake"] == "differs"
    monkeypatch.setattr(lou2017, "misses", lambda a, b, radius: np.ones(3, dtype=bool))
    seen = next(row for row in lou2017.setting_rows() if row.item.startswith("seconds of 251"))
    assert seen.verdict == "differs"


def test_a_straight_line_misses_a_planet():
    """Tangents at grazing distance, a segment that ends before the planet, one through it."""
    a, b = np.array([[-2.0, 1.001, 0], [-2, 0.999, 0], [-3, 0, 0]]), np.array([[2.0, 1.001, 0],
        [2, 0.999, 0], [-2, 0, 0]])  # fmt: skip
    assert misses(a, b, 1.0).tolist() == [True, False, True]


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
    radius, believed = (d.sel(state="radius").values for d in (data.rmse, data.sigma))
    lost, doubted = (d.sel(state="radius").values[-1] for d in (alone.rmse, alone.sigma))
    # an RMSE of n runs is known to 1/sqrt(2 n), a difference of two such to sqrt(2) times that;
    # four of them are allowed
    one = 4 / np.sqrt(2 * RUNS)
    for found, elsewhere in ((radius[80], 17.6), (radius[95], 6.5), (lost, 782)):
        assert found == pytest.approx(elsewhere, rel=np.sqrt(2) * one)
    # the filter's own covariance knows the errors where its process noise is not what rules it
    assert lost == pytest.approx(doubted, rel=one)
    assert radius[-1] == pytest.approx(believed[-1], rel=one)
    assert (radius[60:96] < (1 + one) * believed[60:96]).all()
    assert radius[80] > 1.5 * radius[35]
    assert radius[95] < 0.6 * radius[80]
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
    return {row.item: row for row in module.rows()}


def test_2019_rows_follow_the_numbers(monkeypatch, every_row_can_fail):
    order, ci = (
        f"{ORDER}, recommended settings",
        "mean NEES of ci, recommended settings, 50 to 300 s",
    )
    found = verdicts(monkeypatch, lou2019, told(USUAL, ("information",)))
    every_row_can_fail(found.values())
    assert found[order].verdict == "reproduced"
    assert found[EKF_FAULT].verdict == "erratum"
    assert found[ci].verdict == "erratum"
    assert found["CPU time of one step, one core: ekf, dcifaif, ci"].verdict == "differs"
    swapped = verdicts(monkeypatch, lou2019, told(USUAL | {"ekf": 5000.0}))
    assert swapped[order].verdict == "differs"
    assert swapped[EKF_FAULT].verdict == "reproduced"
    # neither the paper's claim nor what shows it to be wrong: nobody is lost
    assert verdicts(monkeypatch, lou2019, told(USUAL))[EKF_FAULT].verdict == "differs"


def test_2017_rows_follow_the_numbers(monkeypatch, every_row_can_fail):
    lost = "runs of 300 of the information filter that takes lost ranges as arrived"
    final = "final altitude RMSE, eight states: IMU alone, IFIM"
    errors = USUAL | {"intermittent": 7.0}
    found = verdicts(monkeypatch, lou2017, told(errors, ("information",)))
    every_row_can_fail(found.values())
    assert found[lost].verdict == "reproduced"
    # the same error with and without ranges: ranges would not help
    assert next(r for item, r in found.items() if item.startswith(final)).verdict == "differs"
    kept = verdicts(monkeypatch, lou2017, told(errors))
    assert kept[lost].verdict == "differs"
    assert kept["signal lost, wake"].verdict == "fitted"


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

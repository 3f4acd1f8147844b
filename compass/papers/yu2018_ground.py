"""Yu et al. 2018, ground beacons: observability, the best places, and the filter on them."""

import time
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.stats import spearmanr

from compass.entry.beacons import Beacons
from compass.entry.best_ground import best_ground_beacons
from compass.entry.observability import observability
from compass.entry.schedule import Measurements
from compass.entry.trajectory import Trajectory
from compass.entry.visible_area import VisibleArea
from compass.frames import latitude_longitude
from compass.papers import yu2018_case as paper
from compass.papers.verdict import Row, judge_claim
from compass.papers.yu2018_filter import Bound, Filter, cramer_rao_bound, run_monte_carlo


@cache
def best_ground() -> tuple[float, NDArray[np.float64], float]:
    """Best minimum delta, where (rad), and the seconds it took."""
    found = best_ground_beacons(paper.ground_flight(), starts=2, generations=60)
    return found.value, found.parameters, found.seconds


def ground_rows() -> list[Row]:
    """Observability on ground beacons and their best places."""
    flight, beacons = paper.ground_flight(), paper.ground_beacons()
    timed = {}
    found = {}
    for method in ("exact", "quadratic", "published-quadratic", "linear"):
        observability(paper.model(), flight.states, beacons, method=method)
        began = time.perf_counter()
        found[method] = observability(paper.model(), flight.states, beacons, method=method)
        timed[method] = time.perf_counter() - began
    exact = found["exact"]
    off = {
        key: float(np.abs(value.degree / exact.degree - 1).max()) for key, value in found.items()
    }
    correlation = float(spearmanr(exact.degree, exact.index).statistic)
    best, places, _ = best_ground()
    peak = float(paper.TIMES[exact.index.argmax()])
    west = places[:, 1] < latitude_longitude(VisibleArea(flight).centre)[1]
    return [
        judge_claim(
            "Best minimum of delta over the entry (SI)",
            "Figures 4 and 5",
            "1.413e-8",
            best,
            "1",
            False,
            "a better configuration exists (places are not printed); the text calls it the maximum "
            "and the maximum the minimum",
        ),
        judge_claim(
            "Largest delta, beacons of Figure 4's words (SI)",
            "Figure 5",
            "2.945e-7",
            float(exact.degree.max()),
            "1",
            bool(0.5 < exact.degree.max() / 2.945e-7 < 2.0),
            "of another order of magnitude",
        ),
        judge_claim(
            "Time of the smallest delta, beacons of Figure 4's words",
            "Figure 5",
            "at the beginning (0 s)",
            float(paper.TIMES[exact.degree.argmin()]),
            "s",
            bool(exact.degree.argmin() == 0),
            "later",
        ),
        judge_claim(
            "West and east beacons of the optimum",
            "Figure 4",
            "two west, one east",
            f"{int(west.sum())} west, {int((~west).sum())} east",
            "1",
            int(west.sum()) == 2,
            "another local optimum is best",
        ),
        judge_claim(
            "Time of the exact method, 241 epochs",
            "Table 3",
            ">10000",
            timed["exact"],
            "s",
            False,
            "Taylor arithmetic with gradients gives the exact Lie derivatives at the cost of the "
            "approximations",
        ),
        judge_claim(
            "Exact over linear computation time",
            "Table 3",
            ">7000",
            timed["exact"] / timed["linear"],
            "1",
            False,
            "there is no trade between accuracy and time",
        ),
        judge_claim(
            "Largest relative error of delta, linear and quadratic",
            "Figure 5",
            "linearisation deviates most",
            f"{off['linear']:.2g} and {off['quadratic']:.2g}",
            "1",
            off["linear"] > off["quadratic"],
            "the quadratic one does",
        ),
        judge_claim(
            "Largest relative error of delta, printed over mended quadratic recursion",
            "eq. 16",
            "1",
            off["published-quadratic"] / off["quadratic"],
            "1",
            False,
            "the printed Hessian recursion lacks a factor of two",
        ),
        judge_claim(
            "Rank correlation of I and delta",
            "Figure 6",
            "identical variation trend",
            correlation,
            "1",
            correlation > 0.95,
            "alike only roughly",
        ),
        judge_claim(
            "Time of the largest I",
            "Figures 6, 10 and 11",
            "75",
            peak,
            "s",
            abs(peak - 75) <= 5,
            "another beacon geometry",
        ),
    ]


def filter_rows() -> list[Row]:
    """The filter with the errors of Table 4, beside its bound."""
    flight, beacons = paper.ground_flight(), paper.ground_beacons(best_ground()[1])
    sigma = np.array([1000.0, *np.radians([0.2, 0.2]), 10.0, *np.radians([0.2, 0.2])])
    measurements = Measurements(100.0)
    taken = measurements.taken(np.ones((paper.TIMES.size, 3), dtype=bool), paper.TIMES)
    bound = cramer_rao_bound(
        paper.model(), flight.states, beacons, taken, measurements, np.diag(sigma**2)
    )
    share = np.sqrt(np.diagonal(bound.covariance, axis1=1, axis2=2)) / sigma
    ratios = {
        passes: _worst_ratio(flight, beacons, measurements, taken, np.diag(sigma**2), passes, bound)
        for passes in (1, 10)
    }
    early = share[paper.at(60)]
    fall = share[paper.at(115), 3:] / share[paper.at(90), 3:]
    return [
        judge_claim(
            "First longitude error of Table 4 on the ground",
            "Table 4",
            "0.2 deg",
            float(np.radians(0.2) * flight.states[0, 0] * np.cos(flight.states[0, 2])) / 1e3,
            "km",
            True,
            "",
        ),
        judge_claim(
            "Position error of the plain EKF over the bound, at worst, Table 4's errors",
            "Figure 7",
            "the EKF converges",
            ratios[1],
            "1",
            ratios[1] < 1.5,
            "errors of 12 km are beyond one linearisation; the iterated filter is at "
            f"{ratios[10]:.2g} of the bound",
        ),
        judge_claim(
            "Bounds at 60 s over the first: longitude, latitude; speed, flight path, azimuth",
            "Figure 7",
            "longitude and latitude converge fastest",
            f"{early[1]:.2g}, {early[2]:.2g}; {early[3]:.2g}, {early[4]:.2g}, {early[5]:.2g}",
            "1",
            bool(early[1:3].max() < early[3:].min()),
            "not in this geometry",
        ),
        judge_claim(
            "Bounds at 115 s over those at 90 s: speed, flight path, azimuth",
            "Figure 7",
            "rapid convergence from about 90 to 115 s",
            f"{fall[0]:.2g}, {fall[1]:.2g}, {fall[2]:.2g}",
            "1",
            bool(fall.max() < 0.5),
            "the flight-path angle converges so; the speed's bound grows while drag is largest",
        ),
    ]


def _worst_ratio(
    flight: Trajectory,
    beacons: Beacons,
    measurements: Measurements,
    taken: NDArray[np.bool_],
    covariance0: NDArray[np.float64],
    passes: int,
    bound: Bound,
) -> float:
    """Largest position RMS over the bound after the first 10 s, half of `RUNS`."""
    settings = Filter(covariance0, np.zeros(6), passes)
    mc = run_monte_carlo(
        paper.model(),
        flight.states[0],
        beacons,
        taken,
        measurements,
        settings,
        runs=paper.RUNS // 2,
    )
    return float((mc.position_rms / bound.position_sigma)[paper.at(10) :].max())

"""Yu et al. 2018, ground beacons: observability, the best places, and the filter on them."""

import time
from functools import cache
from typing import get_args

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
from compass.papers.verdict import Erratum, Row, claim, compare, computed, extremes
from compass.papers.yu2018_filter import Bound, Filter, cramer_rao_bound, run_monte_carlo
from compass.papers.yu2018_observability import Method, approximate_degree

#: Section 5.1's "maximum and minimum value" of delta, in its order.
PRINTED_MAXIMUM, PRINTED_MINIMUM = "1.413e-8", "2.945e-7"


@cache
def best_ground() -> tuple[float, NDArray[np.float64], float]:
    """Best minimum delta, where (rad), and the seconds it took."""
    optimum = best_ground_beacons(paper.ground_flight(), starts=2, generations=60)
    return optimum.value, optimum.parameters, optimum.seconds


def ground_rows() -> list[Row]:
    """Observability on ground beacons and their best places."""
    flight, beacons = paper.ground_flight(), paper.ground_beacons()
    timed = {}
    areas = {}
    for method in (None, *get_args(Method)):
        for _ in range(2):  # the first compiles
            began = time.perf_counter()
            areas[method] = (
                approximate_degree(paper.model(), flight.states, beacons, method)
                if method
                else observability(paper.model(), flight.states, beacons).spherical_degree
            )
            timed[method] = time.perf_counter() - began
    exact, index = areas[None], observability(paper.model(), flight.states, beacons).index
    off = {key: float(np.abs(value / exact - 1).max()) for key, value in areas.items()}
    correlation = float(spearmanr(exact, index).statistic)
    best, places, _ = best_ground()
    peak = float(paper.TIMES[index.argmax()])
    west = places[:, 1] < latitude_longitude(VisibleArea(flight).centre)[1]
    quicker = timed["quadratic"] / timed["linear"]
    return [
        extremes(
            "section 5.1",
            "the maximum and minimum value",
            (PRINTED_MAXIMUM, PRINTED_MINIMUM),
            (best, exact.max()),
            "SI",
        ),
        compare(
            "Best minimum of delta over the entry (SI)",
            "Figures 4 and 5",
            PRINTED_MAXIMUM,
            best,
            note=f"{100 * (best / float(PRINTED_MAXIMUM) - 1):+.0f} %: a search finds a better "
            f"one; its places are not printed, and {paper.NOT_PRINTED}",
        ),
        compare(
            "Largest delta, beacons of Figure 4's words (SI)",
            "Figure 5",
            PRINTED_MINIMUM,
            float(exact.max()),
            note=f"{100 * (exact.max() / float(PRINTED_MINIMUM) - 1):+.0f} %: the chapter "
            "prints no places of its beacons; these follow its words",
        ),
        claim(
            "Time of the smallest delta, beacons of Figure 4's words",
            "Figure 5",
            "at the beginning",
            float(paper.TIMES[exact.argmin()]),
            "s",
            "0",
            lambda time: time == 0,
        ),
        claim(
            "Beacons of the optimum west and east of the middle",
            "Figure 4",
            "two west, one east",
            (west.sum(), (~west).sum()),
            "1",
            "2 and 1",
            lambda west, east: west == 2 and east == 1,
            shown="{:.0f} west, {:.0f} east",
        ),
        *(
            claim(
                f"Time of 241 epochs, {name}",
                "Table 3",
                f"{printed:g} s" if key else "over 10000 s",
                timed[key],
                "s",
                "within a factor of 10, for another machine",
                lambda seconds, printed=printed: 0.1 < seconds / printed < 10,
                note=why,
            )
            for name, key, printed, why in (
                (
                    "exact method",
                    None,
                    10000.0,
                    "Taylor arithmetic with gradients gives the exact Lie derivatives at the cost "
                    "of the approximations: there is no trade between accuracy and time",
                ),
                ("linear", "linear", 1.3987, "compiled code on another machine"),
                ("quadratic", "quadratic", 2.1558, "compiled code on another machine"),
            )
        ),
        claim(
            "Time of the quadratic over that of the linear method",
            "Table 3",
            "2.1558 s / 1.3987 s = 1.54",
            quicker,
            "1",
            "the linear one is quicker",
            lambda ratio: ratio > 1,
            note="how much quicker depends on the machine and its load",
        ),
        claim(
            "Largest relative error of delta, linear and quadratic",
            "Figure 5",
            "linearisation deviates most",
            (off["linear"], off["quadratic"]),
            "1",
            "the first is larger",
            lambda linear, quadratic: linear > quadratic,
            shown="{:.2g}, {:.2g}",
        ),
        hessian_row(),
        claim(
            "Rank correlation of I and delta",
            "Figure 6",
            "identical variation trend",
            correlation,
            "1",
            "above 0.95",
            lambda rank: rank > 0.95,
            note="alike only roughly, for the beacons of Figure 4's words",
        ),
        compare(
            "Time of the largest I",
            "Figures 6, 10 and 11",
            "75",
            peak,
            "s",
            tolerance=5.0,
            why="read off a figure",
            note="beacons of Figure 4's words, which prints no places",
        ),
    ]


def hessian_row() -> Row:
    """Equation 16's Hessian of ``L_f h`` for ``h = x^T H x / 2`` and ``f = A x``, by differences.

    Its gradient is linear, so that differences give the Hessian to rounding.
    """
    random = np.random.default_rng(2018)
    h, a = random.normal(size=(6, 6)), random.normal(size=(6, 6))
    h = h + h.T

    def value(x: NDArray[np.float64]) -> float:
        return float((h @ x) @ (a @ x))

    eye = np.eye(6)
    true = np.array([[value(i + j) - value(i) - value(j) for j in eye] for i in eye])
    mended = h @ a + a.T @ h
    eq_16 = (h + h.T) @ a / 2
    printed = (eq_16 + eq_16.T) / 2
    size = float(np.abs(true).max())
    return claim(
        "Hessian of the next Lie derivative against differences: as printed; doubled",
        "eq. 16",
        "H+ = (H + H^T) J_f, symmetric part",
        (np.abs(printed - true).max() / size, np.abs(mended - true).max() / size),
        "relative",
        "the first is rounding",
        lambda as_printed, _: as_printed < 1e-9,
        shown="{:.3g}; {:.1e}",
        erratum=Erratum(
            "a factor of two is missing in the Hessian that goes into the next step",
            shown=lambda as_printed, doubled: doubled < 1e-9 < as_printed,
        ),
    )


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
        computed(
            "First longitude error of Table 4 on the ground",
            "Table 4",
            float(np.radians(0.2) * flight.states[0, 0] * np.cos(flight.states[0, 2])) / 1e3,
            "km",
        ),
        claim(
            "Position error over the bound, at worst, Table 4's errors: plain EKF; iterated",
            "Figure 7",
            "the EKF converges",
            (ratios[1], ratios[10]),
            "1",
            "the first below 1.5",
            lambda plain, _: plain < 1.5,
            shown="{:.3g}; {:.3g}",
            note="errors of 12 km are beyond one linearisation",
        ),
        claim(
            "Bounds at 60 s over the first: longitude, latitude; speed, flight path, azimuth",
            "Figure 7",
            "longitude and latitude converge fastest",
            early[1:],
            "1",
            "the first two below the others",
            lambda lon, lat, *others: max(lon, lat) < min(others),
            shown="{:.2g}, {:.2g}; {:.2g}, {:.2g}, {:.2g}",
            note="not for the places found here; the chapter's are not printed",
        ),
        claim(
            "Bounds at 115 s over those at 90 s: speed, flight path, azimuth",
            "Figure 7",
            "rapid convergence from about 90 to 115 s",
            fall,
            "1",
            "below 0.5 each",
            lambda *shares: max(shares) < 0.5,
            shown="{:.2g}, {:.2g}, {:.2g}",
            note="the flight-path angle converges so; the speed's bound grows while drag is "
            "largest. The chapter's beacons are not printed",
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

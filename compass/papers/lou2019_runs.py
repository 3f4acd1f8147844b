"""Lou et al. 2019, Monte Carlo: filters with published and recommended settings, and faults."""

from typing import TYPE_CHECKING

from compass.entry.accuracy import error_ellipse
from compass.entry.consistency import nees_bounds
from compass.entry.faults import Fault
from compass.papers import lou2019_case as paper
from compass.papers.lou_filters import Algorithm
from compass.papers.lou_montecarlo import monte_carlo
from compass.papers.verdict import Erratum, Row, claim, computed

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

#: Monte Carlo figures are good to a few percent with this many runs; the paper takes 5000.
RUNS, SEED = 200, 1
#: Averages are over this time, s: past the first transient.
SETTLED = slice(50, None)
PAPER_BIAS = -0.03
OUTAGE = Fault("outage", "orbiter 2", 200.0)


def settled(data: "xr.Dataset") -> float:
    """Position RMSE averaged from 50 s to the end, metres."""
    return float(data.position_rmse[SETTLED].mean())


def published_runs() -> list[Row]:
    """Figures 5 to 8 with the printed settings, literally and read as of ln rho0."""
    case = paper.case(bias=PAPER_BIAS)
    runs: dict[Algorithm, xr.Dataset] = {}
    names: tuple[Algorithm, ...] = ("ekf", "dcifaif", "ci")
    for name in names:
        runs[name] = monte_carlo(case, paper.published_filter(name), RUNS, SEED)
    in_log = {
        name: monte_carlo(case, paper.published_filter(name, linear=False), RUNS, SEED)
        for name in names
    }
    ends = {str(name): settled(data) for name, data in runs.items()}
    logs = {str(name): settled(data) for name, data in in_log.items()}
    capture = runs["dcifaif"].capture[1:, :6].min(dim="state").mean()
    weights = runs["dcifaif"].weight[1:]
    first = weights[0].values
    surface_more = float((weights[:, :2].sum("beacon") > weights[:, 2:].sum("beacon")).mean())
    nees = float(runs["ekf"].nees[-1])
    return [
        _order_row("settings as printed", ends),
        _order_row("printed P0 and Q taken for ln rho0", logs),
        claim(
            "position RMSE of CI and of EKF, 50 to 300 s (ln rho0)",
            "Figure 5",
            "CI: altitude, velocity, FPA, longitude, azimuth diverge",
            (logs["ci"], logs["ekf"]),
            "m",
            "a hundred times the EKF's",
            lambda ci, ekf: ci > 100 * ekf,
            shown="{:.3g}, {:.3g}",
        ),
        claim(
            f"share of DCIFAIF's motion errors within 3 sigma, {RUNS} runs",
            "Figure 6",
            "all six states captured",
            float(capture),
            "1",
            "above 0.99",
            lambda share: share > 0.99,
        ),
        claim(
            "weights of DCIFAIF at 1 s; share of time in which the surface beacons' are larger",
            "Figure 7",
            "surface beacons contribute more",
            (*first, surface_more),
            "1",
            "larger at 1 s and most of the time",
            lambda one, two, three, four, share: one + two > three + four and share > 0.5,
            shown="{:.4f}, {:.4f}, {:.4f}, {:.4f}; {:.2f}",
            note="at first they do, then the infinity norm in SI units no longer tells the "
            "subsystems apart and all weights are 1/4 (from lon = lat = 0, not the printed start)",
        ),
        claim(
            "bias of the accelerometer over its sigma; mean NEES of the EKF at 300 s",
            "section 4",
            "R_acc = 1e-6 with a bias of -0.03 m/s^2",
            (abs(PAPER_BIAS) / float(paper.ACCELERATION_VARIANCE[0]) ** 0.5, nees),
            "1; of 8",
            "the second within its bounds",
            lambda _, error: error < nees_bounds(8, RUNS)[1],
            shown="{:.1f}; {:.1f}",
            erratum=Erratum(
                "a bias of many sigma left out of the state: density and L/D take it up. Augment "
                "the bias or keep it out",
                shown=lambda bias, error: bias > 3 and error > nees_bounds(8, RUNS)[1],
            ),
        ),
    ]


def _order_row(settings: str, errors: "Mapping[str, float]") -> Row:
    """Row of the order of the three filters' errors."""
    return claim(
        f"position RMSE of EKF, DCIFAIF, CI, mean of 50 to 300 s, {settings}",
        "Figure 8",
        "EKF < DCIFAIF < CI",
        [errors[name] for name in ("ekf", "dcifaif", "ci")],
        "m",
        "this order",
        lambda ekf, dcifaif, ci: ekf < dcifaif < ci,
        shown="{:.3g}, {:.3g}, {:.3g}",
    )


def recommended_runs() -> list[Row]:
    """The filters with the recommended settings, and whether they are consistent."""
    case = paper.case(noisy_truth=True)
    names: tuple[Algorithm, ...] = ("ekf", "iterated", "federated", "ci-feedback", "dcifaif", "ci")
    runs = {name: monte_carlo(case, paper.recommended_filter(name), RUNS, SEED) for name in names}
    low, high = nees_bounds(8, RUNS)
    ends = {str(name): settled(data) for name, data in runs.items()}
    nees = {str(name): float(data.nees[SETTLED].mean()) for name, data in runs.items()}
    ekf = runs["ekf"]
    ellipse = error_ellipse(ekf.miss.values[:2], ekf.miss_covariance.values[:2, :2])
    outside = Erratum(
        "each subsystem is unobservable and its linearisation wanders off: covariance intersection "
        "needs consistent estimates to start from",
        shown=lambda error: error > high,
    )
    return [
        _order_row("recommended settings", ends),
        *(
            computed(
                f"mean NEES of {name}, recommended settings, 50 to 300 s",
                "-",
                nees[name],
                "of 8",
                note=f"consistent between {low:.2f} and {high:.2f}",
            )
            for name in ("ekf", "iterated", "federated", "ci-feedback")
        ),
        *(
            claim(
                f"mean NEES of {name}, recommended settings, 50 to 300 s",
                "section 3.3",
                "consistent estimates",
                nees[name],
                "of 8",
                f"{high:.2f} or less: the covariance is not too small",
                lambda error: 0 < error <= high,
                erratum=outside,
            )
            for name in ("dcifaif", "ci")
        ),
        computed(
            "position RMSE of federated sum-fusion over that of the centralised EKF, less 1",
            "section 3.4",
            ends["federated"] / ends["ekf"] - 1,
            "relative",
            note="fusion loses nothing if shared information is divided before it is added",
        ),
        computed(
            "95 % error ellipse at the end, recommended EKF, semi-axes",
            "section 4",
            (ellipse.semi_major, ellipse.semi_minor),
            "m",
            shown="{:.2f} x {:.2f}",
            note="the paper computes it and does not print it",
        ),
    ]


def fault_rows() -> list[Row]:
    """Filters when a beacon falls silent in mid-entry."""
    case = paper.case(noisy_truth=True)
    names: tuple[Algorithm, ...] = ("ekf", "dcifaif", "ci", "information")
    runs = {
        name: monte_carlo(case, paper.recommended_filter(name), RUNS, SEED, faults=[OUTAGE])
        for name in names
    }
    after = {name: float(data.position_rmse[200:].mean()) for name, data in runs.items()}
    capture = float(runs["dcifaif"].capture[200:, :6].min())
    silence = (Fault("all-ranges-lost", start=100.0, end=150.0),)
    silent = {
        str(name): monte_carlo(case, paper.recommended_filter(name), 50, SEED, faults=silence)
        for name in names[:2]
    }
    mistaken = runs["information"].attrs["diverged"]
    lost = {name: float(data.attrs["diverged"]) for name, data in silent.items()}
    return [
        claim(
            "position RMSE of the EKF, 200 to 300 s, after the last orbiter fell silent; runs of "
            f"{RUNS} lost that take the silence for a range",
            "Figure 10",
            "the EKF is divergent, because no measurements are provided",
            (after["ekf"], mistaken),
            "m; runs",
            "the first above 1000",
            lambda error, _: error > 1e3,
            shown="{:.3g}; {:.0f}",
            erratum=Erratum(
                "with the missing range left out it goes on with three beacons; only a filter that "
                "takes the silent beacon's reading for a range is lost",
                shown=lambda error, runs: error < 1e2 and runs > RUNS / 2,
            ),
        ),
        claim(
            "position RMSE of DCIFAIF and CI, 200 to 300 s, after the fault",
            "Figure 10",
            "DCIFAIF better than CI",
            (after["dcifaif"], after["ci"]),
            "m",
            "this order",
            lambda dcifaif, ci: dcifaif < ci,
            shown="{:.3g}, {:.3g}",
        ),
        claim(
            f"least share of DCIFAIF's motion errors after the fault within 3 sigma, {RUNS} runs",
            "Figure 9",
            "all six states captured",
            capture,
            "1",
            "above 0.98",
            lambda share: share > 0.98,
        ),
        claim(
            "runs of 50 lost by DCIFAIF and by EKF after 50 s without any range",
            "section 5",
            "consistent when the subsystems are unobservable",
            (lost["dcifaif"], lost["ekf"]),
            "runs",
            "none lost by DCIFAIF",
            lambda dcifaif, ekf: dcifaif == 0 <= ekf,
            shown="{:.0f}, {:.0f}",
            erratum=Erratum(
                "with every subsystem on the same accelerometers the feedback P/w still divides "
                "the covariance by each weight: it grows geometrically until the filter is lost",
                shown=lambda dcifaif, ekf: dcifaif > 25 > ekf,
            ),
        ),
    ]

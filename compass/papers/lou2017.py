"""Lou et al. 2017: plasma, blackout and intermittent ranges, published against computed."""

from typing import TYPE_CHECKING

import numpy as np

from compass.entry.faults import Fault
from compass.entry.montecarlo import monte_carlo
from compass.entry.radio import (
    BROWNOUT_DENSITY,
    PER_CM3,
    STAGNATION,
    WAKE,
    attenuation,
    critical_density,
    crossing_times,
    published_critical_density,
)
from compass.papers import lou2017_case as paper
from compass.papers.verdict import Row, compare, judge_claim

if TYPE_CHECKING:
    import xarray as xr

TITLE = (
    "Lou, Wang, Ding and Zhao 2017, Mars Atmospheric Entry Integrated Navigation with Partial "
    "Intermittent Measurements, Int. J. Aerospace Engineering 2017, 4378640, "
    "doi 10.1155/2017/4378640"
)
RUNS, SEED = 300, 1
NO_RANGES = (Fault("all-ranges-lost"),)
#: Section 3.2: seconds at which the signal begins to fade, is lost, comes back, is clear.
CROSSINGS = {"stagnation": ("6", "15", "91", "98"), "wake": ("30", "41", "81", "87")}
PEAKS = {"stagnation": 3.69e12, "wake": 3.70e10}


def rows() -> list[Row]:
    """Every table and figure of the paper."""
    return [*_plasma_rows(), *_crossing_rows(), *_setting_rows(), *_navigation_rows()]


def _plasma_rows() -> list[Row]:
    return [
        compare(
            "critical electron density at 401 MHz",
            "section 3.2",
            "1.9941",
            critical_density() / PER_CM3 / 1e9,
            "1e9 per cm^3",
            erratum="(f/8980)^2 with a rounded constant, and printed per m^3: it is per cm^3",
        ),
        compare(
            "the same by (f/8980)^2, as printed",
            "eq. 10",
            "1.9941",
            published_critical_density() / 1e9,
            "1e9 per cm^3",
        ),
        compare(
            "constant of the attenuation, 40 pi log10(e)",
            "eq. 9",
            "54.6",
            float(40 * np.pi * np.log10(np.e)),
            "dB",
        ),
        judge_claim(
            "attenuation at 1e10 electrons per cm^3",
            "Figure 2",
            "rises rapidly above the critical density",
            float(attenuation(1e10 * PER_CM3)),
            "dB/m",
            float(attenuation(critical_density() * 0.999)) == 0.0
            and float(attenuation(1e10 * PER_CM3)) > 100,
            "it does not",
        ),
    ]


def _crossing_rows() -> list[Row]:
    case = paper.case(plasma=False)
    found = []
    for place, model in (("stagnation", STAGNATION), ("wake", WAKE)):
        n = case.electrons(model)
        fade, clear = crossing_times(case.times, n, BROWNOUT_DENSITY.value)
        lost, back = crossing_times(case.times, n, critical_density())
        for said, time, what in zip(
            CROSSINGS[place],
            (fade, lost, back, clear),
            ("signal begins to fade", "signal lost", "signal comes back", "signal clear again"),
            strict=True,
        ):
            found.append(
                compare(
                    f"{what}, {place}",
                    "section 3.2",
                    said,
                    float(time),
                    "s",
                    tolerance=1.0,  # read off a 1 s grid of the paper's own program
                )
            )
        peak = float(n.max() / PER_CM3)
        found.append(
            judge_claim(
                f"peak electron density, {place} (fitted surrogate)",
                "Figure 6",
                f"{PEAKS[place]:.3g} at 64 s",
                peak,
                f"per cm^3, at {case.times[n.argmax()]:g} s",
                abs(peak / PEAKS[place] - 1) < 0.02,
                "off the printed peak",
            )
        )
    beta = paper.case().arrival
    assert beta is not None
    partial = (beta[:, 0] < 1) & (beta[:, 0] > 1.0001e-8)
    found += [
        compare("seconds of brownout", "section 6", "17", float(partial.sum()), "s", tolerance=1.0),
        judge_claim(
            "arrivals expected in brownout",
            "Figure 5",
            "Rayleigh distribution with tau = 2.5",
            float(beta[partial, 0].sum()),
            "of a range",
            False,
            "the distribution function as printed rises with the density and its unit is not "
            "said; the survival function of scale 2.78e8 per cm^3 falls from 1 to 1e-8",
        ),
    ]
    return found


def _setting_rows() -> list[Row]:
    case = paper.case(plasma=False)
    last, seen = case.nominal[-1], case.visible.sum(axis=0)
    drag = 0.5 * case.density * 0.016 * case.nominal[:, 3] ** 2
    r, v = paper.POSITIONS_KM[2] * 1e3, paper.VELOCITIES[2]
    energy = v @ v / 2 - paper.GM / np.linalg.norm(r)
    momentum = np.linalg.norm(np.cross(r, v))
    eccentricity = np.sqrt(1 + 2 * energy * (momentum / paper.GM) ** 2)
    periapsis = momentum**2 / paper.GM / (1 + eccentricity) - paper.PLANET_RADIUS
    return [
        judge_claim(
            "end of the trajectory",
            "Figure 3",
            "about 250 s",
            f"{(last[0] - paper.PLANET_RADIUS) / 1e3:.2f} km, {last[3]:.2f} m/s",
            "altitude, speed",
            5e3 < last[0] - paper.PLANET_RADIUS < 15e3,
            "elsewhere",
        ),
        judge_claim(
            "peak drag",
            "Figure 3",
            "peak deceleration about 15 g",
            float(drag.max()),
            f"m/s^2, at {case.times[drag.argmax()]:g} s",
            abs(drag.max() / 9.80665 - 15) < 1,
            "another",
        ),
        judge_claim(
            "seconds in sight of orbiting beacons 1, 2, 3",
            "Table 3",
            "three orbiters within sight",
            ", ".join(str(int(count)) for count in seen),
            "s of 251",
            bool(case.visible.all()),
            "orbiting beacon 1 sets after 44 s; results with all three let ranges pass through "
            "the planet",
        ),
        judge_claim(
            "periapsis of orbiting beacon 3",
            "Table 3",
            "an orbit",
            float(periapsis / 1e3),
            "km above 3397.2 km",
            bool(periapsis > 0),
            "its periapsis lies under the surface",
        ),
        judge_claim(
            "sigma of flight-path angle and azimuth",
            "section 5, Table 2",
            "1 deg in the text, 0.5 deg in Table 2",
            0.5,
            "deg",
            False,
            "text and table differ; Table 2 is taken",
        ),
    ]


def _navigation_rows() -> list[Row]:
    case = paper.case()

    def fly(settings: object, ranges: bool, see_through: bool = True) -> "xr.Dataset":
        faults = () if ranges else NO_RANGES
        return monte_carlo(
            case,
            settings,  # type: ignore[arg-type]
            RUNS,
            SEED,
            faults=faults,
            see_through=see_through,
        )

    narrow = fly(paper.six_state_filter("intermittent", paper.SMALL_Q), ranges=False)
    six_imu = fly(paper.six_state_filter("intermittent"), ranges=False)
    six = fly(paper.six_state_filter("intermittent"), ranges=True)
    eight_imu = fly(paper.recommended_filter("intermittent"), ranges=False)
    eight = fly(paper.recommended_filter("intermittent"), ranges=True)
    honest = fly(paper.recommended_filter("intermittent"), ranges=True, see_through=False)
    blind = fly(paper.recommended_filter("information"), ranges=True)
    shares = narrow.capture.min("time").values
    leaves = {str(n) for n, share in zip(narrow.state.values, shares, strict=True) if share < 0.9}
    said = {"radius", "speed", "flight-path angle", "latitude"}
    return [
        judge_claim(
            "states that leave their 3 sigma bounds, IMU alone",
            "Figure 7",
            "altitude, velocity, FPA, latitude",
            ", ".join(sorted(leaves)),
            "",
            leaves == said,
            "another list",
        ),
        judge_claim(
            "final altitude RMSE, six states: IMU alone, IFIM",
            "Figure 9",
            "IFIM far smaller",
            f"{six_imu.rmse.values[-1, 0]:.0f}, {six.rmse.values[-1, 0]:.1f}",
            "m",
            bool(six.rmse[-1, 0] < 0.05 * six_imu.rmse[-1, 0]),
            "it is not",
        ),
        judge_claim(
            "smallest mean share of errors within 3 sigma, IFIM, six states",
            "Figure 8",
            "almost all captured",
            float(six.capture[1:].mean("time").min()),
            "1",
            bool(six.capture[1:].mean("time").min() > 0.9),
            "not captured",
        ),
        judge_claim(
            "smallest mean share of errors within 3 sigma, IFIM, eight states",
            "Figure 8",
            "almost all captured",
            float(eight.capture[1:].mean("time").min()),
            "1",
            bool(eight.capture[1:].mean("time").min() > 0.98),
            "not captured",
        ),
        judge_claim(
            "final altitude RMSE, eight states: IMU alone, IFIM, IFIM with hidden orbiter 1",
            "Figure 9",
            "IFIM far smaller",
            ", ".join(f"{d.rmse.values[-1, 0]:.1f}" for d in (eight_imu, eight, honest)),
            "m",
            bool(eight.rmse[-1, 0] < 0.05 * eight_imu.rmse[-1, 0]),
            "it is not",
        ),
        judge_claim(
            "altitude RMSE at 80 s and 95 s, eight states, after blackout",
            "Figure 8",
            "reconverges",
            f"{eight.rmse.values[80, 0]:.1f}, {eight.rmse.values[95, 0]:.1f}",
            "m",
            bool(eight.rmse[95, 0] < 0.6 * eight.rmse[80, 0]),
            "it does not",
        ),
        judge_claim(
            "runs of the information filter that takes lost ranges as arrived",
            "section 5",
            "diverges",
            f"{blind.attrs['diverged']} of {RUNS}",
            "runs diverged",
            bool(blind.attrs["diverged"] > 0.5 * RUNS),
            "it does not",
        ),
    ]

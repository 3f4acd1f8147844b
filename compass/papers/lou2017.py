"""Lou et al. 2017: plasma, blackout and intermittent ranges, published against computed."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.entry.faults import Fault
from compass.entry.radio import (
    BROWNOUT_DENSITY,
    PER_CM3,
    STAGNATION,
    WAKE,
    arrival_probability,
    attenuation,
    critical_density,
    crossing_times,
    plasma_frequency,
    published_critical_density,
)
from compass.entry.views import cartesian_of
from compass.papers import lou2017_case as paper
from compass.papers.line_of_sight import misses
from compass.papers.lou_filters import FilterSettings
from compass.papers.lou_montecarlo import monte_carlo
from compass.papers.verdict import Erratum, Row, claim, compare, computed

if TYPE_CHECKING:
    import xarray as xr

TITLE = (
    "Lou, Wang, Ding and Zhao 2017, Mars Atmospheric Entry Integrated Navigation with Partial "
    "Intermittent Measurements, Int. J. Aerospace Engineering 2017, 4378640, "
    "doi 10.1155/2017/4378640"
)
Array = NDArray[np.float64]

RUNS, SEED = 300, 1
NO_RANGES = (Fault("all-ranges-lost"),)
#: Section 3.2: seconds at which the signal begins to fade, is lost, comes back, is clear.
CROSSINGS = {"stagnation": ("6", "15", "91", "98"), "wake": ("30", "41", "81", "87")}
TEXT_ANGLE_SIGMA_DEG = 1.0
#: Peaks, per cm^3, and when.
PEAKS = {"stagnation": "3.69e12", "wake": "3.70e10"}
PEAK_TIME = "64"
_SURROGATE = (
    "the three constants of the electron density were fitted to the paper's crossings and peaks: "
    "its program is not public"
)
#: Exponents of metre, kilogram, second, ampere.
_COULOMB, _FARAD, _METRE, _KILOGRAM = (
    np.array(exponents) for exponents in ((0, 0, 1, 1), (-2, -1, 4, 2), (1, 0, 0, 0), (0, 1, 0, 0))
)


def rows() -> list[Row]:
    """Every table and figure of the paper."""
    return [
        *plasma_rows(),
        *crossing_rows(),
        *setting_rows(),
        exchanged_row(),
        *navigation_rows(),
    ]


def plasma_rows() -> list[Row]:
    """Equations 8 to 11 and Figure 2."""
    by_square = published_critical_density() / 1e9
    # square of eq. 8: q^2 n / (eps0 m), with eps0 in F/m^2 as printed and in F/m
    left = [2 * _COULOMB - 3 * _METRE - (_FARAD - k * _METRE) - _KILOGRAM for k in (2, 1)]
    frequency = [float(plasma_frequency(1.9941e9 * per) / 1e6) for per in (1.0, PER_CM3)]
    rounded = np.sqrt(1.6e-19**2 * 1.9941e15 / (8.85e-12 * 9.1e-31)) / (2 * np.pi) / 1e6
    fade = [float(attenuation(n)) for n in (critical_density() * 0.999, 1e10 * PER_CM3)]
    beyond = [1 - float(np.exp(-(n**2) / (2 * 2.5**2))) for n in (3.08, 19.941)]
    within = [float(b) for b in arrival_probability(np.array([3.08e14, 19.941e14]))]
    return [
        claim(
            "Metres and seconds in the square of the plasma frequency: eps0 in F/m^2, in F/m",
            "eq. 8",
            "eps0 = 8.85e-12 F/m^2",
            (left[0][0], left[0][2], left[1][0], left[1][2]),
            "exponents",
            "0 and -2 for the first",
            lambda metres, seconds, *_: metres == 0 and seconds == -2,
            shown="{:.0f}, {:.0f}; {:.0f}, {:.0f}",
            erratum=Erratum(
                "eps0 is in F/m: only so a frequency comes out",
                shown=lambda a, b, c, d: a != 0 and b == d == -2 and c == 0,
            ),
        ),
        compare(
            "Plasma frequency at 1.9941e9 per cm^3 with the constants printed",
            "eq. 8",
            "401",
            rounded,
            "MHz",
        ),
        claim(
            "Plasma frequency at 1.9941e9 electrons per m^3 as printed; per cm^3",
            "section 3.2",
            "401 MHz at 1.9941e9 particles/m3",
            frequency,
            "MHz",
            "the first is 401 within 0.5",
            lambda per_m3, _: abs(per_m3 - 401) < 0.5,
            shown="{:.3f}; {:.3f}",
            erratum=Erratum(
                "the number is per cm^3", shown=lambda a, b: abs(b - 401) < 0.5 < abs(a - 401)
            ),
        ),
        compare(
            "critical electron density at 401 MHz",
            "section 3.2",
            "1.9941",
            critical_density() / PER_CM3 / 1e9,
            "1e9 per cm^3",
            erratum=Erratum("(f/8980)^2 with a rounded constant", makes=by_square),
        ),
        compare(
            "constant of the attenuation, 40 pi log10(e)",
            "eq. 9",
            "54.6",
            float(40 * np.pi * np.log10(np.e)),
            "dB",
        ),
        claim(
            "attenuation just below the critical density, and at 1e10 electrons per cm^3",
            "Figure 2",
            "negligible below, strong above the critical density",
            fade,
            "dB/m",
            "0, and above 100",
            lambda below, above: below == 0 and above > 100,
            shown="{:.3g}, {:.4g}",
        ),
        claim(
            "Probability of arrival at the brownout and the blackout density: F of eq. 11 as "
            "printed (tau 2.5, unit 1e8 per cm^3); 1 - F of scale 2.78e8",
            "eq. 11, Figure 5",
            "the Rayleigh distribution gives the probability of arrival",
            (*beyond, *within),
            "1",
            "the first two fall",
            lambda fading, lost, *_: fading > lost,
            shown="{:.3f}, {:.3f}; {:.3f}, {:.1e}",
            erratum=Erratum(
                "F rises with the density; the share above, 1 - F, is meant",
                shown=lambda fading, lost, clear, gone: fading < lost and clear > gone,
            ),
        ),
    ]


def crossing_rows() -> list[Row]:
    """Section 3.2: when the signal fades, is lost, comes back; all of it fitted."""
    case = paper.case(plasma=False)
    made = []
    for place, model in (("stagnation", STAGNATION), ("wake", WAKE)):
        n = case.electrons(model)
        fade, clear = crossing_times(case.times, n, BROWNOUT_DENSITY.value)
        lost, back = crossing_times(case.times, n, critical_density())
        words = ("signal begins to fade", "signal lost", "signal comes back", "signal clear again")
        for said, time, what in zip(
            CROSSINGS[place], (fade, lost, back, clear), words, strict=True
        ):
            made.append(_fitted(f"{what}, {place}", "section 3.2", said, float(time), "s", 1.0))
        peak = float(PEAKS[place])
        made.append(
            _fitted(
                f"peak electron density, {place}",
                "Figure 6",
                PEAKS[place],
                float(n.max() / PER_CM3),
                "per cm^3",
                0.02 * peak,
            )
        )
        at = float(case.times[n.argmax()])
        made.append(_fitted(f"time of that peak, {place}", "Figure 6", PEAK_TIME, at, "s", 1.0))
        if place == "wake":
            made.append(
                _fitted("blackout", "sections 3.2 and 6", "40", float(back - lost), "s", 1.0)
            )
    beta = paper.case().arrival
    assert beta is not None
    partial = (beta[:, 0] < 1) & (beta[:, 0] > 1.0001e-8)
    made += [
        _fitted("seconds of brownout", "section 6", "17", float(partial.sum()), "s", 1.0),
        computed(
            "ranges of one orbiter expected to arrive in brownout", "-", beta[partial, 0].sum(), "1"
        ),
    ]
    return made


def _fitted(
    item: str, where: str, published: str, crossing: float, unit: str, tolerance: float
) -> Row:
    why = "the paper's program prints every second" if unit == "s" else "two per cent"
    return compare(
        item, where, published, crossing, unit, tolerance=tolerance, why=why, fitted=_SURROGATE
    )


def setting_rows() -> list[Row]:
    """Figures 3 and 4, Tables 2 and 3."""
    case = paper.case(plasma=False)
    last, seen = case.nominal[-1], case.visible.sum(axis=0)
    drag = 0.5 * case.density * 0.016 * case.nominal[:, 3] ** 2
    lander = cartesian_of(case.nominal)[:, :3]
    straight = misses(lander, case.beacons.r[:, 0], paper.PLANET_RADIUS).sum()
    r, v = paper.POSITIONS_KM[2] * 1e3, paper.VELOCITIES[2]
    return [
        claim(
            "end of the trajectory: altitude, speed",
            "Figure 3",
            "terminated after approximately 250 s",
            ((last[0] - paper.PLANET_RADIUS) / 1e3, last[3]),
            "km, m/s",
            "5 to 15 km, below 500 m/s: where parachutes open",
            lambda altitude, speed: 5 < altitude < 15 and speed < 500,
            shown="{:.2f}, {:.2f}",
        ),
        compare(
            "peak drag",
            "section 1",
            "15",
            float(drag.max()) / 9.80665,
            "g",
            tolerance=1.0,
            why="said of Curiosity, whose entry this resembles",
        ),
        computed(
            "atmospheric density at 0, 64 and 250 s",
            "Figure 4",
            [case.density[k] for k in (0, 64, 250)],
            "kg/m^3",
            shown="{:.3g}, {:.3g}, {:.3g}",
            note="the text prints no number of this figure",
        ),
        claim(
            "seconds of 251 in sight of orbiting beacons 1, 2, 3; of beacon 1 by straight lines",
            "Table 3",
            "three orbiters within sight",
            (*seen, straight),
            "s",
            "251 each",
            lambda *seconds: min(seconds) == len(case.times),
            shown="{:.0f}, {:.0f}, {:.0f}; {:.0f}",
            erratum=Erratum(
                "orbiting beacon 1 sets; results with all three let ranges pass through the planet",
                shown=lambda first, two, three, line: first == line < len(case.times),
            ),
        ),
        claim(
            "periapsis of orbiting beacon 3 above 3397.2 km: by energy; by the eccentricity vector",
            "Table 3",
            "an orbiter",
            [(height - paper.PLANET_RADIUS) / 1e3 for height in periapsis_radii(r, v)],
            "km",
            "above 0",
            lambda by_energy, _: by_energy > 0,
            shown="{:.3f}; {:.3f}",
            erratum=Erratum(
                "its periapsis lies under the surface",
                shown=lambda one, two: abs(one - two) < 1e-6 and one < 0,
            ),
        ),
        claim(
            "sigma of flight-path angle and azimuth: in the text; in Table 2",
            "section 5, Table 2",
            "one setting",
            (TEXT_ANGLE_SIGMA_DEG, float(np.degrees(paper.START_SIGMA[4]))),
            "deg",
            "equal",
            lambda text, table: abs(text - table) < 1e-9,
            shown="{:g}; {:g}",
            erratum=Erratum(
                "text and table contradict each other; Table 2 is taken",
                shown=lambda text, table: abs(text - table) > 1e-9,
            ),
        ),
    ]


def periapsis_radii(r: Array, v: Array) -> tuple[float, float]:
    """Periapsis radius of an orbit, metres, from its energy and from its eccentricity vector."""
    distance = float(np.linalg.norm(r))
    momentum = np.cross(r, v)
    square = float(momentum @ momentum) / paper.GM
    energy = float(v @ v) / 2 - paper.GM / distance
    by_energy = square / (1 + np.sqrt(1 + 2 * energy * square / paper.GM))
    vector = np.cross(v, momentum) / paper.GM - r / distance
    axis = -paper.GM / (2 * energy)
    return float(by_energy), float(axis * (1 - np.linalg.norm(vector)))


def predicted_information(p: Array, transition: Array, noise: Array, *, as_printed: bool) -> Array:
    """Information after a step, eq. 20, from the covariance before: with A as printed or mended.

    ``A - A (A + Q^-1)^-1 A``, with ``A = Phi^-1 P^-1 Phi^-T`` as printed, ``Phi^-T P^-1 Phi^-1``
    mended.
    """
    back, before = np.linalg.inv(transition), np.linalg.inv(p)
    a = back @ before @ back.T if as_printed else back.T @ before @ back
    return a - a @ np.linalg.inv(a + np.linalg.inv(noise)) @ a


def exchanged_row() -> Row:
    """Equation 20 against ``(Phi P Phi^T + Q)^-1`` for a transition and covariances by seed."""
    random = np.random.default_rng(SEED)
    transition = np.eye(6) + 0.3 * random.normal(size=(6, 6))
    half = random.normal(size=(2, 6, 6))
    p, noise = (m @ m.T + np.eye(6) for m in half)
    right = np.linalg.inv(transition @ p @ transition.T + noise)
    off = [
        np.linalg.norm(predicted_information(p, transition, noise, as_printed=printed) - right)
        / np.linalg.norm(right)
        for printed in (True, False)
    ]
    return claim(
        "Predicted information against the inverse of Phi P Phi^T + Q: as printed; transposes "
        "exchanged",
        "eq. 20",
        "the time update",
        off,
        "relative",
        "the first is rounding",
        lambda as_printed, _: as_printed < 1e-9,
        shown="{:.3g}; {:.1e}",
        erratum=Erratum(
            "A = Phi^-T P^-1 Phi^-1",
            shown=lambda as_printed, exchanged: exchanged < 1e-9 < 1e-3 < as_printed,
        ),
    )


def navigation_rows() -> list[Row]:
    """Figures 7 to 9: filters with and without ranges."""
    case = paper.case()

    def fly(settings: FilterSettings, ranges: bool, see_through: bool = True) -> "xr.Dataset":
        faults = () if ranges else NO_RANGES
        return monte_carlo(case, settings, RUNS, SEED, faults=faults, see_through=see_through)

    narrow = fly(paper.six_state_filter("intermittent", paper.SMALL_Q), ranges=False)
    six_imu = fly(paper.six_state_filter("intermittent"), ranges=False)
    six = fly(paper.six_state_filter("intermittent"), ranges=True)
    eight_imu = fly(paper.recommended_filter("intermittent"), ranges=False)
    eight = fly(paper.recommended_filter("intermittent"), ranges=True)
    honest = fly(paper.recommended_filter("intermittent"), ranges=True, see_through=False)
    blind = fly(paper.recommended_filter("information"), ranges=True)
    names = [str(name) for name in narrow.state.values]
    said = [name in {"radius", "speed", "flight-path angle", "latitude"} for name in names]
    chosen = "the paper prints no Q and R: these were chosen so that the filter shows this"
    six_end, six_imu_end, eight_end, eight_imu_end, honest_end = (
        float(d.rmse.values[-1, 0]) for d in (six, six_imu, eight, eight_imu, honest)
    )
    return [
        claim(
            f"least share of {RUNS} runs within 3 sigma, IMU alone: {', '.join(names)}",
            "Figure 7",
            "altitude, velocity, FPA, latitude leave their bounds",
            narrow.capture.min("time").values,
            "1",
            "below 0.9 for these and no other",
            lambda *shares: (
                [share < 0.9 for share in shares] == said and all(share >= 0 for share in shares)
            ),
            shown=", ".join(["{:.2f}"] * len(names)),
            fitted=chosen,
        ),
        claim(
            "final altitude RMSE, six states: IMU alone, IFIM",
            "Figure 9",
            "IFIM obviously smaller",
            (six_imu_end, six_end),
            "m",
            "a twentieth or less",
            lambda alone, ranges: ranges < 0.05 * alone,
            shown="{:.0f}, {:.1f}",
        ),
        claim(
            f"smallest mean share of errors of {RUNS} runs within 3 sigma, IFIM, six states",
            "Figure 8",
            "almost all captured",
            float(six.capture[1:].mean("time").min()),
            "1",
            "above 0.9",
            lambda share: share > 0.9,
            fitted=chosen,
        ),
        claim(
            f"smallest mean share of errors of {RUNS} runs within 3 sigma, IFIM, eight states",
            "Figure 8",
            "almost all captured",
            float(eight.capture[1:].mean("time").min()),
            "1",
            "above 0.98",
            lambda share: share > 0.98,
        ),
        claim(
            "final altitude RMSE, eight states: IMU alone, IFIM, IFIM with hidden orbiter 1",
            "Figure 9",
            "IFIM obviously smaller",
            (eight_imu_end, eight_end, honest_end),
            "m",
            "a twentieth or less",
            lambda alone, ranges, hidden: max(ranges, hidden) < 0.05 * alone,
            shown="{:.1f}, {:.1f}, {:.1f}",
        ),
        claim(
            "altitude RMSE at 80 s and 95 s, eight states, after blackout",
            "Figure 8",
            "reconverges",
            (eight.rmse.values[80, 0], eight.rmse.values[95, 0]),
            "m",
            "falls to 0.6 or less",
            lambda before, after: after < 0.6 * before,
            shown="{:.1f}, {:.1f}",
        ),
        claim(
            f"runs of {RUNS} of the information filter that takes lost ranges as arrived",
            "section 5",
            "may diverge",
            float(blind.attrs["diverged"]),
            "runs diverged",
            "more than half",
            lambda runs: runs > 0.5 * RUNS,
        ),
    ]

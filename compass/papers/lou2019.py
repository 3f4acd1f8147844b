"""Lou et al. 2019: observability, filters, weights and faults, published against computed."""

from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from compass.core.papers.lou_measurement import predict_measurements
from compass.core.papers.lou_montecarlo import make_trace, track
from compass.entry.views import cartesian_of
from compass.papers import lou2019_case as paper
from compass.papers.line_of_sight import misses
from compass.papers.lou2019_runs import fault_rows, published_runs, recommended_runs
from compass.papers.lou_case import NavigationCase
from compass.papers.lou_filters import Algorithm, FilterSettings
from compass.papers.lou_observability import (
    imu_range_matrix,
    observability_degree,
    rotation_about_beacon,
    singular_values,
)
from compass.papers.spherical import spherical_parameters
from compass.papers.verdict import Erratum, Row, claim, computed, extremes

TITLE = (
    "Lou, Chen, Wang, He and Liu 2019, Reliable Distributed Integrated Navigation Based on CI "
    "during Mars Entry, Int. J. Aerospace Engineering 2019, 1802659, doi 10.1155/2019/1802659"
)


def rows() -> list[Row]:
    """Every table and figure of the paper."""
    return [
        *setting_rows(),
        *observability_rows(),
        *published_runs(),
        *recommended_runs(),
        *fault_rows(),
        _time_row(),
    ]


#: Relief of Mars above the reference figure, metres: Hellas's floor and Olympus Mons, rounded
#: outwards (Smith et al. 2001, J. Geophys. Res. 106:23689).
RELIEF = (-8.3e3, 21.3e3)
#: Exponents of metre, kilogram of a ballistic coefficient m/(C_D S) and of its printed unit.
DEFINED, PRINTED_UNIT = (-2, 1), (2, -1)


def setting_rows() -> list[Row]:
    """Tables 1 and 2 and what they say of the start, the beacons, the air and the vehicle."""
    hidden, seen = paper.case(paper.PRINTED_POINT), paper.case()
    radii = np.linalg.norm(paper.POSITIONS_KM * 1e3, axis=1)
    straight = [
        misses(cartesian_of(case.nominal)[:, None, :3], case.beacons.r, paper.PLANET_RADIUS)
        for case in (hidden, seen)
    ]
    speed2 = float(np.sum(paper.VELOCITIES[2] ** 2))
    # at right angles to its radius: an apsis, so r_other = r / (2 GM/(v^2 r) - 1)
    other = float(radii[2] / (2 * paper.GM / (speed2 * radii[2]) - 1))
    air = hidden.truth.atmosphere
    surface = paper.DENSITY * float(
        np.exp((air.reference_radius - paper.PLANET_RADIUS) / air.scale_height)
    )
    drag = [
        float((0.5 * seen.density * seen.nominal[:, 3] ** 2 * b).max() / 9.80665)
        for b in (paper.DRAG_AREA, 1 / paper.DRAG_AREA)
    ]
    return [
        claim(
            "seconds of 301 with a beacon in sight, from the printed start; by straight lines",
            "Table 1, section 4.1",
            "all the time",
            (hidden.visible.any(axis=1).sum(), straight[0].any(axis=1).sum()),
            "s",
            "301",
            lambda found, _: found == len(hidden.times),
            shown="{:.0f}; {:.0f}",
            erratum=Erratum(
                "none of the four beacons of Table 2 is ever in line of sight from lon -89.872, "
                "lat -28.02; from lon = lat = 0 all four always are",
                shown=lambda found, line: found == line == 0,
            ),
        ),
        computed(
            "seconds of 301 with all beacons in sight, from lon = lat = 0; by straight lines",
            "-",
            (seen.visible.all(axis=1).sum(), straight[1].all(axis=1).sum()),
            "s",
            shown="{:.0f}; {:.0f}",
            note="the start used here instead",
        ),
        *(
            claim(
                f"height of surface beacon {k + 1} above 3397.2 km",
                "Table 2",
                "on the surface",
                float(radii[k] - paper.PLANET_RADIUS) / 1e3,
                "km",
                "within the relief of Mars, -8.3 to 21.3",
                lambda height: RELIEF[0] <= height * 1e3 <= RELIEF[1],
                erratum=Erratum(
                    "the printed position lies above the highest mountain",
                    shown=lambda height: height * 1e3 > RELIEF[1],
                ),
            )
            for k in range(2)
        ),
        claim(
            "least and greatest height of orbiting beacon 1, v^2 r over GM",
            "Table 2",
            "an orbiting beacon",
            (
                (min(other, radii[2]) - paper.PLANET_RADIUS) / 1e3,
                (max(other, radii[2]) - paper.PLANET_RADIUS) / 1e3,
                speed2 * radii[2] / paper.GM,
            ),
            "km, km, 1",
            "the first above 200, the last below 2 (1 would be a circle)",
            lambda low, high, energy: low > 200 and energy < 2,
            shown="{:.0f}, {:.0f}, {:.4f}",
        ),
        claim(
            "density by eq. 3 with 2e-4 at r0: at the surface of 3397.2 km; at r0",
            "Table 1, eq. 3",
            "surface density 2e-4",
            (surface, paper.DENSITY),
            "kg/m^3",
            "the first is 2e-4 within 10 %",
            lambda at_surface, _: abs(at_surface / 2e-4 - 1) < 0.1,
            shown="{:.4f}; {:.4f}",
            erratum=Erratum(
                "2e-4 is the density at r0, 40 km up",
                shown=lambda at_surface, at_r0: (
                    at_surface > 100 * at_r0 and abs(at_r0 / 2e-4 - 1) < 0.1
                ),
            ),
        ),
        claim(
            "exponents of metre and kilogram: of m/(C_D S); of m^2/kg; peak drag (g) if 0.016 is "
            "C_D S/m, if m/(C_D S)",
            "section 2.1, section 4",
            "B = m/(C_D S) = 0.016 m^2/kg",
            (*DEFINED, *PRINTED_UNIT, *drag),
            "1",
            "alike",
            lambda m, kg, unit_m, unit_kg, *_: m == unit_m and kg == unit_kg,
            shown="{:.0f}, {:.0f}; {:.0f}, {:.0f}; {:.1f}, {:.0f}",
            erratum=Erratum(
                "the number and its unit are those of C_D S/m; as m/(C_D S) the drag would be "
                "thousands of g",
                shown=lambda m, kg, unit_m, unit_kg, right, wrong: (
                    m == -unit_m and kg == -unit_kg and right < 50 and wrong > 1000
                ),
            ),
        ),
    ]


def observability_rows() -> list[Row]:
    """Figures 2 and 3."""
    case = paper.case()
    still = np.zeros((4, 3))
    to_linear = np.ones(8)
    to_linear[6] = 1.0 / paper.DENSITY  # column of rho0 instead of ln rho0
    degrees = np.array(
        [
            observability_degree(
                imu_range_matrix(case.truth, case.nominal[k], case.beacons.r[k], still) * to_linear
            )
            for k in range(0, 301, 10)
        ]
    )
    lone = imu_range_matrix(case.truth, case.nominal[0], case.beacons.r[0, :1], still[:1])
    values, _ = singular_values(lone)
    turn = rotation_about_beacon(case.nominal[0], case.beacons.r[0, 0])
    left = np.abs(lone @ turn).max() / (np.abs(lone) @ np.abs(turn)).max()
    where = "Figure 2"
    elsewhere = "from lon = lat = 0: from the printed start no beacon is in sight"
    return [
        extremes(
            "section 2.4",
            "maximum and minimum observability degrees",
            (PRINTED_MAXIMUM, PRINTED_MINIMUM),
            (degrees.min(), degrees.max()),
            "SI",
        ),
        claim(
            "observability degree of all measurements, smallest",
            where,
            PRINTED_MAXIMUM,
            float(degrees.min()),
            "SI",
            "within a factor of 3",
            lambda degree: 1 / 3 < degree / float(PRINTED_MAXIMUM) < 3,
            note=f"at entry drag is a millimetre per second squared ({elsewhere})",
        ),
        claim(
            "observability degree of all measurements, largest",
            where,
            PRINTED_MINIMUM,
            float(degrees.max()),
            "SI",
            "within a factor of 3",
            lambda degree: 1 / 3 < degree / float(PRINTED_MINIMUM) < 3,
            note=elsewhere,
        ),
        claim(
            "smallest over largest singular value of IMU and one fixed beacon; what turning the "
            "flight about the axis through the beacon changes",
            "Figure 3",
            "1e-16 to 1e-13: weakly observable",
            (values[-1] / values[0], left),
            "SI; relative",
            "the turn changes more than rounding, 1e-12",
            lambda _, change: change > 1e-12,
            shown="{:.1e}; {:.1e}",
            erratum=Erratum(
                "exactly rank 7 of 8: the turn changes no measurement, and the printed numbers are "
                "rounding noise",
                shown=lambda ratio, change: change <= 1e-12 and ratio < 1e-12,
            ),
        ),
    ]


#: Section 2.4's "maximum and minimum" degree, in its order.
PRINTED_MAXIMUM, PRINTED_MINIMUM = "1e-8", "1e-7"


def noiseless(case: NavigationCase) -> NDArray[np.float64]:
    """Measurements along a case's flight without noise, shape (K+1, 3 + m)."""
    m = case.beacons.size
    z, slopes = np.empty((case.times.size, 3 + m)), np.empty((3 + m, 8))
    p = spherical_parameters(case.truth)
    for k, x in enumerate(case.nominal):
        predict_measurements(x, 8, p, False, case.beacons.r[k], z[k], slopes)
    return z


def step_seconds(settings: FilterSettings, case: NavigationCase, repeats: int = 5) -> float:
    """Time of one step of a filter on one core, s: the best of some passes over the entry."""
    algorithm, kernel_settings, belief = settings.kernel_arguments(case.step)
    epochs, m = case.visible.shape
    trace = make_trace(settings.states, belief.x0.size, epochs, m)
    trace.z[:] = noiseless(case)
    trace.arrived[:] = True
    banks, alive = np.zeros(epochs), np.ones((epochs, m), dtype=bool)
    best = np.inf
    for _ in range(repeats + 1):
        begin = perf_counter()
        track(algorithm, kernel_settings, belief, belief.x0, banks, case.beacons.r, alive, trace)
        best = min(best, perf_counter() - begin)
    return best / (epochs - 1)


def _time_row() -> Row:
    case = paper.case()
    names: tuple[Algorithm, ...] = ("ekf", "dcifaif", "ci")
    times = {name: step_seconds(paper.recommended_filter(name), case) for name in names}
    return claim(
        f"CPU time of one step, one core: {', '.join(names)}",
        "Table 3",
        "EKF 41700, CI 60000, DCIFAIF 19000: DCIFAIF fastest",
        [times[name] * 1e6 for name in names],
        "microseconds",
        "DCIFAIF is fastest",
        lambda ekf, dcifaif, ci: dcifaif < min(ekf, ci),
        shown="{:.2g}, {:.2g}, {:.2g}",
        note="here four local filters, done one after the other, take longer than the one",
    )

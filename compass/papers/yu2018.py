"""Yu et al. 2018: Tables 1 to 6 and Figures 1, 3 to 7 and 9 to 12 of the observability chapter."""

import numpy as np

from compass.core.entry_geometry import cartesian_of
from compass.entry.fisher import (
    best_determinant,
    position_variance_bound,
    published_position_variance_bound,
    two_beacon_eigenvalues,
)
from compass.entry.schedule import in_view
from compass.entry.trajectory import fly
from compass.papers import yu2018_case as paper
from compass.papers.verdict import Row, compare, judge_claim
from compass.papers.yu2018_ground import filter_rows, ground_rows
from compass.papers.yu2018_orbiters import comparison_rows, orbiter_rows

TITLE = (
    "Z. Yu, P. Cui, R. Xu and S. Zhu, Mars Networks-Based Navigation: Observability and "
    "Optimization, InTechOpen 2018, doi 10.5772/intechopen.73605"
)

_TABLE_1 = {3: "1.000", 4: "2.3704", 5: "4.6296", 6: "8.0000", 7: "12.7037", 8: "18.9630"}


def rows() -> list[Row]:
    """Every table, figure and checkable statement."""
    return [
        *_dynamics(),
        *_information(),
        *ground_rows(),
        *filter_rows(),
        *orbiter_rows(),
        *comparison_rows(),
    ]


def _dynamics() -> list[Row]:
    exact = cartesian_of(paper.ground_flight().states[-1])[:3]
    printed = fly(paper.model("published-coriolis"), paper.table_2(), [0.0, 240.0]).states[-1]
    apart = float(np.linalg.norm(cartesian_of(printed)[:3] - exact)) / 1e3
    beacons = paper.ground_beacons()
    seen = in_view(beacons, paper.ground_flight().states, paper.RADIUS)
    return [
        judge_claim(
            "Coriolis terms of gamma' and psi' as printed: error at 240 s",
            "eq. 1",
            "the equations of motion",
            apart,
            "km",
            False,
            "the two terms are exchanged; the mended ones agree with Newton's law in the "
            "rotating frame",
        ),
        judge_claim(
            "Altitude at the end of the 240 s",
            "Table 2, Figure 3",
            "the entry phase lasts approximately 240 s",
            float(paper.ground_flight().altitude[-1]) / 1e3,
            "km",
            paper.ground_flight().ending == "",
            "the lander is in the ground before",
        ),
        judge_claim(
            "Epochs at which the three beacons of Figure 4 see the lander",
            "eq. 52, Figure 3",
            "in view during the whole entry (241 epochs)",
            int(seen.all(axis=1).sum()),
            "1",
            bool(seen.all()),
            "a beacon loses sight",
        ),
    ]


def _information() -> list[Row]:
    table = [
        compare(
            f"Maximum determinant of {n} beacons, in sigma^-6",
            "Table 1",
            printed,
            best_determinant(np.ones(n)),
        )
        for n, printed in _TABLE_1.items()
    ]
    unequal = two_beacon_eigenvalues(1.0, 1.0, np.radians(60.0))
    return [
        *table,
        judge_claim(
            "Maximum determinant of 4 beacons of sigma 2, by eq. 40",
            "eq. 40",
            "(N / (3 sigma^-2))^3",
            best_determinant(np.full(4, 2.0)),
            "m^-6",
            False,
            "the exponent is misprinted: (N sigma^-2 / 3)^3, in closed form for every N >= 3",
        ),
        judge_claim(
            "Lower bound of the trace of the error covariance, 6 beacons of sigma 1",
            "eqs. 28, 32, 35, 41 and Figure 1",
            f"3 sigma^2 / N = {published_position_variance_bound(np.ones(6)):g}",
            position_variance_bound(np.ones(6)),
            "m^2",
            False,
            "true but weak: tr F^-1 >= 9/tr F, so 9 sigma^2 / N; below three beacons none exists",
        ),
        judge_claim(
            "Bound falls as 1/N",
            "Figure 1",
            "more beacons, slower and slower gain",
            position_variance_bound(np.ones(8)) / position_variance_bound(np.ones(4)),
            "1",
            True,
            "",
        ),
        judge_claim(
            "Larger over smaller eigenvalue of two equal beacons 60 deg apart",
            "section 4.3",
            "equal (1)",
            float(unequal[0] / unequal[1]),
            "1",
            False,
            "equal only if the directions are orthogonal and the noise alike",
        ),
    ]

"""Kelly and Bevilacqua 2018 (COMPASS): Tables 1 to 4 and the text's statements on coverage."""

import numpy as np

from compass.bodies import KELLY2018_RADIUS, sidereal_day
from compass.coverage.certificate import fold_range
from compass.coverage.count import count_map
from compass.coverage.geometry import pattern_geometry
from compass.coverage.grid import equal_angle_grid
from compass.coverage.view import view
from compass.orbits import (
    Constellation,
    areosynchronous_radius,
    orbital_period,
    walker_delta,
)
from compass.papers import kelly2018_access, kelly2018_claims, kelly2018_smallest
from compass.papers.kelly2018_geometry import geometry_rows
from compass.papers.verdict import Erratum, Row, claim, compare, computed
from compass.units import KM

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018"
)
ORBIT_RADIUS = 20_427e3


def constellation(sphere_radius: float = ORBIT_RADIUS) -> Constellation:
    """The paper's 15 satellites: 45 deg: 15/5/1, at an orbit radius in metres."""
    return walker_delta(
        15, 5, 1, inclination_deg=45.0, radius_km=sphere_radius / 1e3, name="COMPASS 15/5/1"
    )


def rows() -> list[Row]:
    """Every number of Tables 1 to 4 and of the text on coverage, population and stations."""
    parts = (kelly2018_claims, kelly2018_smallest, kelly2018_access)
    return [*coverage_rows(), *(row for part in parts for row in part.rows())]


def coverage_rows() -> list[Row]:
    """Tables 1 to 4 and the satellites in view: what takes no search and no event finding."""
    geometry = pattern_geometry(constellation(), KELLY2018_RADIUS.value)
    assert geometry is not None
    return [*table_1_rows(), *geometry_rows(geometry), *_fold_rows()]


def table_1_rows() -> list[Row]:
    """Table 1."""
    c = constellation()
    assert c.pattern is not None
    p = c.pattern
    u = np.degrees(c.mean_anomaly)
    spacing = float(np.degrees(c.raan[p.per_plane] - c.raan[0]))
    altitude = (ORBIT_RADIUS - KELLY2018_RADIUS.value) / KM
    hours = float(orbital_period(ORBIT_RADIUS)) / 3600
    return [
        compare("Number of satellites", "Table 1", "15", c.size),
        compare("Number of planes", "Table 1", "5", p.planes),
        compare("Satellites per plane", "Table 1", "3", p.per_plane),
        compare("Uniformity phase angle", "Table 1", "24", float(u[p.per_plane] - u[0]), "deg"),
        compare("Nodal phase difference", "Section III", "72", spacing, "deg"),
        compare("Orbit inclination", "Table 1", "45", float(np.degrees(c.inclination[0])), "deg"),
        compare(
            "Orbit altitude",
            "Table 1",
            "20427",
            altitude,
            "km",
            erratum=Erratum(
                "the number is the radius of the orbit, as Table 2 says, to the digits of the "
                "areosynchronous one",
                makes=float(np.floor(areosynchronous_radius() / KM)),
            ),
        ),
        compare(
            "Areosynchronous radius",
            "Tables 1 and 2",
            "20427",
            areosynchronous_radius() / KM,
            "km",
            erratum=Erratum(
                "cut, not rounded: (GM/omega^2)^(1/3) rounds to 20 428 km",
                makes=float(np.floor(areosynchronous_radius() / KM)),
            ),
        ),
        claim(
            "Period of an orbit, and a sidereal day of Mars",
            "Section III",
            "cycle orbits once daily",
            (hours, sidereal_day() / 3600),
            "h",
            "equal within 0.1 %",
            lambda period, day: abs(period - day) < 1e-3 * day,
            shown="{:.4f}, {:.4f}",
        ),
    ]


def _fold_rows() -> list[Row]:
    """Fold over the sphere, exact; inside the gaps, sampled at 1 degree and 96 epochs."""
    c, grid = constellation(), equal_angle_grid(np.radians(1.0))
    # both are settled: their bounds meet
    (low, _), (_, high) = fold_range(c, sphere_radius=KELLY2018_RADIUS.value)
    assert c.pattern is not None
    times = np.arange(96) * float(orbital_period(ORBIT_RADIUS)) / 96
    whole = view(c, times, KELLY2018_RADIUS.value)
    total = count_map(whole, grid)
    in_gap = np.zeros(total.shape, dtype=bool)
    for k in range(c.pattern.planes):
        others = [s for s in range(c.size) if s // c.pattern.per_plane != k]
        plane = view(c.without(others), times, KELLY2018_RADIUS.value)
        in_gap |= count_map(plane, grid) == 0
    gap_low, gap_high = int(total[in_gap].min()), int(total[in_gap].max())
    mean = float((total.mean(axis=(0, 2)) * grid.cell_share * grid.columns).sum())
    expected = float(c.size * (1 - whole.cos_cap[0, 0]) / 2)
    return [
        compare("Fewest satellites in view anywhere", "Section II", "4", low),
        computed("Most satellites in view anywhere", "-", high, "1"),
        compare("Fewest satellites in view inside a gap", "Section III.B", "4", gap_low),
        compare(
            "Most satellites in view inside a gap",
            "Section III.B",
            "7",
            gap_high,
            note="no more than 6 on a grid of 1 degree by 96 epochs",
        ),
        computed("Mean satellites in view", "-", mean, "1"),
        computed("N (1 - cos lambda) / 2", "-", expected, "1"),
    ]

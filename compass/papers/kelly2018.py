"""Kelly and Bevilacqua 2018 (COMPASS): Tables 1 to 4 and the text's statements on coverage."""

from collections.abc import Callable

import numpy as np

from compass.bodies import KELLY2018_RADIUS
from compass.coverage.cap import published_cap_area
from compass.coverage.certificate import fold_range
from compass.coverage.count import count_map
from compass.coverage.gap import plane_closes
from compass.coverage.geometry import Geometry, pattern_geometry
from compass.coverage.grid import equal_angle_grid
from compass.coverage.view import view
from compass.orbits import (
    Constellation,
    Pattern,
    areosynchronous_radius,
    orbital_period,
    walker_delta,
)
from compass.orbits.constellation import from_pattern
from compass.papers import kelly2018_access, kelly2018_smallest
from compass.papers.verdict import Row, compare, judge_claim, printed_tolerance

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018"
)
ORBIT_RADIUS = 20_427e3
KM, KM2 = 1e3, 1e6

#: Half a unit of the last printed digit of the paper's two inputs, metres.
RADIUS_ROUNDING, ORBIT_ROUNDING = 50.0, 500.0

_CAP = "eq. 4 adds pi (R^2 - d^2), which is no part of a spherical cap; a cap is 2 pi R d"
_FLAT = "a flat triangle on a curved planet; exact by Gauss and Bonnet"
_COPY = "the row repeats a number of another table; the text's own formula gives the computed value"


def constellation(sphere_radius: float = ORBIT_RADIUS) -> Constellation:
    """The paper's 15 satellites: 45 deg: 15/5/1, at an orbit radius in metres."""
    return walker_delta(
        15, 5, 1, inclination_deg=45.0, radius_km=sphere_radius / 1e3, name="COMPASS 15/5/1"
    )


def rows() -> list[Row]:
    """Every number of Tables 1 to 4 and of the text on coverage, population and stations."""
    return [*coverage_rows(), *kelly2018_smallest.rows(), *kelly2018_access.rows()]


def coverage_rows() -> list[Row]:
    """Tables 1 to 4 and the satellites in view: what takes no search and no event finding."""
    geometry = pattern_geometry(constellation(), KELLY2018_RADIUS.value)
    assert geometry is not None
    return [*_table1(), *geometry_rows(geometry), *_fold_rows()]


def _table1() -> list[Row]:
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
            erratum="the number is the radius from Mars's centre, as Table 2 says",
        ),
        compare(
            "Areosynchronous radius",
            "Tables 1 and 2",
            "20427",
            areosynchronous_radius() / KM,
            "km",
            erratum="cut, not rounded: (GM/omega^2)^(1/3) rounds to 20 428 km",
        ),
        judge_claim(
            "Orbits cycle once daily",
            "Section III",
            "once a day",
            f"period {hours:.4f} h, sidereal day of Mars 24.6230 h",
            "",
            abs(hours * 3600 / 88642.66 - 1) < 1e-3,
            "the period is not a day",
        ),
    ]


def geometry_rows(g: Geometry) -> list[Row]:
    """Tables 2 to 4 and the circumferences, for the analytic geometry of a design.

    The allowance of each row is half a unit of its last printed digit plus what half a unit of
    the paper's two rounded inputs (R to 0.1 km, orbit radius to 1 km) can move it.
    """
    if g.gap is None:
        return []

    def row(
        item: str,
        where: str,
        published: str,
        unit: str,
        scale: float,
        value: Callable[[Geometry], float],
        erratum: str = "",
    ) -> Row:
        computed = value(g) / scale
        moved = sum(abs(value(near) / scale - computed) for near in _roundings(g))
        allowed = printed_tolerance(published) + moved
        return compare(item, where, published, computed, unit, erratum=erratum, tolerance=allowed)

    def share(area: Callable[[Geometry], float]) -> Callable[[Geometry], float]:
        return lambda g: area(g) / g.sphere_area

    def planes_flat(g: Geometry) -> float:
        return g.sphere_area - 2 * _gap(g).flat_area

    def overlap_printed(g: Geometry) -> float:
        return (g.per_plane * published_cap_area(g.cap) - planes_flat(g)) / g.per_plane

    def gaps(g: Geometry) -> float:
        return 2 * g.planes * _gap(g).area

    def gaps_flat(g: Geometry) -> float:
        return 2 * g.planes * _gap(g).flat_area

    swapped = "labels swapped: by eq. 1 theta (9.57 deg) is the half-cone, phi the half-arc angle"
    inherits = "inherits eq. 4: " + _CAP
    return [
        row("Reference radius", "Table 2", "3.3962e3", "km", KM, lambda g: g.cap.sphere_radius),
        row("Half-cone angle", "Table 2", "80.43", "deg", np.pi / 180,
            lambda g: g.cap.half_cone, swapped),
        row("Half-arc angle", "Table 2", "9.57", "deg", np.pi / 180,
            lambda g: g.cap.half_arc, swapped),
        row("Tangent distance s", "Table 2", "2.014e4", "km", KM, lambda g: g.cap.tangent),
        row("Maximum coverage radius h", "Table 2", "3.3486e3", "km", KM,
            lambda g: g.cap.radius, "R sin(phi), the figure's rim radius, is another number"),
        row("Coverage depth d", "Table 2", "2.8316e3", "km", KM, lambda g: g.cap.depth),
        row("Half-arc length L", "Table 2", "4.7675e3", "km", KM, lambda g: g.cap.arc),
        row("Cap area by the printed eq. 4", "Table 2", "7.1469e7", "km^2", KM2,
            lambda g: published_cap_area(g.cap)),
        row("Cap area A_max", "Table 2", "7.1469e7", "km^2", KM2, lambda g: g.cap.area, _CAP),
        row("Cap share of the planet", "Table 4, text", "49.31", "%", 0.01,
            lambda g: g.cap.fraction, _CAP),
        row("Gap triangle area, flat", "Table 3", "1.6721e6", "km^2", KM2,
            lambda g: _gap(g).flat_area),
        row("Gap triangle area", "Table 3", "1.6721e6", "km^2", KM2,
            lambda g: _gap(g).area, _FLAT),
        row("Gap triangle depth l", "Table 3", "7.1469e7", "km", KM,
            lambda g: _gap(g).depth, _COPY),
        row("Gap triangle base Q", "Table 3", "2.014e4", "km", KM, lambda g: _gap(g).base, _COPY),
        row("Limiting circumference C_lim", "Section III.B", "9.83e3", "km", KM,
            lambda g: g.limit_circumference or np.nan),
        row("C_gap by the printed eq. 9", "Section III.B", "1.32e4", "km", KM,
            lambda g: g.published_circumference or np.nan),
        row("C_gap, length of that parallel", "Section III.B", "1.32e4", "km", KM,
            lambda g: g.circumference or np.nan,
            "eq. 9 takes the arc R i - l for the radius of a parallel; it is R sin(i - l/R)"),
        judge_claim("Neighbouring gaps do not overlap", "Section III.B", "C_lim < C_gap",
                    f"{(g.limit_circumference or np.nan) / KM:.2f} < "
                    f"{(g.circumference or np.nan) / KM:.2f} km", "km",
                    (g.limit_circumference or np.inf) < (g.circumference or 0),
                    "the true parallel is shorter than the bases together"),
        row("Reference sphere area", "Table 4", "1.4494e8", "km^2", KM2, lambda g: g.sphere_area),
        row("Plane's served area, flat gaps", "Table 4", "1.4160e8", "km^2", KM2, planes_flat),
        row("Plane's served area", "Table 4", "1.4160e8", "km^2", KM2,
            lambda g: g.plane_area or np.nan, _FLAT),
        row("Plane's served share", "Table 4", "97.69", "%", 0.01,
            share(lambda g: g.plane_area or np.nan), _FLAT),
        row("Constellation's served area by eq. 4", "Table 4", "1.0720e9", "km^2", KM2,
            lambda g: g.published_total_area),
        row("Constellation's served area", "Table 4", "1.0720e9", "km^2", KM2,
            lambda g: g.total_area, inherits),
        row("Constellation's served share", "Table 4", "739.63", "%", 0.01,
            share(lambda g: g.total_area), inherits),
        judge_claim("Served area over that of Mars", "Section III.B", "over 7 times",
                    f"{g.total_area / g.sphere_area:.4f} times", "",
                    g.total_area > 7 * g.sphere_area, inherits),
        row("Overlap of neighbours in a plane, printed formulas", "Table 4", "2.4270e7",
            "km^2", KM2, overlap_printed),
        row("Overlap of neighbours in a plane", "Table 4", "2.4270e7", "km^2", KM2,
            lambda g: g.neighbour_overlap or np.nan, inherits),
        row("Overlap of neighbours, share", "Table 4", "16.74", "%", 0.01,
            share(lambda g: g.neighbour_overlap or np.nan), inherits),
        row("Constellation's redundancy", "Table 4", "9.2710e8", "km^2", KM2,
            lambda g: g.total_area - g.sphere_area, inherits),
        row("Constellation's redundancy, share", "Table 4", "639.63", "%", 0.01,
            share(lambda g: g.total_area - g.sphere_area), inherits),
        row("Gap triangle share", "Table 4", "1.15", "%", 0.01,
            share(lambda g: _gap(g).area), _FLAT),
        row("Total area of gaps, flat", "Table 4", "1.6721e7", "km^2", KM2, gaps_flat),
        row("Total area of gaps", "Table 4", "1.6721e7", "km^2", KM2, gaps, _FLAT),
        row("Total share of gaps", "Table 4", "11.54", "%", 0.01, share(gaps), _FLAT),
        judge_claim("Two satellites do not close a plane, three do", "Section III.A", "3 a plane",
                    f"caps of 2 meet: {plane_closes(g.cap.half_arc, 2)}; "
                    f"of 3: {plane_closes(g.cap.half_arc, 3)}", "",
                    plane_closes(g.cap.half_arc, 3) and not plane_closes(g.cap.half_arc, 2),
                    "the caps' radius says otherwise"),
    ]  # fmt: skip


def _gap(g: Geometry):  # type: ignore[no-untyped-def]  # narrows away None
    assert g.gap is not None
    return g.gap


def _roundings(g: Geometry) -> list[Geometry]:
    """The geometry with each rounded input of the paper moved by half a unit."""
    sphere = g.cap.sphere_radius
    orbit = sphere / np.sin(g.cap.half_cone)
    near = [(orbit + ORBIT_ROUNDING, sphere), (orbit, sphere + RADIUS_ROUNDING)]
    made = [
        pattern_geometry(
            from_pattern(
                Pattern("walker-delta", g.planes * g.per_plane, g.planes, 0, g.inclination), r
            ),
            s,
        )
        for r, s in near
    ]
    return [m for m in made if m is not None and m.gap is not None]


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
        Row("Most satellites in view anywhere", "-", None, high, "1", "not printed"),
        compare("Fewest satellites in view inside a gap", "Section III.B", "4", gap_low),
        compare(
            "Most satellites in view inside a gap",
            "Section III.B",
            "7",
            gap_high,
            erratum="a user in a gap sees no more than 6 (1 degree by 96 epochs)",
        ),
        Row("Mean satellites in view", "-", None, mean, "1", "not printed"),
        Row("N (1 - cos lambda) / 2", "-", None, expected, "1", "not printed"),
    ]

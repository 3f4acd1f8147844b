"""Kelly and Bevilacqua 2018 on caps and gaps: Tables 2 to 4 and the circumferences."""

from collections.abc import Callable

import numpy as np

from compass.coverage.cap import published_cap_area
from compass.coverage.geometry import Geometry, pattern_geometry
from compass.orbits import Pattern
from compass.orbits.constellation import from_pattern
from compass.papers.verdict import Erratum, Row, claim, compare, printed_tolerance
from compass.units import KM, KM2

#: Half a unit of the last printed digit of the paper's two inputs, metres.
RADIUS_ROUNDING, ORBIT_ROUNDING = 50.0, 500.0

_CAP = "eq. 4 adds pi (R^2 - d^2), which is no part of a spherical cap; a cap is 2 pi R d"
_FLAT = "a flat triangle on a curved planet; exact by Gauss and Bonnet"
_COPY = "the row repeats a number of another table; the text's own formula gives the computed value"


def geometry_rows(g: Geometry) -> list[Row]:
    """Tables 2 to 4 and the circumferences, for the analytic geometry of a design.

    The allowance of each row is half a unit of its last printed digit plus what half a unit of
    the paper's two rounded inputs (R to 0.1 km, orbit radius to 1 km) can move it.
    """
    if g.gap is None:
        return []
    near_by = _roundings(g)

    def row(
        item: str,
        where: str,
        published: str,
        unit: str,
        scale: float,
        value: Callable[[Geometry], float],
        reason: str = "",
        makes: Callable[[Geometry], float] | None = None,
    ) -> Row:
        explains = value if makes is None else makes
        moved = sum(abs(explains(near) - explains(g)) for near in near_by) / scale
        allowed = printed_tolerance(published) + moved
        erratum = Erratum(reason, makes(g) / scale) if makes else None
        return compare(
            item, where, published, value(g) / scale, unit,
            erratum=erratum, tolerance=allowed, why="digits of the number and of R and r printed",
        )  # fmt: skip

    def share(area: Callable[[Geometry], float]) -> Callable[[Geometry], float]:
        return lambda g: area(g) / g.sphere_area

    def printed_cap(g: Geometry) -> float:
        return published_cap_area(g.cap)

    def printed_total(g: Geometry) -> float:
        return g.published_total_area

    def printed_redundancy(g: Geometry) -> float:
        return g.published_total_area - g.sphere_area

    def flat(g: Geometry) -> float:
        return _gap(g).flat_area

    def parallel(g: Geometry) -> float:
        return g.published_circumference or np.nan

    def rounded_rim(g: Geometry) -> float:
        return float(
            g.cap.sphere_radius * np.cos(np.radians(np.round(np.degrees(g.cap.half_cone), 1)))
        )

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
            lambda g: g.cap.half_cone, swapped, lambda g: g.cap.half_arc),
        row("Half-arc angle", "Table 2", "9.57", "deg", np.pi / 180,
            lambda g: g.cap.half_arc, swapped, lambda g: g.cap.half_cone),
        row("Tangent distance s", "Table 2", "2.014e4", "km", KM, lambda g: g.cap.tangent),
        row("Maximum coverage radius h", "Table 2", "3.3486e3", "km", KM,
            lambda g: g.cap.radius, "h is R cos(theta); theta was rounded to 9.6 deg before",
            rounded_rim),
        row("Coverage depth d", "Table 2", "2.8316e3", "km", KM, lambda g: g.cap.depth),
        row("Half-arc length L", "Table 2", "4.7675e3", "km", KM, lambda g: g.cap.arc),
        row("Cap area by the printed eq. 4", "Table 2", "7.1469e7", "km^2", KM2,
            printed_cap),
        row("Cap area A_max", "Table 2", "7.1469e7", "km^2", KM2, lambda g: g.cap.area, _CAP,
            printed_cap),
        row("Cap share of the planet", "Table 4, text", "49.31", "%", 0.01,
            lambda g: g.cap.fraction, _CAP, share(printed_cap)),
        row("Gap triangle area, flat", "Table 3", "1.6721e6", "km^2", KM2,
            flat),
        row("Gap triangle area", "Table 3", "1.6721e6", "km^2", KM2,
            lambda g: _gap(g).area, _FLAT, flat),
        row("Gap triangle depth l", "Table 3", "7.1469e7", "km", KM,
            lambda g: _gap(g).depth, _COPY + "; here A_max of Table 2, in km^2",
            lambda g: published_cap_area(g.cap) / KM),
        row("Gap triangle base Q", "Table 3", "2.014e4", "km", KM, lambda g: _gap(g).base,
            _COPY + "; here s of Table 2", lambda g: g.cap.tangent),
        row("Limiting circumference C_lim", "Section III.B", "9.83e3", "km", KM,
            lambda g: g.limit_circumference or np.nan),
        row("C_gap by the printed eq. 9", "Section III.B", "1.32e4", "km", KM,
            parallel),
        row("C_gap, length of that parallel", "Section III.B", "1.32e4", "km", KM,
            lambda g: g.circumference or np.nan,
            "eq. 9 takes the arc R i - l for the radius of a parallel; it is R sin(i - l/R)",
            parallel),
        claim("Neighbouring gaps do not overlap", "Section III.B", "C_lim < C_gap",
              ((g.limit_circumference or np.nan) / KM, (g.circumference or np.nan) / KM), "km",
              "the first is less", lambda bases, parallel: bases < parallel,
              shown="{:.2f}, {:.2f}"),
        row("Reference sphere area", "Table 4", "1.4494e8", "km^2", KM2, lambda g: g.sphere_area),
        row("Plane's served area, flat gaps", "Table 4", "1.4160e8", "km^2", KM2, planes_flat),
        row("Plane's served area", "Table 4", "1.4160e8", "km^2", KM2,
            lambda g: g.plane_area or np.nan, _FLAT, planes_flat),
        row("Plane's served share", "Table 4", "97.69", "%", 0.01,
            share(lambda g: g.plane_area or np.nan), _FLAT, share(planes_flat)),
        row("Constellation's served area by eq. 4", "Table 4", "1.0720e9", "km^2", KM2,
            printed_total),
        row("Constellation's served area", "Table 4", "1.0720e9", "km^2", KM2,
            lambda g: g.total_area, inherits, printed_total),
        row("Constellation's served share", "Table 4", "739.63", "%", 0.01,
            share(lambda g: g.total_area), inherits, share(printed_total)),
        claim("Served area over that of Mars, exact and by eq. 4", "Section III.B", "over 7 times",
              (g.total_area / g.sphere_area, g.published_total_area / g.sphere_area), "1",
              "the first is above 7", lambda exact, _: exact > 7, shown="{:.4f}, {:.4f}",
              erratum=Erratum(inherits, shown=lambda exact, printed: exact < 7 < printed)),
        row("Overlap of neighbours in a plane, printed formulas", "Table 4", "2.4270e7",
            "km^2", KM2, overlap_printed),
        row("Overlap of neighbours in a plane", "Table 4", "2.4270e7", "km^2", KM2,
            lambda g: g.neighbour_overlap or np.nan, inherits, overlap_printed),
        row("Overlap of neighbours, share", "Table 4", "16.74", "%", 0.01,
            share(lambda g: g.neighbour_overlap or np.nan), inherits, share(overlap_printed)),
        row("Constellation's redundancy", "Table 4", "9.2710e8", "km^2", KM2,
            lambda g: g.total_area - g.sphere_area, inherits, printed_redundancy),
        row("Constellation's redundancy, share", "Table 4", "639.63", "%", 0.01,
            share(lambda g: g.total_area - g.sphere_area), inherits, share(printed_redundancy)),
        row("Gap triangle share", "Table 4", "1.15", "%", 0.01,
            share(lambda g: _gap(g).area), _FLAT, share(flat)),
        row("Total area of gaps, flat", "Table 4", "1.6721e7", "km^2", KM2, gaps_flat),
        row("Total area of gaps", "Table 4", "1.6721e7", "km^2", KM2, gaps, _FLAT, gaps_flat),
        row("Total share of gaps", "Table 4", "11.54", "%", 0.01, share(gaps), _FLAT,
            share(gaps_flat)),
        claim("Half-arc angle; 180 deg over satellites a plane, 2 and 3", "Section III.A, Figure 5",
              "two do not close a plane, three do",
              [float(np.degrees(x)) for x in (g.cap.half_arc, np.pi / 2, np.pi / 3)], "deg",
              "between the other two", lambda cap, two, three: three <= cap < two,
              shown="{:.3f}; {:.0f}, {:.0f}"),
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

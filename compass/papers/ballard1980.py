"""Ballard 1980: the best rosettes of 5 to 15 satellites, and 5, 7, 9, 11 as the smallest."""

from fractions import Fraction

import numpy as np

from compass.core.nearest import covering_radius as radius_at_a_moment
from compass.coverage.margin import CoveringRadius, covering_radius, lowest_altitude
from compass.orbits import Constellation, Pattern, keplerian, positions_mci
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import walker_phasing
from compass.orbits.symmetry import phase_steps
from compass.papers.verdict import Erratum, Row, claim, compare, printed_tolerance
from compass.study.search import optimal_inclination, patterns

TITLE = (
    "A. H. Ballard, Rosette Constellations of Earth Satellites, IEEE Transactions on Aerospace and "
    "Electronic Systems AES-16(5):656-673, 1980, doi 10.1109/TAES.1980.308932. Printed numbers "
    "from a public machine-read copy of the paper, not from the journal's own page."
)

#: Any: nothing in the paper depends on the height of the orbits.
ANY_RADIUS = 1e7

#: Of optimum inclinations, radians. At an optimum two phases may be the worst, which tie as nearly:
#: R changes no faster than the inclination.
RESOLUTION = 1e-6

#: N, P, m, replication interval, worst phases, inclination, range R, lowest altitude in radii.
TABLE_1 = (
    (5, 5, "1", "36", (18,), "43.66", "69.15", "4.232"),
    (6, 6, "4", "60", (30,), "53.13", "66.42", "3.194"),
    (7, 7, "5", "25.7", (12.9,), "55.69", "60.26", "1.916"),
    (8, 8, "6", "90", (0, 45), "61.86", "56.52", "1.472"),
    (9, 9, "7", "20", (10,), "70.54", "54.81", "1.314"),
    (10, 10, "7", "36", (0, 7.7), "47.93", "51.53", "1.066"),
    (11, 11, "4", "16.4", (8.2,), "53.79", "47.61", "0.838"),
    (12, 3, "1/4", "30", (3.05, 15), "50.73", "47.90", "0.853"),
    (13, 13, "5", "13.8", (6.9,), "58.44", "43.76", "0.666"),
    (14, 7, "11/2", "25.7", (0, 12.9), "53.98", "41.96", "0.598"),
    (15, 3, "1/5", "12", (0.52, 6), "53.51", "42.13", "0.604"),
)

#: N, P, satellites a plane, node spacing, range R of the polar networks.
TABLE_2 = (
    (6, 2, 3, "104.49", "66.72"),
    (8, 2, 4, "96.47", "56.95"),
    (9, 3, 3, "74.46", "60.92"),
    (10, 2, 5, "95.48", "53.22"),
    (12, 3, 4, "69.29", "48.59"),
    (14, 2, 7, "92.84", "49.26"),
    (15, 3, 5, "65.50", "42.07"),
    (16, 4, 4, "53.97", "45.61"),
    (18, 3, 6, "64.34", "38.68"),
    (20, 4, 5, "51.21", "38.03"),
    (21, 3, 7, "62.86", "36.30"),
    (22, 2, 11, "91.16", "46.74"),
    (24, 4, 6, "49.19", "33.51"),
)

#: Visibility V, N, m, inclination, range R.
TABLE_3 = (
    (1, 5, 1, "43.66", "69.15"),
    (2, 7, 2, "61.81", "75.97"),
    (3, 9, 7, "58.56", "84.88"),
    (4, 11, 4, "68.38", "85.31"),
)


def best_rosette(
    satellites: int, planes: int, multiplier: Fraction, fold: int = 1
) -> tuple[float, CoveringRadius]:
    """Optimum inclination (radians) of a rosette and its covering radius there."""
    phasing = walker_phasing(satellites, planes, multiplier)

    def make(inclination: float) -> Constellation:
        pattern = Pattern("walker-delta", satellites, planes, phasing, inclination)
        return from_pattern(pattern, ANY_RADIUS)

    inclination = optimal_inclination(make(0.0), fold, resolution=RESOLUTION)
    assert inclination is not None
    return inclination, covering_radius(make(inclination), fold, tolerance=1e-7)


def polar_network(planes: int, per_plane: int, spacing: float) -> Constellation:
    """Polar orbits `spacing` (radians) apart, each half a slot ahead of the one before."""
    plane = np.repeat(np.arange(planes), per_plane)
    slot = np.tile(np.arange(per_plane), planes)
    return keplerian(
        ANY_RADIUS,
        0.0,
        np.pi / 2,
        plane * spacing,
        0.0,
        (2 * slot + plane) * np.pi / per_plane,
    )


def smallest_size(fold: int, largest: int) -> int | None:
    """Size of the smallest Walker delta pattern with caps below 89 degrees, if any."""
    for size in range(1, largest + 1):
        for make in patterns("walker-delta", size, ANY_RADIUS, smallest=size):
            if optimal_inclination(make(0.0), fold, np.radians(89)) is not None:
                return size
    return None


def rows() -> list[Row]:
    """Tables I to III and the theorem on smallest numbers."""
    made: list[Row] = []
    for n, p, m, interval, phases, inclination, reach, altitude in TABLE_1:
        made += _table_1(n, p, m, interval, phases, inclination, reach, altitude)
    for n, p, q, spacing, reach in TABLE_2:
        radius = covering_radius(polar_network(p, q, np.radians(float(spacing))), 1).radius
        item = f"{n} satellites in {p} polar planes {spacing} deg apart: R"
        made.append(compare(item, "Table II", reach, float(np.degrees(radius)), "deg"))
    for fold, n, harmonic, inclination, reach in TABLE_3:
        best, covering = best_rosette(n, n, Fraction(harmonic), fold)
        name = f"({n}, {n}, {harmonic}), {fold}-fold"
        at_printed = _radius_at(n, n, Fraction(harmonic), inclination, fold)
        made.append(_inclination("Table III", name, inclination, best, reach, at_printed))
        made.append(
            compare(f"{name}: R", "Table III", reach, float(np.degrees(covering.radius)), "deg")
        )
    for fold in range(1, 5):
        least = 2 * fold + 3
        smallest = smallest_size(fold, least)
        made.append(
            compare(
                f"smallest delta pattern for {fold}-fold coverage with caps below 89 deg",
                "Theorem I",
                str(least),
                float("nan") if smallest is None else float(smallest),
                "satellites",
            )
        )
    return made


def _table_1(
    n: int,
    p: int,
    m: str,
    interval: str,
    phases: tuple[float, ...],
    inclination: str,
    reach: str,
    altitude: str,
) -> list[Row]:
    """Rows of one line of Table I."""
    name = f"({n}, {p}, {m})"
    best, covering = best_rosette(n, p, Fraction(m))
    pattern = Pattern("walker-delta", n, p, walker_phasing(n, p, Fraction(m)), best)
    c = from_pattern(pattern, ANY_RADIUS)
    steps = np.lcm(phase_steps(c), 2)
    phase = float(np.degrees(covering.time * c.mean_motion[0]))
    height = lowest_altitude(covering.radius, 1.0, np.radians(10.0))
    rounded = lowest_altitude(np.radians(float(reach)), 1.0, np.radians(10.0))
    assert height is not None
    assert rounded is not None
    at_printed = _radius_at(n, p, Fraction(m), inclination)
    return [
        compare(f"{name}: replication interval", "Table I", interval, 360.0 / steps, "deg"),
        _inclination("Table I", name, inclination, best, reach, at_printed),
        compare(f"{name}: R", "Table I", reach, float(np.degrees(covering.radius)), "deg"),
        claim(
            f"{name}: worst phase is one of those printed",
            "Table I",
            ", ".join(f"{x:g}" for x in phases),
            phase,
            "deg",
            "within 0.05 of one, or of one as bad",
            lambda worst: any(
                abs(worst - x) <= 0.05
                or (
                    np.isfinite(worst)
                    and abs(_radius_in_phase(c, worst) - _radius_in_phase(c, x))
                    <= np.degrees(RESOLUTION)
                )
                for x in phases
            ),
        ),
        compare(
            f"{name}: lowest altitude for 10 deg elevation",
            "Table I",
            altitude,
            height,
            "planet radii",
            erratum=Erratum(f"from R rounded to {reach} deg", makes=rounded),
        ),
    ]


def _radius_in_phase(c: Constellation, phase: float) -> float:
    """Covering radius at the moment when satellites are so many degrees on their way, degrees."""
    r = positions_mci(c, np.array([np.radians(phase) / c.mean_motion[0]]))[:, 0]
    return float(np.degrees(radius_at_a_moment(r / ANY_RADIUS, 1, 0.0, np.pi, np.empty(3))))


def _radius_at(satellites: int, planes: int, m: Fraction, printed: str, fold: int = 1) -> float:
    """Covering radius of a rosette at the printed inclination, degrees."""
    pattern = Pattern(
        "walker-delta",
        satellites,
        planes,
        walker_phasing(satellites, planes, m),
        float(np.radians(float(printed))),
    )
    at = from_pattern(pattern, ANY_RADIUS)
    return float(np.degrees(covering_radius(at, fold, tolerance=1e-7).radius))


def _inclination(
    table: str, name: str, printed: str, best: float, reach: str, at_printed: float
) -> Row:
    """Row of an optimum inclination, with the three ways in which a printed one can be wrong.

    Cut instead of rounded; at odds with the R printed beside it; or off the bottom of so flat
    a minimum that R prints the same.
    """
    computed, digits = float(np.degrees(best)), len(printed.partition(".")[2])
    cut = float(np.floor(computed * 10**digits) / 10**digits)
    off = abs(at_printed - float(reach)) > printed_tolerance(reach)
    if cut == float(printed):
        erratum = Erratum("the last digit was cut, not rounded", makes=cut)
    elif off:
        erratum = Erratum(
            f"at the printed angle R = {at_printed:.3f}, not the {reach} printed beside it: a "
            "digit of one of them is misprinted, or misread in the copy",
            shown=lambda angle: (
                abs(at_printed - float(reach)) > printed_tolerance(reach)
                and abs(angle - float(printed)) < 0.1
            ),
        )
    else:
        erratum = Erratum(
            f"R has a flat minimum: at the printed angle it is {at_printed:.5f} deg, which prints "
            f"as the same {reach}",
            shown=lambda angle: abs(angle - float(printed)) < 0.5,
        )
    return compare(f"{name}: optimum inclination", table, printed, computed, "deg", erratum=erratum)

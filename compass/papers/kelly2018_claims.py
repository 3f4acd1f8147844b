"""Kelly and Bevilacqua 2018: what the words claim, of planes, goals and other constellations.

Own geometry on a few thousand places and moments, beside the exact methods that other rows use.
"""

import numpy as np
from numpy.typing import NDArray

from compass.bodies import KELLY2018_RADIUS
from compass.coverage.gap import gap
from compass.orbits import orbital_period, positions_mci, walker_delta
from compass.papers.line_of_sight import misses
from compass.papers.verdict import Erratum, Row, claim, compare, computed

Array = NDArray[np.float64]

SPHERE, ORBIT = KELLY2018_RADIUS.value, 20_427e3
INCLINATION = np.pi / 4
#: Moments over the time after which the pattern repeats, a fifteenth of a period.
MOMENTS = 60
#: Altitude, retrograde near-equatorial and near-polar inclinations of JPL's six: Ely et al. 1999,
#: AAS 99-301.
JPL_ALTITUDE, JPL_INCLINATIONS_DEG = 800e3, (172.0, 172.0, 111.0, 111.0, 111.0, 111.0)
NANN_SATELLITES = 8


def rows() -> list[Row]:
    """Planes and gaps, the choice of altitude, other constellations, goals 4 and 5, low orbits."""
    return [*plane_rows(), *altitude_rows(), *comparison_rows(), *relay_rows(), *low_orbit_rows()]


def cap(orbit: float, sphere: float = SPHERE) -> float:
    """Body-central half angle seen above a horizon without mask, radians."""
    return float(np.arccos(sphere / orbit))


def sphere_points(count: int) -> Array:
    """Unit vectors spread evenly over the sphere, shape (count, 3): a golden spiral."""
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1)


def _plane() -> tuple[Array, Array]:
    """Directions of three satellites of a plane, (3, 3), and the pole of the plane, (3,)."""
    u = 2 * np.pi * np.arange(3) / 3
    tilt = np.array([0.0, np.cos(INCLINATION), np.sin(INCLINATION)])
    node = np.array([1.0, 0.0, 0.0])
    pole = np.cross(node, tilt)
    return np.cos(u)[:, None] * node + np.sin(u)[:, None] * tilt, pole


def _corner_angle(satellites: Array, pole: Array, half: float) -> float:
    """Angle of a gap at a corner, between the tangents of the two rims that meet there, degrees."""
    a, b = satellites[0], satellites[1]
    middle = (a + b) / np.linalg.norm(a + b)
    # a.p = b.p = cos(half) with p in the plane of the middle and the pole
    c = np.arcsin(np.cos(half) / np.cos(np.pi / 3))
    p = np.cos(c) * pole + np.sin(c) * middle
    inward = [np.cross(p, n) * sign for n, sign in ((a, 1.0), (b, -1.0))]
    inward = [t * np.sign(t @ (pole - (pole @ p) * p)) / np.linalg.norm(t) for t in inward]
    return float(np.degrees(np.arccos(inward[0] @ inward[1])))


def plane_rows() -> list[Row]:
    """What one plane of three covers, and the shape of what it leaves."""
    half = cap(ORBIT)
    satellites, pole = _plane()
    points = sphere_points(20_000)
    bare = points[(points @ satellites.T).max(axis=1) < np.cos(half)]
    north, south = (bare[side].sum(axis=0) for side in (bare @ pole > 0, bare @ pole < 0))
    apart = np.degrees(np.arccos((north @ south) / (np.linalg.norm(north) * np.linalg.norm(south))))
    between = gap(ORBIT, SPHERE, 3)
    assert between is not None
    excess = between.area / SPHERE**2
    delta = np.arccos(np.cos(between.vertex) / np.sin(half))
    # area = 2 pi - 3 (pi - beta) + 6 delta cos(half), solved for the corner's angle
    by_area = np.degrees(np.pi - (2 * np.pi + 6 * delta * np.cos(half) - excess) / 3)
    corner = _corner_angle(satellites, pole, half)
    return [
        claim(
            "Satellites of a plane in view at the plane's pole, at any time; how far off the pole "
            "they stand and how far they reach",
            "Section III.A",
            "for any orbital plane a user is guaranteed access to at least one satellite",
            (
                (satellites @ pole >= np.cos(half)).sum(),
                np.degrees(np.arccos(np.clip(satellites @ pole, -1, 1))).min(),
                np.degrees(half),
            ),
            "1; deg",
            "1 or more",
            lambda seen, *_: seen >= 1,
            shown="{:.0f}; {:.2f}, {:.2f}",
            erratum=Erratum(
                "no plane does: its poles are 90 deg from all its satellites, always, and a cap "
                "reaches less (the text's own gap triangles)",
                shown=lambda seen, off, reach: seen == 0 and reach < off,
            ),
        ),
        compare(
            "Angle between the two gaps of a plane, middle to middle, by 20 000 places",
            "Section III.A, Figure 5",
            "180",
            float(apart),
            "deg",
        ),
        compare(
            "Angle of a gap's corners, between the tangents of its rims",
            "Section III.B",
            "60",
            corner,
            "deg",
            erratum=Erratum(
                "60 deg are those of the flat triangle; the rims bend as they meet on the sphere, "
                f"by Gauss and Bonnet at {by_area:.3f} deg",
                shown=lambda tangents: abs(tangents - by_area) < 1e-6,
            ),
        ),
    ]


def altitude_rows() -> list[Row]:
    """The trade of altitude: caps grow, gaps shrink; where gaps stop overlapping."""
    trade = altitude_trade()
    shares, gaps = trade[:, 1], trade[:, 2]
    # gaps of neighbouring planes: p Q = 2 pi R sin(i - l/R), by bisection on the radius
    low, high = 2.01 * SPHERE, 6 * SPHERE
    for _ in range(60):
        middle = (low + high) / 2
        depth = np.pi / 2 - cap(middle)
        free = 2 * np.pi * np.sin(INCLINATION - depth) - 5 * 2 * 3**0.5 * depth
        low, high = (low, middle) if free > 0 else (middle, high)
    return [
        claim(
            f"Share of the sphere under one satellite, {_listed(trade[:, 0])} km up",
            "Section III.B",
            "greater altitudes provide greater surface coverage",
            shares,
            "1",
            "grows, below 0.5",
            lambda *s: bool((np.diff(s) > 0).all() and max(s) < 0.5),
            shown=", ".join(["{:.3f}"] * len(shares)),
        ),
        claim(
            "Share of the sphere in one gap of three satellites, same altitudes",
            "Section III.B",
            "the size of the gaps is affected by altitude",
            gaps,
            "1",
            "shrinks",
            lambda *s: bool((np.diff(s) < 0).all()),
            shown=", ".join(["{:.4f}"] * len(gaps)),
        ),
        computed(
            "Lowest altitude at which neighbouring gaps of 5 planes at 45 deg stay apart",
            "-",
            (high - SPHERE) / 1e3,
            "km",
            note="C_lim equals the true length of the parallel; the paper stays above it",
        ),
    ]


def altitude_trade() -> Array:
    """Altitude (km), share of the sphere under a satellite and in one gap of three, (n, 3)."""
    altitudes = np.array([4000.0, 8000.0, 12_000.0, 17_030.8, 25_000.0, 40_000.0])
    rows = []
    for altitude in altitudes:
        orbit = SPHERE + 1e3 * altitude
        between = gap(orbit, SPHERE, 3)
        assert between is not None
        rows.append((altitude, (1 - SPHERE / orbit) / 2, between.fraction))
    return np.array(rows)


def _listed(numbers: Array) -> str:
    return ", ".join(f"{x:.0f}" for x in numbers)


def mean_in_view(latitude: float, orbit: float, inclinations: Array) -> float:
    """Mean number of satellites in view of a latitude (rad), over time and longitude.

    The share of a parallel inside a cap about latitude d: ``acos((cos lambda - sin f sin d) /
    (cos f cos d)) / pi``, averaged over the circle that the satellite runs through.
    """
    half = cap(orbit)
    u = (np.arange(4000) + 0.5) * 2 * np.pi / 4000
    total = 0.0
    for inclination in inclinations:
        d = np.arcsin(np.sin(inclination) * np.sin(u))
        level = np.cos(latitude) * np.cos(d)
        cosine = (np.cos(half) - np.sin(latitude) * np.sin(d)) / np.maximum(level, 1e-12)
        total += float(np.arccos(np.clip(cosine, -1, 1)).mean() / np.pi)
    return total


def comparison_rows() -> list[Row]:
    """JPL's six satellites and Nann's eight against continuous fourfold coverage."""
    orbit = SPHERE + JPL_ALTITUDE
    inclinations = np.radians(JPL_INCLINATIONS_DEG)
    share = len(inclinations) * (1 - SPHERE / orbit) / 2
    latitudes = np.radians([0, 30, 60, 70, 90])
    means = [mean_in_view(latitude, orbit, inclinations) for latitude in latitudes]
    return [
        claim(
            "Mean number of satellites in view of JPL's six: over the whole sphere",
            "Section I",
            "not designed to provide continuous coverage of the entire surface",
            share,
            "1",
            "below 1: somewhere none is in view",
            lambda mean: 0 < mean < 1,
        ),
        claim(
            "the same at latitudes 0, 30, 60, 70, 90 deg",
            "Section I",
            "primarily equatorial coverage",
            means,
            "1",
            "largest at the equator",
            lambda equator, *others: equator > max(others),
            shown="{:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}",
            erratum=Erratum(
                "four of the six are near-polar, and high latitudes have more satellites in view",
                shown=lambda equator, *others: max(others) > equator > 0,
            ),
        ),
        claim(
            "Mean number in view that Nann's 8 satellites cannot reach at any altitude, half the "
            "sphere each; mean of the 15",
            "Section I",
            "none of them is designed for continuous uniform coverage (of four satellites)",
            (NANN_SATELLITES / 2, 15 * (1 - SPHERE / ORBIT) / 2),
            "1",
            "the first 4 or less, the second above 4",
            lambda eight, fifteen: eight <= 4 < fifteen,
            shown="{:.0f}; {:.3f}",
        ),
    ]


def moments(count: int = MOMENTS) -> Array:
    """Places of the 15 satellites over a fifteenth of a period, metres, shape (t, 15, 3)."""
    c = walker_delta(15, 5, 1, inclination_deg=45.0, radius_km=ORBIT / 1e3)
    times = np.linspace(0.0, float(orbital_period(ORBIT)) / 15, count)
    return np.ascontiguousarray(np.swapaxes(positions_mci(c, times), 0, 1))


def hops(linked: NDArray[np.bool_]) -> float:
    """Most links on the shortest way between any two of a network, (n, n); infinite if split."""
    reached = np.eye(len(linked), dtype=bool)
    for count in range(len(linked)):
        if reached.all():
            return float(count)
        reached = reached | (reached.astype(int) @ linked.astype(int) > 0)
    return float("inf")


def relay_rows() -> list[Row]:
    """Goals 4 and 5: relays across Mars, and to Earth."""
    r = moments()
    links = [misses(at[:, None], at[None, :], SPHERE) | np.eye(15, dtype=bool) for at in r]
    least = min(int(link.sum(axis=1).min()) - 1 for link in links)
    # Earth far off: hidden are those within asin(R/r) of the direction away from it
    cone = np.arcsin(SPHERE / ORBIT)
    away = sphere_points(4000)
    hidden = max(int((at / ORBIT @ away.T > np.cos(cone)).sum(axis=0).max()) for at in r)
    return [
        claim(
            f"Links of a satellite to others, least; links between any two at most, {MOMENTS} "
            "moments",
            "Section I, goal 4",
            "a communications relay for Mars assets",
            (least, max(hops(link) for link in links)),
            "1",
            "connected at all of them",
            lambda least, most: least >= 1 and 0 < most < 15,
            shown="{:.0f}; {:.0f}",
        ),
        claim(
            f"Satellites hidden from Earth by Mars at once, at most: {MOMENTS} moments, 4000 "
            "directions of Earth",
            "Section I, goal 5",
            "a communications relay between Earth and Mars",
            hidden,
            "of 15",
            "fewer than all 15",
            lambda hidden: 0 <= hidden < 15,
        ),
    ]


def low_orbit_rows() -> list[Row]:
    """A user in a lower orbit sees further than one on the ground."""
    r, places = moments(), sphere_points(4000)
    least = []
    for altitude in (0.0, 400e3, 2000e3):
        reach = np.cos(min(np.pi, cap(ORBIT) + cap(SPHERE + altitude)))
        least.append(min(int((at / ORBIT @ places.T > reach).sum(axis=0).min()) for at in r))
    return [
        claim(
            f"Fewest satellites in view from 0, 400 and 2000 km up: {MOMENTS} moments, 4000 places",
            "Sections I and II",
            "position for lower orbiting satellites: four in view",
            least,
            "1",
            "4 or more, growing with altitude",
            lambda ground, low, high: 4 <= ground <= low <= high,
            shown="{:.0f}, {:.0f}, {:.0f}",
        )
    ]

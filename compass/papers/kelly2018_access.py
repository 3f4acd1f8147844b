"""Section IV of Kelly and Bevilacqua 2018: command stations at a pole, on the equator, on moons.

The paper prints neither the elevation mask nor the span of its simulation. Each row says under
which assumption the published value would hold.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from compass.bodies import DEIMOS_SEMI_MAJOR_AXIS, MARS_GM, SOLAR_DAY, sidereal_day
from compass.contacts.nodes import Node, moon_node, satellite_nodes, station_node
from compass.contacts.spans import any_of, outside, total
from compass.contacts.windows import Windows, windows
from compass.frames import FIGURES, HOUR
from compass.orbits import Constellation, walker_delta
from compass.papers.verdict import Erratum, Row, claim, compare, computed
from compass.sites import Mask, Site

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018, section IV"
)

SPAN = 30 * SOLAR_DAY.value

#: Longitudes of the first of the two equatorial stations, over half a turn.
LONGITUDES = 180
FIGURE = FIGURES["kelly2018-sphere"]
#: Radius of Deimos's orbit taken as a circle, metres.
DEIMOS_ORBIT = DEIMOS_SEMI_MAJOR_AXIS.value


def constellation() -> Constellation:
    """Return the 15/5/1 at 45 degrees (Table 1, whose altitude is the radius of Table 2)."""
    return walker_delta(15, 5, 1, inclination_deg=45.0, radius_km=20427)


def rows() -> list[Row]:
    """All statements of section IV about access that can be checked."""
    return [*polar_rows(), *equatorial_rows(), *phobos_rows(), *deimos_rows()]


def polar_pass(mask: float, duration: float = 3 * SOLAR_DAY.value) -> float:
    """Length of a satellite's whole pass over the north pole above a mask (rad), seconds."""
    c = constellation()
    site = Site("North pole", np.pi / 2, 0.0, mask=Mask.constant(mask), figure=FIGURE)
    station = station_node(site, c.epoch, duration)
    (passes,) = windows([(station, satellite_nodes(c)[0])], duration)
    return float(passes.length.max(initial=0.0))


def polar_rows() -> list[Row]:
    """Polar station: once a day, about 6 hours."""
    c = constellation()
    site = Site("North pole", np.pi / 2, 0.0, figure=FIGURE)
    station = station_node(site, c.epoch, SPAN)
    passes = windows([(station, satellite) for satellite in satellite_nodes(c)], SPAN)
    spacing = np.concatenate([np.diff(w.start[w.start > 0]) for w in passes])
    daily = sidereal_day() / float(spacing.mean())
    implied = float(
        np.degrees(brentq(lambda mask: polar_pass(mask) - 6 * HOUR, 0.0, np.radians(40.0)))
    )
    lengths = {mask: polar_pass(np.radians(mask)) / HOUR for mask in (0.0, 10.0, 20.0)}
    return [
        claim(
            "polar station: passes a day, each satellite",
            "Section IV",
            "once daily",
            daily,
            "1/sidereal day",
            "1 within 0.001",
            lambda rate: abs(rate - 1) < 1e-3,
        ),
        compare(
            "polar station: length of a pass over the horizon",
            "Section IV, Figure 7",
            "6",
            lengths[0.0],
            "h",
            note=f"6 h would hold for an elevation mask of {implied:.1f} deg; the paper states "
            "none, and its coverage uses none",
        ),
        *(
            computed(f"polar station: length of a pass, mask {mask:g} deg", "-", lengths[mask], "h")
            for mask in (10.0, 20.0)
        ),
        computed("polar station: mask at which a pass lasts 6 h", "-", implied, "deg"),
    ]


def pair_shares(mask: float) -> NDArray[np.float64]:
    """Share of a sidereal day in which each satellite is in view of two stations 180 deg apart.

    Shape (LONGITUDES, 15): the first station stands in the middle of each step from 0 to 180
    degrees east on the equator, the second opposite. Over a day the ground tracks close, to
    0.02 deg. `mask` is in degrees.
    """
    c, day = constellation(), sidereal_day()
    satellites = satellite_nodes(c)
    horizon = Mask.constant(np.radians(mask))
    longitudes = (np.arange(2 * LONGITUDES) + 0.5) * np.pi / LONGITUDES
    stations = [
        station_node(Site("", 0.0, longitude, mask=horizon, figure=FIGURE), c.epoch, day)
        for longitude in longitudes
    ]
    seen = windows([(s, satellite) for s in stations for satellite in satellites], day)
    n = len(satellites)
    shares = [
        total(any_of([seen[k].spans, seen[k + LONGITUDES * n].spans])) / day
        for k in range(LONGITUDES * n)
    ]
    return np.array(shares).reshape(LONGITUDES, n)


def equatorial_rows() -> list[Row]:
    """Two equatorial stations 180 degrees apart."""
    published = "access to all satellites"
    shares = {mask: pair_shares(mask).min(axis=1) for mask in (0.0, 5.0)}
    blind = {mask: float((worst == 0).mean()) for mask, worst in shares.items()}
    return [
        claim(
            f"two equatorial stations, best of {LONGITUDES} longitudes: least share of a day in "
            "view of any satellite",
            "Section IV, Figure 6",
            published,
            float(shares[0.0].max()),
            "1",
            "above 0",
            lambda share: share > 0,
        ),
        claim(
            f"two equatorial stations: share of {LONGITUDES} longitudes at which some satellite "
            "never rises",
            "Section IV",
            published,
            blind[0.0],
            "1",
            "0",
            lambda share: share == 0,
            erratum=Erratum(
                "an areosynchronous satellite keeps to its longitude, and one 90 degrees from both "
                "stations stays below their horizon: the pair must be placed with regard to the "
                "ground tracks",
                shown=lambda share: 0 < share <= 1,
            ),
        ),
        computed(
            "the same above a mask of 5 deg",
            "-",
            blind[5.0],
            "1",
            note="no pair of longitudes is good enough" if blind[5.0] == 1 else "",
        ),
    ]


def moon_windows(name: str, model: str = "precessing") -> list[Windows]:
    """Windows of a moon's centre with all satellites over 30 sols from J2000."""
    c = constellation()
    moon: Node = moon_node(name, c.epoch, SPAN, model)  # type: ignore[arg-type]
    return windows([(moon, satellite) for satellite in satellite_nodes(c)], SPAN, figure=FIGURE)


def occultations(seen: list[Windows]) -> NDArray[np.float64]:
    """Lengths of all occultations not cut by the ends of the span, seconds."""
    gaps = np.concatenate([outside(w.spans, w.duration) for w in seen])
    whole = (gaps[:, 0] > 0) & (gaps[:, 1] < seen[0].duration)
    return gaps[whole, 1] - gaps[whole, 0]


def share_in_view(seen: list[Windows]) -> float:
    """Share of the time in which a satellite is in view, mean over the satellites."""
    return float(np.mean([w.length.sum() / w.duration for w in seen]))


def phobos_rows() -> list[Row]:
    """Phobos: several windows a day for each satellite."""
    seen = moon_windows("phobos")
    spacing = np.concatenate([np.diff(w.start) for w in seen])
    rate = SOLAR_DAY.value / float(np.median(spacing))
    where = "Section IV, Figure 9"
    return [
        claim(
            "Phobos: windows a sol and satellite while occultations recur",
            where,
            "multiple a day",
            rate,
            "1/sol",
            "2 or more",
            lambda rate: rate >= 2,
        ),
        computed("Phobos: share of 30 sols in view", where, share_in_view(seen), "1"),
        computed("Phobos: longest occultation", where, occultations(seen).max() / HOUR, "h"),
    ]


def longest_chord(moon_radius: float) -> float:
    """Longest occultation of a moon's circle of a radius (m) by Mars's disc, closed form, seconds.

    ``2 (pi - acos(R/r1) - acos(R/r2)) / |n1 - n2|``, angular velocities as vectors 45 degrees
    apart: the width of the disc over the relative rate where the planes cross.
    """
    c, sphere = constellation(), FIGURE.equatorial_radius
    near, n1, n2 = (
        float(c.semi_major_axis[0]),
        c.mean_motion[0],
        np.sqrt(MARS_GM.value / moon_radius**3),
    )
    width = 2 * (np.pi - np.arccos(sphere / near) - np.arccos(sphere / moon_radius))
    return float(width / np.sqrt(n1**2 + n2**2 - 2 * n1 * n2 * np.cos(np.radians(45))))


def deimos_rows() -> list[Row]:
    """Deimos: nearly continuous, occultations under 3 hours."""
    where, rows = "Section IV, Figure 8", []
    for model in ("precessing", "circular"):
        seen = moon_windows("deimos", model)
        gaps = occultations(seen) / HOUR
        rows.append(
            claim(
                f"Deimos ({model}): longest occultation; by a chord of the disc; mean; share under "
                "3 h, in 30 sols",
                where,
                "less than 3 hours",
                (gaps.max(), longest_chord(DEIMOS_ORBIT) / HOUR, gaps.mean(), (gaps < 3).mean()),
                "h",
                "the first is less than 3",
                lambda longest, *_: longest < 3,
                shown="{:.3f}; {:.3f}; {:.3f}; {:.2f}",
                erratum=Erratum(
                    "a crossing through the middle of Mars's disc takes longer, by both ways",
                    shown=lambda longest, chord, *_: min(longest, chord) > 3,
                ),
            )
        )
        rows.append(
            claim(
                f"Deimos ({model}): share of 30 sols in view",
                where,
                "nearly continuous",
                share_in_view(seen),
                "1",
                "above 0.95",
                lambda share: share > 0.95,
            )
        )
    longest = max(float(w.length.max()) for w in seen) / SOLAR_DAY.value
    rows.append(
        claim(
            "Deimos: longest unbroken view of a satellite",
            where,
            "days at a time",
            longest,
            "sol",
            "above 2",
            lambda sols: sols > 2,
        )
    )
    return rows

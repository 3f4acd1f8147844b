"""Section IV of Kelly and Bevilacqua 2018: command stations at a pole, on the equator, on moons.

The paper prints neither the elevation mask nor the span of its simulation. Each row says under
which assumption the published value would hold.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from compass.bodies import SOLAR_DAY, sidereal_day
from compass.contacts.nodes import Node, moon_node, satellite_nodes, station_node
from compass.contacts.spans import any_of, outside, total
from compass.contacts.windows import Windows, windows
from compass.frames import FIGURES
from compass.orbits import Constellation, walker_delta
from compass.papers.verdict import Row, compare, judge_claim
from compass.sites import Mask, Site

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018, section IV"
)

HOUR = 3600.0
SPAN = 30 * SOLAR_DAY.value

#: Longitudes of the first of the two equatorial stations, over half a turn.
LONGITUDES = 180
FIGURE = FIGURES["kelly2018-sphere"]


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
    (found,) = windows([(station, satellite_nodes(c)[0])], duration)
    return float(found.length.max(initial=0.0))


def polar_rows() -> list[Row]:
    """Polar station: once a day, about 6 hours."""
    c = constellation()
    site = Site("North pole", np.pi / 2, 0.0, figure=FIGURE)
    station = station_node(site, c.epoch, SPAN)
    found = windows([(station, satellite) for satellite in satellite_nodes(c)], SPAN)
    spacing = np.concatenate([np.diff(w.start[w.start > 0]) for w in found])
    daily = sidereal_day() / float(spacing.mean())
    implied = float(
        np.degrees(brentq(lambda mask: polar_pass(mask) - 6 * HOUR, 0.0, np.radians(40.0)))
    )
    reason = (
        f"6 h would hold for an elevation mask of {implied:.1f} deg; the paper states none, and "
        "its coverage figures use none"
    )
    rows = [
        judge_claim(
            "polar station: passes a day, each satellite",
            "Section IV",
            "once daily",
            daily,
            "1/sidereal day",
            abs(daily - 1) < 1e-3,
            "the passes do not come once a day",
        )
    ]
    for mask in (0.0, 10.0, 20.0):
        rows.append(
            compare(
                f"polar station: length of a pass, mask {mask:g} deg",
                "Section IV",
                "6",
                polar_pass(np.radians(mask)) / HOUR,
                "h",
                erratum=reason,
            )
        )
    rows.append(
        Row(
            "polar station: mask at which a pass lasts 6 h",
            "-",
            None,
            implied,
            "deg",
            "not printed",
        )
    )
    return rows


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
    found = windows([(s, satellite) for s in stations for satellite in satellites], day)
    n = len(satellites)
    shares = [
        total(any_of([found[k].spans, found[k + LONGITUDES * n].spans])) / day
        for k in range(LONGITUDES * n)
    ]
    return np.array(shares).reshape(LONGITUDES, n)


def equatorial_rows() -> list[Row]:
    """Two equatorial stations 180 degrees apart."""
    published = "access to all satellites"
    reason = (
        "an areosynchronous satellite keeps to its longitude, and one 90 degrees from both "
        "stations stays below their horizon; the claim holds without a mask, for a pair placed "
        "with regard to the ground tracks"
    )
    worst = pair_shares(0.0).min(axis=1)
    rows = [
        judge_claim(
            "two equatorial stations, mask 0 deg, best longitude: least share of time in view "
            "of any satellite",
            "Section IV",
            published,
            float(worst.max()),
            "1",
            bool(worst.max() > 0),
            "some satellite is never seen",
        )
    ]
    for mask in (0.0, 5.0):
        blind = float((pair_shares(mask).min(axis=1) == 0).mean())
        rows.append(
            judge_claim(
                f"two equatorial stations, mask {mask:g} deg: share of longitudes at which some "
                "satellite is never in view",
                "Section IV",
                published,
                blind,
                "1",
                blind == 0,
                reason,
            )
        )
    return rows


def moon_windows(name: str, model: str = "precessing") -> list[Windows]:
    """Windows of a moon's centre with all satellites over 30 sols from J2000."""
    c = constellation()
    moon: Node = moon_node(name, c.epoch, SPAN, model)  # type: ignore[arg-type]
    return windows([(moon, satellite) for satellite in satellite_nodes(c)], SPAN, figure=FIGURE)


def occultations(found: list[Windows]) -> NDArray[np.float64]:
    """Lengths of all occultations not cut by the ends of the span, seconds."""
    gaps = np.concatenate([outside(w.spans, w.duration) for w in found])
    whole = (gaps[:, 0] > 0) & (gaps[:, 1] < found[0].duration)
    return gaps[whole, 1] - gaps[whole, 0]


def share_in_view(found: list[Windows]) -> float:
    """Share of the time in which a satellite is in view, mean over the satellites."""
    return float(np.mean([w.length.sum() / w.duration for w in found]))


def phobos_rows() -> list[Row]:
    """Phobos: several windows a day for each satellite."""
    found = moon_windows("phobos")
    spacing = np.concatenate([np.diff(w.start) for w in found])
    rate = SOLAR_DAY.value / float(np.median(spacing))
    where = "Section IV"
    return [
        judge_claim(
            "Phobos: windows a sol and satellite while occultations recur",
            where,
            "multiple a day",
            rate,
            "1/sol",
            rate >= 2,
            "fewer than two",
        ),
        Row("Phobos: share of time in view", where, None, share_in_view(found), "1", "not printed"),
        Row(
            "Phobos: longest occultation",
            where,
            None,
            float(occultations(found).max()) / HOUR,
            "h",
            "not printed",
        ),
    ]


def deimos_rows() -> list[Row]:
    """Deimos: nearly continuous, occultations under 3 hours."""
    where, rows = "Section IV", []
    for model in ("precessing", "circular"):
        found = moon_windows("deimos", model)
        gaps = occultations(found) / HOUR
        rows.append(
            judge_claim(
                f"Deimos ({model}): longest occultation",
                where,
                "less than 3",
                float(gaps.max()),
                "h",
                bool(gaps.max() < 3),
                f"a crossing through the middle of Mars's disc takes longer; under 3 h holds for "
                f"the mean ({gaps.mean():.2f} h) and for {100 * (gaps < 3).mean():.0f} % of the "
                "occultations",
            )
        )
        share = share_in_view(found)
        rows.append(
            judge_claim(
                f"Deimos ({model}): share of time in view",
                where,
                "nearly continuous",
                share,
                "1",
                share > 0.95,
                "less than 95 %",
            )
        )
    longest = max(float(w.length.max()) for w in found) / SOLAR_DAY.value
    rows.append(
        judge_claim(
            "Deimos: longest unbroken view of a satellite",
            where,
            "days at a time",
            longest,
            "sol",
            longest > 2,
            "less than two sols",
        )
    )
    return rows

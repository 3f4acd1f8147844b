"""Lemoine et al. 1999: how well Mars Global Surveyor's orbit was determined, against a covariance.

The paper differences successive arcs where they overlap; what is claimed here is the covariance of
an arc like those (`compass.signal.determination`), over its last fifth, times the root of two. What
differs is named in every row, so that only the order of magnitude can be asked for.
"""

from dataclasses import dataclass
from datetime import datetime

import numpy as np

from compass.bodies import MARS_EQUATORIAL_RADIUS
from compass.design import Design
from compass.frames import SECONDS_PER_DAY, seconds_past_j2000
from compass.orbits.constellation import keplerian
from compass.papers.verdict import Row, claim, computed
from compass.planets import sun_earth_mci
from compass.signal.determination import determine_orbits
from compass.tracking import Tracker, Tracking

TITLE = (
    "F. G. Lemoine, D. D. Rowlands, D. E. Smith, D. S. Chinn, D. E. Pavlis, S. B. Luthcke, "
    "G. A. Neumann and M. T. Zuber, Orbit determination for Mars Global Surveyor during mapping, "
    "AAS 99-328, 1999"
)

#: The mapping orbit: altitude, m, inclination, rad, and local time of its ascending node, rad past
#: noon (2 p.m.).
ALTITUDE, INCLINATION, PAST_NOON = 378e3, np.radians(92.9), np.radians(30.0)

#: X-band Doppler over a minute, m/s, and the step, s: a sixtieth of a revolution.
DOPPLER, STEP = 1e-4, 120.0

#: Share of an arc in an overlap, and the most by which an order of magnitude may be off.
OVERLAP, ORDER = 0.22, 10.0

COMPONENTS = ("radial", "cross-track", "along-track")

_DIFFERENCES = (
    "here the Earth tracks all day, errors of the field stand for degrees to 3 of a later one, and "
    "neither drag nor desaturation manoeuvres are there; of February's cross-track passes of 8 h a "
    "day would make up to 2.6 m, a field ten times less known 7.2 m and seven times the radial "
    "overlap printed; five of the paper's own fields gave 42.64 to 10034 m: which it is may decide"
)


@dataclass(frozen=True)
class Arcs:
    """Arcs of a month: their middle, length in days, and the overlaps printed, m."""

    name: str
    where: str
    begins: datetime
    days: float
    printed: tuple[str, str, str]


#: With the paper's best field, MGM0964C20.
MONTHS = (
    Arcs("February 1999", "table 4", datetime(1999, 2, 15), 1.25, ("0.18", "42.64", "2.02")),
    Arcs("March 1999", "table 5", datetime(1999, 3, 15), 5.5, ("0.60", "5.28", "2.01")),
)


def rows() -> list[Row]:
    """Overlaps of arcs by component, and which component is known worst."""
    made = []
    for arcs in MONTHS:
        overlap, angle = overlaps(arcs)
        for name, printed, value in zip(COMPONENTS, arcs.printed, overlap, strict=True):
            published = float(printed)
            made.append(
                claim(
                    f"{arcs.name}, {name}: overlap of arcs of {arcs.days:g} days, rms",
                    arcs.where, printed, value, "m",
                    f"of one order of magnitude: within {ORDER:g} times",
                    lambda x, y=published: y / ORDER <= x <= y * ORDER,
                    note=f"times {published / value:.3g}; {_DIFFERENCES}",
                )
            )  # fmt: skip
        made.append(
            claim(
                f"{arcs.name}: radial is known best, cross-track worst", arcs.where,
                "radial < along-track < cross-track", overlap, "m",
                "in that order", lambda r, c, a: r < a < c,
            )
        )  # fmt: skip
        made.append(
            computed(
                f"{arcs.name}: angle of the Earth over the orbit's plane", "here", angle, "deg",
                note="seen edge-on, a turn about the line of sight moves it across its plane and "
                "Doppler does not feel it",
            )
        )  # fmt: skip
    return made


def overlaps(arcs: Arcs) -> tuple[tuple[float, float, float], float]:
    """Radial, cross and along overlap that a covariance claims, m, and the Earth's angle, deg."""
    epoch = seconds_past_j2000(arcs.begins)
    sun, earth = (x[0, :3] for x in sun_earth_mci(epoch, np.zeros(1)))
    node = float(np.arctan2(sun[1], sun[0])) + PAST_NOON
    axis = MARS_EQUATORIAL_RADIUS.value + ALTITUDE
    orbit = keplerian(axis, 0.0, INCLINATION, node, 0.0, 0.0, epoch=epoch)
    normal = np.array(
        [
            np.sin(node) * np.sin(INCLINATION),
            -np.cos(node) * np.sin(INCLINATION),
            np.cos(INCLINATION),
        ]
    )
    angle = float(np.degrees(np.arcsin(normal @ earth / np.linalg.norm(earth))))
    tracking = Tracking(
        earth=Tracker(doppler=DOPPLER), duration=arcs.days * SECONDS_PER_DAY, step=STEP
    )
    determined = determine_orbits(Design(orbit, name="Mars Global Surveyor"), tracking)
    late = determined.times >= (1.0 - OVERLAP) * determined.arc
    radial, along, cross = np.sqrt(2.0 * (determined.rms[late, :3] ** 2).mean(axis=0)).tolist()
    return (radial, cross, along), angle

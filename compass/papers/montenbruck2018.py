"""Montenbruck, Steigenberger and Hauschild 2018: what an orbit error is to the average user."""

import numpy as np

from compass.bodies import KELLY2018_RADIUS
from compass.papers.verdict import Row, compare, computed
from compass.signal.weights import average_weights

TITLE = (
    "O. Montenbruck, P. Steigenberger and A. Hauschild, Multi-GNSS signal-in-space range error "
    "assessment - Methodology and results, Advances in Space Research 61:3020-3038, 2018"
)

#: Mean radius of the Earth, and of the orbits of each system, km.
EARTH = 6371.0
SYSTEMS = {
    "GPS": (26_560.0, "49"),
    "GLONASS": (25_508.0, "45"),
    "Galileo": (29_600.0, "61"),
    "BeiDou MEO": (27_906.0, "54"),
    "BeiDou GEO": (42_164.0, "126"),
}
#: Constellations about Mars: radius, km, and mask, degrees.
MARS = ((20_427.7, 0.0), (20_427.7, 5.0), (20_427.7, 10.0), (3396.2 + 800.0, 0.0))


def rows() -> list[Row]:
    """Weights of the systems about the Earth as printed, and those of Mars."""
    where = "weights of the global average"
    made = [
        compare(
            f"{name}, 1/w_AC^2", where, inverse,
            1.0 / average_weights(radius * 1e3, EARTH * 1e3).across2,
        )
        for name, (radius, inverse) in SYSTEMS.items()
    ]  # fmt: skip
    gps = average_weights(SYSTEMS["GPS"][0] * 1e3, EARTH * 1e3)
    made.insert(0, compare("GPS, w_R", where, "0.98", gps.radial))
    for radius, mask in MARS:
        mars = average_weights(radius * 1e3, KELLY2018_RADIUS.value, float(np.radians(mask)))
        made.append(
            computed(
                f"Mars, {radius:g} km, mask {mask:g} deg: w_R, 1/w_AC^2", "here",
                (mars.radial, 1.0 / mars.across2), "1", shown="{:.4f}, {:.1f}",
            )
        )  # fmt: skip
    return made

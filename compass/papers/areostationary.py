"""Silva and Romero 2013, Alvarellos 2010: where areostationary satellites stand still."""

import numpy as np

from compass.frames import SECONDS_PER_DAY
from compass.orbits.equilibria import equilibria, largest_acceleration
from compass.orbits.gravity import built_in_field
from compass.papers.verdict import Row, claim, compare, computed

TITLE = (
    "J. J. Silva and P. Romero, Optimal longitudes determination for the station keeping of "
    "areostationary satellites, Planetary and Space Science 87:14-18, 2013; J. L. Alvarellos, "
    "Perturbations on a stationary satellite by the longitude-dependent terms in Mars' "
    "gravitational field, Journal of the Astronautical Sciences 57:701-715, 2010. Published "
    "numbers as later authors quote them."
)

#: What the authors' older fields and their rounding may move an equilibrium by, degrees: a
#: hundredth of what degree 3 and 4 move it from where degree 2 alone would have it.
FIELDS = 0.05


def rows() -> list[Row]:
    """Equilibria, periods of the swing about them, and the largest push, with GMM-3 to degree 8."""
    field = built_in_field().truncated(8)
    points = equilibria(field)
    stable = [point for point in points if point.stable]
    places = sorted(float(np.degrees(point.longitude)) % 360.0 for point in stable)
    periods = [point.period / SECONDS_PER_DAY for point in stable if point.period]
    where, most = largest_acceleration(field)
    push = stable[0].radius * most / 3.0
    why, ours = "other fields of Mars", "GMM-3 to degree 8"
    return [
        claim(
            "stable longitudes", "Alvarellos 2010", "two", len(stable), "1", "exactly two",
            lambda number: number == 2,
        ),
        compare(
            "stable longitude, east", "Silva and Romero 2013", "167.83", places[0], "deg",
            tolerance=FIELDS, why=why,
        ),
        compare(
            "stable longitude, west", "Silva and Romero 2013", "17.92", 360.0 - places[-1], "deg",
            tolerance=FIELDS, why=why,
        ),
        claim(
            "period of a small swing", "Alvarellos 2010", "130", periods, "days",
            "within 5 of it, either point", lambda *found: all(abs(x - 130) < 5 for x in found),
        ),
        computed("radii at the stable points", ours, [p.radius / 1e3 for p in stable], "km"),
        computed(
            "unstable longitudes", ours,
            [float(np.degrees(p.longitude)) for p in points if not p.stable], "deg",
        ),
        computed(
            "largest acceleration of the longitude", ours,
            float(np.degrees(most)) * SECONDS_PER_DAY**2, "deg/day^2",
        ),
        computed("where", ours, float(np.degrees(where)), "deg"),
        computed(
            "delta-v to withstand it", ours, push * 365.25 * SECONDS_PER_DAY, "m/s a year",
            note="compass keep simulates it burn by burn",
        ),
    ]  # fmt: skip

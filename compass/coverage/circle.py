"""Continuous fold at a place, for ever: proven over its whole circle of latitude."""

from dataclasses import dataclass

import numpy as np

from compass.core.circle import PROVEN, REFUTED, fold_on_circle
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.sites import Site

OUTCOMES = ("proven", "refuted", "undecided")

#: Radians: margins smaller than about this stay undecided.
SMALLEST = 1e-5

#: Boxes of longitude and phase to look at: some seconds.
MOST_BOXES = 2_000_000


@dataclass(frozen=True)
class CircleProof:
    """What was found about a claim on a circle of latitude.

    Attributes
    ----------
    outcome
        ``proven``, ``refuted`` or ``undecided``.
    longitude
        Where it fails or is not settled: the longitude of the user from the x axis of the
        elements, radians; nan if proven.
    phase
        When: growth of the mean anomalies since the epoch, radians; nan if proven.
    boxes
        Boxes looked at.
    """

    outcome: str
    longitude: float
    phase: float
    boxes: int


def prove_circle(
    constellation: Constellation,
    site: Site,
    fold: int,
    *,
    phases: float = 2.0 * np.pi,
    lift: float = 0.0,
    smallest: float = SMALLEST,
    most: int = MOST_BOXES,
) -> CircleProof:
    """Prove or refute that `fold` satellites are always above a site's horizon, at any longitude.

    For orbits of one period that is not a fraction of Mars's rotation the circle and the place
    are one claim: longitude and phase together come arbitrarily near every pair of values. Where
    the ground tracks close, the claim on the circle is the stronger one.

    Parameters
    ----------
    constellation
        Orbits of one period, in two-body motion.
    site
        Latitude, height, horizon and figure count; the longitude does not.
    fold
        At least 1.
    phases
        Growth of the mean anomalies that decides, radians: a whole revolution, or the part
        after which the constellation is itself, turned about the pole.
    lift
        Added to the whole horizon, radians.
    smallest, most
        When to give up: width of boxes in radians, and their number.

    Raises
    ------
    ArgumentError
        Orbits of different periods, a fold below 1.
    """
    c = constellation
    if fold < 1:
        raise ArgumentError(f"fold = {fold}: must be a whole number from 1 on")
    if c.size and not np.all(c.semi_major_axis == c.semi_major_axis[0]):
        raise ArgumentError(
            "orbits of different periods: a claim for ever needs one period; give a span of time"
        )
    orbits = np.stack(
        [
            c.semi_major_axis,
            c.eccentricity,
            c.inclination,
            c.raan,
            c.argument_of_periapsis,
            c.mean_anomaly,
        ]
    )
    zero = Site(site.name, site.latitude, 0.0, site.height, site.mask, site.figure)
    outcome, longitude, phase, boxes = fold_on_circle(
        orbits,
        zero.r_mcmf,
        zero.enu_mcmf,
        np.array(site.mask.azimuth),
        np.array(site.mask.elevation),
        lift,
        fold,
        phases,
        smallest,
        most,
    )
    assert outcome in (PROVEN, REFUTED) or np.isfinite(longitude)
    return CircleProof(OUTCOMES[outcome], float(longitude), float(phase), int(boxes))


@dataclass(frozen=True)
class SiteCoverage:
    """Whether a site always has the satellites it wants, wherever on its latitude it stands.

    Attributes
    ----------
    site
        The place with its horizon.
    proof
        Of the claim over its circle of latitude.
    room
        By how much the whole horizon may rise, radians, proven; None unless the claim is.
    """

    site: Site
    proof: CircleProof
    room: float | None


#: Radians to which the room over a horizon is looked for, and boxes for each try: close to where
#: the claim fails they are too few, and the room comes out a little too small.
ROOM, ROOM_BOXES = 1e-3, 20_000


def site_coverage_for_ever(constellation: Constellation, site: Site, fold: int) -> SiteCoverage:
    """Prove the fold over a site's own horizon for ever, and find how much higher that may be.

    Raises
    ------
    ArgumentError
        As `prove_circle`.
    """
    proof = prove_circle(constellation, site, fold)
    if proof.outcome != "proven":
        return SiteCoverage(site, proof, None)
    proven, unproven = 0.0, np.pi / 2
    while unproven - proven > ROOM:
        lift = 0.5 * (proven + unproven)
        held = prove_circle(constellation, site, fold, lift=lift, most=ROOM_BOXES)
        proven, unproven = (lift, unproven) if held.outcome == "proven" else (proven, lift)
    return SiteCoverage(site, proof, proven)

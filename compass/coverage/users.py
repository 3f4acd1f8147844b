"""Users that share a horizon: at a site, in a belt of latitude, in a region turning with Mars."""

from dataclasses import dataclass, field, replace

import numpy as np

from compass.coverage.region import GLOBE, Region
from compass.errors import ArgumentError
from compass.frames import Figure, planetocentric_latitude, planetographic_latitude
from compass.orbits import Constellation
from compass.orbits.motion import Motion
from compass.orbits.symmetry import one_circle
from compass.sites import Mask, Site

#: How satellites move that nothing but Mars's mass pulls.
KEPLER = Motion()


@dataclass(frozen=True)
class Users:
    """Places that share a horizon.

    Attributes
    ----------
    name
        What to call them.
    south, north
        Geodetic latitudes, radians; equal for a site.
    figure
        The figure over which they stand.
    mask
        Their horizon by azimuth; below 0 for users who look down.
    height
        Above the figure along its normal, metres.
    longitude
        Of a site, radians east; None elsewhere.
    region
        To which part of the belt they belong, where that turns with Mars.
    beam
        Half angle of the satellites' antennas about the way down, radians; None all around.
    """

    name: str
    south: float
    north: float
    figure: Figure
    mask: Mask = field(default_factory=Mask)
    height: float = 0.0
    longitude: float | None = None
    region: Region = GLOBE
    beam: float | None = None

    @property
    def is_belt(self) -> bool:
        """Whether they stand at every longitude."""
        return self.longitude is None and not self.region.mars_fixed

    @property
    def alike_all_around(self) -> bool:
        """Whether the horizon is the same in every direction."""
        return self.mask.is_constant

    def belt(self) -> "Users":
        """The users and all others on their circles of latitude."""
        return replace(self, longitude=None, region=GLOBE)


def site_users(site: Site, mask: Mask | None = None) -> Users:
    """Users at a site, over its own horizon or another."""
    latitude = geodetic(site.latitude, site.figure)
    return Users(
        site.name,
        latitude,
        latitude,
        site.figure,
        site.mask if mask is None else mask,
        height=site.height,
        longitude=site.longitude,
    )


def region_users(region: Region, figure: Figure, mask: Mask, *, height: float = 0.0) -> Users:
    """Users in a region, at a height above the ground."""
    south, north = (geodetic(b, figure) for b in region.latitudes())
    return Users(
        name=region.name,
        south=south,
        north=north,
        figure=figure,
        mask=mask,
        height=height,
        region=region if region.mars_fixed else GLOBE,
    )


def check_limb(users: Users) -> None:
    """Refuse users who look through Mars: the horizon from a height dips by ``acos(a/(b + h))``.

    Raises
    ------
    ArgumentError
        Their mask is below that.
    """
    seen_from = users.figure.polar_radius + users.height
    dip = float(np.arccos(min(1.0, users.figure.equatorial_radius / seen_from)))
    if users.mask.lowest < -dip - 1e-12:
        allowed = np.ceil(-np.degrees(dip) * 1e4) / 1e4  # rounded into what is allowed
        raise ArgumentError(
            f"mask_deg = {np.degrees(users.mask.lowest):.7g}: below the limb of Mars as seen from "
            f"{users.height / 1e3:g} km; allowed from {allowed:.7g}"
        )


def by_horizon(users: Users, constellation: Constellation, motion: Motion = KEPLER) -> Users:
    """Users over the horizon that stands for the antennas' beam, where one does.

    Under circles of one radius r, on a sphere, a user at radius u stands at the edge of a beam at
    the elevation ``acos(r sin(beam) / u)``, and above that inside it: a horizon stands for the
    beam. As far below the level, where he looks through to who is beyond the limb, it takes him in
    again; there, on an ellipsoid and off such circles the beam stays.
    """
    if users.beam is None:
        return users
    circles = one_circle(constellation) and motion.is_closed_form
    if not (users.figure.is_sphere and circles):
        return users
    reach = float(constellation.semi_major_axis[0]) * np.sin(users.beam)
    edge = reach / (users.figure.equatorial_radius + users.height)
    if users.beam >= 0.5 * np.pi or edge >= 1.0:
        return replace(users, beam=None)
    least = float(np.arccos(edge))
    if users.mask.lowest <= -least:
        return users
    return replace(users, beam=None, mask=users.mask.or_higher(Mask.constant(least)))


def geodetic(latitude: float, figure: Figure) -> float:
    """Geodetic latitude of a planetocentric one."""
    return float(planetographic_latitude(latitude, figure))


def centric(latitude: float, figure: Figure) -> float:
    """Planetocentric latitude of a geodetic one on the figure."""
    return float(planetocentric_latitude(latitude, figure))

"""Users that share a horizon: at a site, in a belt of latitude, in a region turning with Mars."""

from dataclasses import dataclass, field, replace

from compass.coverage.region import GLOBE, Region
from compass.frames import Figure, planetocentric_latitude, planetographic_latitude
from compass.sites import Mask, Site


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
        Their horizon by azimuth.
    below
        Added to the horizon, radians: negative for users who look down.
    height
        Above the figure along its normal, metres.
    longitude
        Of a site, radians east; None elsewhere.
    region
        To which part of the belt they belong, where that turns with Mars.
    """

    name: str
    south: float
    north: float
    figure: Figure
    mask: Mask = field(default_factory=Mask)
    below: float = 0.0
    height: float = 0.0
    longitude: float | None = None
    region: Region = GLOBE

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


def region_users(
    region: Region, figure: Figure, mask: Mask, *, below: float = 0.0, height: float = 0.0
) -> Users:
    """Users in a region, at a height above the ground."""
    south, north = (geodetic(b, figure) for b in region.latitudes())
    return Users(
        name=region.name,
        south=south,
        north=north,
        figure=figure,
        mask=mask,
        below=below,
        height=height,
        region=region if region.mars_fixed else GLOBE,
    )


def geodetic(latitude: float, figure: Figure) -> float:
    """Geodetic latitude of a planetocentric one."""
    return float(planetographic_latitude(latitude, figure))


def centric(latitude: float, figure: Figure) -> float:
    """Planetocentric latitude of a geodetic one on the figure."""
    return float(planetocentric_latitude(latitude, figure))

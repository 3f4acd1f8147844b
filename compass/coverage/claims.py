"""The claims on spherical parts of the ground that stand for a requirement's places."""

from dataclasses import dataclass

import numpy as np

from compass.coverage.fold_verdict import users_of
from compass.coverage.region import GLOBE, Region, convex_polygon, read_regions
from compass.coverage.users import Users
from compass.design import Design
from compass.requirement import Requirement
from compass.sites import Site

#: Half a side of the square that stands for a site, radians: 60 m.
SQUARE = 2e-5


@dataclass(frozen=True)
class Claim:
    """A part of a sphere, or of an ellipsoid, over which satellites are to stand above a mask.

    Attributes
    ----------
    users
        Who stand there.
    radius
        Of the sphere, or of the equator, m.
    lowest, highest
        Elevations between which the mask lies, radians: what holds over the highest holds, what
        fails over the lowest fails.
    region
        The part.
    stretch
        Ratio of the equatorial radius to the polar one: 1 for a sphere.
    ground
        What its users stand on, in words, where that is not the design's figure.
    """

    users: Users
    radius: float
    lowest: float
    highest: float
    region: Region = GLOBE
    stretch: float = 1.0
    ground: str = ""

    @property
    def name(self) -> str:
        """What to call it."""
        return self.users.name

    @property
    def mask(self) -> float:
        """The highest of what was asked for, radians."""
        return self.users.mask.highest


def claims_of(design: Design, requirement: Requirement) -> tuple[Claim, ...]:
    """Claims that stand for the places of a requirement; of regions on the design's figure.

    A site stands for the points of a small square about it, on the sphere through it: its up leans
    from the radius by a known angle, which the mask is raised by to prove and lowered by to refute.
    A mask that depends on azimuth proves with its highest all around and refutes with its lowest.
    """
    users, sites = users_of(design, requirement), len(requirement.sites)
    radius = design.figure.equatorial_radius + requirement.altitude
    regions = [region for text in requirement.areas for region in read_regions(text)]
    claims = [
        Claim(each, radius, each.mask.lowest, each.mask.highest, region, design.figure.stretch)
        for region, each in zip(regions, users[sites:], strict=True)
    ]
    for site, each in zip(requirement.sites, users[:sites], strict=True):
        lean = abs(each.south - site.latitude) + 2 * SQUARE
        claims.append(
            Claim(
                each,
                float(np.linalg.norm(site.r_mcmf)),
                each.mask.lowest - lean,
                each.mask.highest + lean,
                square(site),
                ground="the place at its height, over its own vertical",
            )
        )
    return tuple(claims)


def square(site: Site) -> Region:
    """A convex polygon of some hundred metres about a site."""
    east, north, _ = site.enu_mcmf
    middle = site.r_mcmf / np.linalg.norm(site.r_mcmf)
    corners = [middle + SQUARE * (x * east + y * north) for x, y in _CORNERS]
    r = np.array(corners)
    latitudes = np.arctan2(r[:, 2], np.hypot(r[:, 0], r[:, 1]))
    return convex_polygon(latitudes, np.arctan2(r[:, 1], r[:, 0]))


_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))

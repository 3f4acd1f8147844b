"""The analytic geometry of a symmetric constellation: cap, gaps and totals, from formulas alone."""

from dataclasses import dataclass

import numpy as np

from compass.coverage.cap import Cap, cap, published_cap_area
from compass.coverage.gap import (
    Gap,
    gap,
    gap_circumference,
    plane_closes,
    published_gap_circumference,
)
from compass.orbits import Constellation


@dataclass(frozen=True)
class Geometry:
    """Cap of one satellite and gaps of one plane, with totals over the constellation.

    Attributes
    ----------
    cap
        Cap of one satellite.
    gap
        Gap of one plane, or None where there are no gap polygons.
    planes, per_plane
        Of the pattern.
    inclination
        Radians.
    """

    cap: Cap
    gap: Gap | None
    planes: int
    per_plane: int
    inclination: float

    @property
    def closes(self) -> bool:
        """Whether a plane's caps meet all around."""
        return plane_closes(self.cap.half_arc, self.per_plane)

    @property
    def sphere_area(self) -> float:
        """4 pi R^2, m^2."""
        return float(4 * np.pi * self.cap.sphere_radius**2)

    @property
    def total_area(self) -> float:
        """Sum of all caps, overlaps counted as often as they are served, m^2."""
        return self.planes * self.per_plane * self.cap.area

    @property
    def published_total_area(self) -> float:
        """The same with the printed cap area of Kelly and Bevilacqua 2018, m^2; wrong."""
        return self.planes * self.per_plane * published_cap_area(self.cap)

    @property
    def plane_area(self) -> float | None:
        """Area that one plane serves at least once: the sphere without two gaps, m^2."""
        return None if self.gap is None else self.sphere_area - 2 * self.gap.area

    @property
    def neighbour_overlap(self) -> float | None:
        """Area that two neighbours of a plane both serve, m^2.

        The caps' sum exceeds what the plane serves by one lens a neighbouring pair, as long as
        no point sees three of the plane, which holds where a plane has three satellites: their
        directions add up to zero, so they cannot all be within less than a right angle.
        """
        if self.plane_area is None or self.per_plane != 3:
            return None
        return (self.per_plane * self.cap.area - self.plane_area) / self.per_plane

    @property
    def limit_circumference(self) -> float | None:
        """Sum of the gap bases, one a plane: ``p Q``, metres."""
        return None if self.gap is None else self.planes * self.gap.base

    @property
    def circumference(self) -> float | None:
        """True length of the parallel that the gaps are compared with, metres."""
        return None if self.gap is None else gap_circumference(self.gap, self.inclination)

    @property
    def published_circumference(self) -> float | None:
        """The same parallel by the printed formula, metres; wrong."""
        if self.gap is None:
            return None
        return published_gap_circumference(self.gap, self.inclination)


def pattern_geometry(
    constellation: Constellation, sphere_radius: float, mask: float = 0.0
) -> Geometry | None:
    """Geometry of a symmetric pattern; None for explicit elements, which have no one cap.

    Parameters
    ----------
    constellation
        The orbits.
    sphere_radius
        Metres.
    mask
        Elevation mask, radians.
    """
    pattern = constellation.pattern
    if pattern is None:
        return None
    radius = float(constellation.semi_major_axis[0])
    return Geometry(
        cap(radius, sphere_radius, mask),
        gap(radius, sphere_radius, pattern.per_plane, mask),
        pattern.planes,
        pattern.per_plane,
        pattern.inclination,
    )

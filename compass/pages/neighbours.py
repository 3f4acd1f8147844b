"""Patterns beside a design's own: as many satellites, other phasings and inclinations."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from compass.coverage.margin import covering_radius
from compass.orbits import Constellation, Pattern
from compass.orbits.constellation import from_pattern

#: How far beside the design's own phasing, and over which inclinations, degrees.
MOST, INCLINATIONS = 8, (20.0, 90.0)


@dataclass(frozen=True)
class Neighbour:
    """Highest masks of one pattern over inclination.

    Attributes
    ----------
    pattern
        Its inclination is the design's.
    inclination_deg, margin_deg
        Where it was tried, and the highest mask with the fold wanted there, to 0.1 degree.
    """

    pattern: Pattern
    inclination_deg: NDArray[np.float64]
    margin_deg: NDArray[np.float64]

    @property
    def name(self) -> str:
        """Walker's t/p/f."""
        return f"{self.pattern.satellites}/{self.pattern.planes}/{self.pattern.phasing}"

    @property
    def mask_deg(self) -> float:
        """The highest mask of all inclinations, degrees."""
        return float(self.margin_deg.max())

    @property
    def notation(self) -> str:
        """The pattern at the inclination that has it."""
        return f"{self.inclination_deg[self.margin_deg.argmax()]:.3g}°: {self.name}"


def neighbours(
    c: Constellation, fold: int, sphere: float, *, inclinations: int = 46
) -> list[Neighbour]:
    """Patterns that differ in phasing alone, the design's first, over inclination.

    Parameters
    ----------
    c
        A pattern of circular orbits.
    fold
        Satellites wanted in view.
    sphere
        Radius of the sphere, metres.
    inclinations
        How many.
    """
    assert c.pattern is not None
    angles, radius = np.linspace(*INCLINATIONS, inclinations), float(c.semi_major_axis[0])
    near = []
    for pattern in _phasings(c.pattern):
        masks = []
        for angle in np.radians(angles):
            tried = from_pattern(replace(pattern, inclination=float(angle)), radius)
            least = covering_radius(tried, fold, tolerance=2e-3)
            cap = 0.5 * (least.radius + least.at_least)
            masks.append(np.arctan2(np.cos(cap) - sphere / radius, np.sin(cap)))
        near.append(Neighbour(pattern, angles, np.degrees(masks)))
    return near


def _phasings(pattern: Pattern) -> list[Pattern]:
    """The design's phasing first, then those nearest to it."""
    others = [f for f in range(pattern.planes) if f != pattern.phasing % pattern.planes]
    near = sorted(others, key=lambda f: (abs(f - pattern.phasing), f))[: MOST - 1]
    return [
        Pattern(pattern.kind, pattern.satellites, pattern.planes, f, pattern.inclination)
        for f in [pattern.phasing, *near]
    ]

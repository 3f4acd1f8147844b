"""Symmetric patterns of circular orbits: laid out from their numbers, found in elements."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from compass.orbits.kinds import WALKER_DELTA, WALKER_STAR, kind_of, least_multiplier

#: Radians by which elements may stray from a pattern and still be told to form it: 20 cm at
#: the areosynchronous radius.
TOLERANCE = 1e-8


@dataclass(frozen=True)
class Pattern:
    """How a symmetric constellation of circular orbits is laid out; satellites in plane order.

    Plane k has its ascending node at ``raan + k spread / planes``, the spread 2 pi for a delta
    and pi for a star; its satellite j has argument of latitude
    ``phase + 2 pi j / per_plane + 2 pi phasing k / satellites``.

    Attributes
    ----------
    kind
        ``walker-delta`` or ``walker-star``.
    satellites, planes, phasing
        Walker's t, p and f, f from 0 to p - 1.
    inclination
        Radians.
    raan, phase
        Node and argument of latitude of the first satellite, radians.
    deviation
        Greatest angle by which a satellite strays from this layout, radians.
    """

    kind: str
    satellites: int
    planes: int
    phasing: int
    inclination: float
    raan: float = 0.0
    phase: float = 0.0
    deviation: float = 0.0

    @property
    def per_plane(self) -> int:
        """Satellites in a plane."""
        return self.satellites // self.planes

    @property
    def node_spread(self) -> float:
        """Angle over which the ascending nodes are spread, radians: pi for a star, else 2 pi."""
        return kind_of(self.kind).node_spread

    @property
    def multiplier(self) -> Fraction | None:
        """Ballard's least m of the rosette that it is, or None if it is none."""
        if self.kind == WALKER_STAR.name:
            return None
        return least_multiplier(self.satellites, self.planes, self.phasing)

    @property
    def notation(self) -> str:
        """The field's short name, such as ``45°: 15/5/1``."""
        degrees = f"{np.degrees(self.inclination):.6g}"
        return f"{degrees}°: {self.satellites}/{self.planes}/{self.phasing}"

    def angles(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Node and argument of latitude of each satellite, radians in [0, 2 pi), shape (n,)."""
        plane = np.repeat(np.arange(self.planes), self.per_plane)
        slot = np.tile(np.arange(self.per_plane), self.planes)
        raan = self.raan + plane * self.node_spread / self.planes
        along = (
            2 * np.pi * slot / self.per_plane + 2 * np.pi * self.phasing * plane / self.satellites
        )
        return raan, np.mod(self.phase + along, 2 * np.pi)

    def satellite_names(self) -> list[str]:
        """Names by plane and slot, such as ``P1S2``."""
        return [f"P{p + 1}S{s + 1}" for p in range(self.planes) for s in range(self.per_plane)]


def rosette_notation(satellites: int, planes: int, multiplier: Fraction) -> str:
    """Ballard's short name, such as ``(12, 3, 1/4)``."""
    return f"({satellites}, {planes}, {multiplier})"


def find_pattern(
    inclination: NDArray[np.float64],
    raan: NDArray[np.float64],
    argument_of_latitude: NDArray[np.float64],
) -> Pattern | None:
    """Return the pattern that satellites on circular orbits of one radius form, in plane order.

    The planes are where the node changes; step and phasing are read off the first satellites of
    the first two planes, and every satellite is then held against the layout.

    Parameters
    ----------
    inclination, raan, argument_of_latitude
        Radians, shape (n,).

    Returns
    -------
    pattern
        None unless every angle is within `TOLERANCE` of the layout.
    """
    n = raan.size
    if n == 0:
        return None
    moved = np.abs(turned(raan - raan[0])) > TOLERANCE
    per_plane = int(np.argmax(moved)) if moved.any() else n
    if n % per_plane:
        return None
    planes = n // per_plane
    ahead = argument_of_latitude[per_plane if planes > 1 else 0] - argument_of_latitude[0]
    phasing = round(float(ahead) * n / (2 * np.pi)) % planes
    for kind in (WALKER_DELTA, WALKER_STAR):
        proposed = Pattern(
            kind=kind.name,
            satellites=n,
            planes=planes,
            phasing=phasing,
            inclination=float(inclination[0]),
            raan=float(raan[0]),
            phase=float(argument_of_latitude[0]),
        )
        nodes, along = proposed.angles()
        apart = (
            np.abs(inclination - inclination[0])
            + np.abs(turned(raan - nodes))
            + np.abs(turned(argument_of_latitude - along))
        )
        if apart.max() <= TOLERANCE:
            return Pattern(
                kind=kind.name,
                satellites=n,
                planes=planes,
                phasing=phasing,
                inclination=proposed.inclination,
                raan=proposed.raan,
                phase=proposed.phase,
                deviation=float(apart.max()),
            )
    return None


def turned(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles brought to [-pi, pi)."""
    return np.asarray(np.mod(angle + np.pi, 2 * np.pi) - np.pi)

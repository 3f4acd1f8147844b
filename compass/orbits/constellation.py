"""A constellation: the orbits of its satellites, and the pattern they form, if any."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_GM
from compass.errors import ArgumentError


@dataclass(frozen=True)
class Pattern:
    """How a symmetric constellation of circular orbits is built; satellites in plane order.

    Plane k has its ascending node at ``k node_spread / planes``; its satellite j has argument
    of latitude ``2 pi j / per_plane + 2 pi phasing k / satellites``.

    Attributes
    ----------
    kind
        ``walker-delta``, ``walker-star`` or ``rosette``.
    satellites, planes
        Totals t and p.
    phasing
        Walker's F.
    inclination
        Radians.
    multiplier
        Ballard's m of a rosette, an integer multiple of planes/satellites; else None.
    """

    kind: str
    satellites: int
    planes: int
    phasing: int
    inclination: float
    multiplier: Fraction | None = None

    @property
    def per_plane(self) -> int:
        """Satellites in a plane."""
        return self.satellites // self.planes

    @property
    def node_spread(self) -> float:
        """Angle over which the ascending nodes are spread, radians: pi for a star, else 2 pi."""
        return np.pi if self.kind == "walker-star" else 2.0 * np.pi

    @property
    def notation(self) -> str:
        """The field's short name, such as ``45°: 15/5/1`` or ``(12, 3, 1/4)``."""
        if self.multiplier is not None:
            return f"({self.satellites}, {self.planes}, {self.multiplier})"
        degrees = f"{np.degrees(self.inclination):.6g}"
        return f"{degrees}°: {self.satellites}/{self.planes}/{self.phasing}"


@dataclass(frozen=True)
class Constellation:
    """Orbits of n satellites about Mars: osculating or mean elements at an epoch.

    Attributes
    ----------
    name
        What to call it.
    semi_major_axis, eccentricity, inclination, raan, argument_of_periapsis, mean_anomaly
        Elements in the Mars-centred inertial frame, shape (n,): metres and radians.
    epoch
        TDB seconds past J2000.
    satellite_names
        One name a satellite.
    pattern
        The symmetric pattern that made the elements, or None for explicit ones.
    gm
        Gravitational parameter, m^3/s^2.
    """

    name: str
    semi_major_axis: NDArray[np.float64]
    eccentricity: NDArray[np.float64]
    inclination: NDArray[np.float64]
    raan: NDArray[np.float64]
    argument_of_periapsis: NDArray[np.float64]
    mean_anomaly: NDArray[np.float64]
    epoch: float = 0.0
    satellite_names: tuple[str, ...] = ()
    pattern: Pattern | None = None
    gm: float = MARS_GM.value

    @property
    def size(self) -> int:
        """Number of satellites."""
        return int(self.semi_major_axis.size)

    @property
    def is_circular(self) -> bool:
        """Whether every orbit is a circle."""
        return bool(np.all(self.eccentricity == 0.0))

    @property
    def mean_motion(self) -> NDArray[np.float64]:
        """Two-body mean motions ``sqrt(GM/a^3)``, rad/s, shape (n,)."""
        return np.sqrt(self.gm / self.semi_major_axis**3)

    @property
    def periapsis_radius(self) -> NDArray[np.float64]:
        """Smallest distances from Mars's centre, metres, shape (n,)."""
        return self.semi_major_axis * (1.0 - self.eccentricity)

    @property
    def apoapsis_radius(self) -> NDArray[np.float64]:
        """Largest distances from Mars's centre, metres, shape (n,)."""
        return self.semi_major_axis * (1.0 + self.eccentricity)

    def without(self, lost: Sequence[int]) -> "Constellation":
        """Return the constellation after the loss of the satellites with these indices."""
        kept = np.setdiff1d(np.arange(self.size), np.asarray(lost, dtype=int))
        return from_elements(
            self.semi_major_axis[kept],
            self.eccentricity[kept],
            self.inclination[kept],
            self.raan[kept],
            self.argument_of_periapsis[kept],
            self.mean_anomaly[kept],
            name=self.name,
            epoch=self.epoch,
            satellite_names=tuple(self.satellite_names[k] for k in kept),
            gm=self.gm,
        )


def from_elements(
    semi_major_axis: ArrayLike,
    eccentricity: ArrayLike,
    inclination: ArrayLike,
    raan: ArrayLike,
    argument_of_periapsis: ArrayLike,
    mean_anomaly: ArrayLike,
    *,
    name: str = "constellation",
    epoch: float = 0.0,
    satellite_names: Sequence[str] = (),
    pattern: Pattern | None = None,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Make a constellation from Keplerian elements; scalars stand for every satellite.

    Parameters
    ----------
    semi_major_axis, eccentricity, inclination, raan, argument_of_periapsis, mean_anomaly
        Broadcast to a common shape (n,); metres and radians.
    name, epoch, satellite_names, pattern, gm
        As in `Constellation`; satellites without names are numbered.

    Raises
    ------
    ArgumentError
        An element that is not finite, a semi-major axis that is not positive, or an
        eccentricity outside [0, 1).
    """
    elements = np.broadcast_arrays(
        *(
            np.atleast_1d(np.asarray(value, dtype=float))
            for value in (
                semi_major_axis,
                eccentricity,
                inclination,
                raan,
                argument_of_periapsis,
                mean_anomaly,
            )
        )
    )
    a, e = elements[0], elements[1]
    if not all(np.isfinite(element).all() for element in elements):
        raise ArgumentError("orbital elements: every element must be a finite number")
    if np.any(a <= 0):
        raise ArgumentError(f"semi_major_axis = {a.min()} m: must be positive")
    if np.any((e < 0) | (e >= 1)):
        raise ArgumentError(f"eccentricity = {e[(e < 0) | (e >= 1)][0]}: allowed 0 up to below 1")
    frozen = [_read_only(element) for element in elements]
    names = tuple(satellite_names) or tuple(f"S{k + 1:02d}" for k in range(a.size))
    if len(names) != a.size:
        raise ArgumentError(f"satellite_names: {len(names)} names for {a.size} satellites")
    return Constellation(
        name,
        frozen[0],
        frozen[1],
        frozen[2],
        frozen[3],
        frozen[4],
        frozen[5],
        epoch=epoch,
        satellite_names=names,
        pattern=pattern,
        gm=gm,
    )


def _read_only(values: NDArray[np.float64]) -> NDArray[np.float64]:
    copy = np.array(values)
    copy.flags.writeable = False
    return copy


def from_pattern(
    pattern: Pattern,
    radius: float,
    *,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Lay out a symmetric pattern on circular orbits of one radius (metres)."""
    plane = np.repeat(np.arange(pattern.planes), pattern.per_plane)
    slot = np.tile(np.arange(pattern.per_plane), pattern.planes)
    raan = plane * pattern.node_spread / pattern.planes
    latitude_argument = (
        2 * np.pi * slot / pattern.per_plane
        + 2 * np.pi * pattern.phasing * plane / pattern.satellites
    )
    return from_elements(
        radius,
        0.0,
        pattern.inclination,
        raan,
        0.0,
        np.mod(latitude_argument, 2 * np.pi),
        name=name or pattern.notation,
        epoch=epoch,
        satellite_names=[f"P{p + 1}S{s + 1}" for p, s in zip(plane, slot, strict=True)],
        pattern=pattern,
        gm=gm,
    )


def check_counts(satellites: int, planes: int) -> None:
    """Raise `ArgumentError` unless the satellites divide evenly into the planes."""
    if satellites < 1 or planes < 1:
        raise ArgumentError(
            f"satellites = {satellites}, planes = {planes}: both must be at least 1"
        )
    if satellites % planes:
        divisors = [str(d) for d in range(1, satellites + 1) if satellites % d == 0]
        raise ArgumentError(
            f"planes = {planes}: {satellites} satellites do not divide into {planes} planes; "
            f"use one of {', '.join(divisors)}"
        )

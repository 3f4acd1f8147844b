"""A constellation: the orbits of its satellites."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.bodies import MARS_GM
from compass.errors import ArgumentError, real_number, whole_number
from compass.orbits.pattern import Pattern, find_pattern
from compass.words import counted


@dataclass(frozen=True, eq=False, repr=False)
class Constellation:
    """Orbits of n satellites about Mars: osculating or mean elements at an epoch.

    Constellations compare and hash by value: elements, epoch, names and GM. Two of them join
    by ``+``; satellites of one name then get that of their constellation before it. The arrays
    are read-only copies.

    Examples
    --------
    >>> import compass
    >>> ring = compass.walker_delta(3, 1, 0, inclination_deg=0, orbit="areosynchronous")
    >>> polar = compass.from_elements(
    ...     semi_major_axis_km=9000, inclination_deg=90, satellite_names=["polar"]
    ... )
    >>> ring
    Constellation walker-delta 0°: 3/1/0, 3 satellites in 1 plane at 20427.7 km
    >>> (ring + polar).size, ring.without([0]).size, (ring + polar).pattern is None
    (4, 2, True)

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
    gm
        Gravitational parameter, m^3/s^2.
    repeat
        Revolutions and rotations of Mars after which the ground tracks are declared to close, for
        ever; None where nobody says so of all, however near to closed they are.
    repeats
        The same of each satellite, where they differ; empty where `repeat` says it of all.
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
    gm: float = MARS_GM.value
    repeat: tuple[int, int] | None = None
    repeats: tuple[tuple[int, int] | None, ...] = ()

    def __post_init__(self) -> None:
        elements = {name: np.array(getattr(self, name), dtype=float) for name in ELEMENTS}
        check_elements(elements)
        for name, values in elements.items():
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        if len(self.satellite_names) != self.size:
            raise ArgumentError(
                f"satellite_names: {counted(len(self.satellite_names), 'name')} for "
                f"{counted(self.size, 'satellite')}"
            )
        if self.repeats and (self.repeat is not None or len(self.repeats) != self.size):
            raise ArgumentError(
                f"repeats: {len(self.repeats)} for {counted(self.size, 'satellite')}; give one for "
                "each, and no repeat of all beside them"
            )
        real_number("epoch", self.epoch)
        if not real_number("gm", self.gm) > 0:
            raise ArgumentError(f"gm = {self.gm:g}: must be above 0 m^3/s^2")

    def _value(self) -> tuple:
        """Everything that makes it what it is, hashable."""
        return tuple(
            value.tobytes() if isinstance(value, np.ndarray) else value
            for value in (getattr(self, field.name) for field in fields(self))
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Constellation) and self._value() == other._value()

    def __hash__(self) -> int:
        return hash(self._value())

    def __add__(self, other: "Constellation") -> "Constellation":
        """Both together, at the epoch and about the Mars that they share.

        Raises
        ------
        ArgumentError
            Different epochs or gravitational parameters, or both of one name and with satellites
            of one name; what is added is no constellation.
        """
        if not isinstance(other, Constellation):
            raise ArgumentError(
                f"{self.name} + {type(other).__name__}: only constellations join by +; of a "
                "design, add its .constellation"
            )
        if (self.epoch, self.gm) != (other.epoch, other.gm):
            raise ArgumentError(
                f"{self.name} + {other.name}: different epochs or gravitational parameters; give "
                "both the same"
            )
        names = self.satellite_names + other.satellite_names
        if len(set(names)) < len(names):
            names = tuple(f"{c.name} {name}" for c in (self, other) for name in c.satellite_names)
        if len(set(names)) < len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise ArgumentError(
                f"{self.name} + {other.name}: two satellites are called {twice}; give each "
                "constellation its own name"
            )
        both: dict[str, Any] = {
            e: np.concatenate([getattr(self, e), getattr(other, e)]) for e in ELEMENTS
        }
        both |= declared([*self.each_repeat, *other.each_repeat])
        return replace(self, name=f"{self.name} + {other.name}", satellite_names=names, **both)

    def __repr__(self) -> str:
        known = self.pattern is not None and self.name == self.pattern.notation
        return f"Constellation {'' if known else f'{self.name}: '}{self.words}"

    @property
    def words(self) -> str:
        """What it is, in words: its pattern, or how many and how far out."""
        count = f"{self.size} satellite{'s' if self.size != 1 else ''}"
        if (pattern := self.pattern) is not None:
            planes = f"{pattern.planes} plane{'s' if pattern.planes > 1 else ''}"
            radius = f"{self.semi_major_axis[0] / 1e3:.6g} km"
            return f"{pattern.kind} {pattern.notation}, {count} in {planes} at {radius}"
        if not self.size:
            return count
        low, high = self.periapsis_radius.min() / 1e3, self.apoapsis_radius.max() / 1e3
        return f"{count} on orbits of their own, {low:.6g} to {high:.6g} km from the centre"

    @property
    def size(self) -> int:
        """Number of satellites."""
        return int(self.semi_major_axis.size)

    @cached_property
    def pattern(self) -> Pattern | None:
        """The symmetric pattern that the elements form, found in them and verified, or None."""
        if not self.size or not self.is_circular or np.ptp(self.semi_major_axis) != 0.0:
            return None
        along = self.argument_of_periapsis + self.mean_anomaly
        return find_pattern(self.inclination, self.raan, along)

    @property
    def each_repeat(self) -> tuple[tuple[int, int] | None, ...]:
        """`repeat` of each satellite."""
        return self.repeats or (self.repeat,) * self.size

    @property
    def rotations(self) -> int | None:
        """Rotations of Mars after which all tracks are declared closed; None if one is not."""
        each = [repeat[1] for repeat in self.each_repeat if repeat is not None]
        return lcm(*each) if each and len(each) == self.size else None

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

    @checked
    def without(self, lost: Sequence[int]) -> "Constellation":
        """Return the constellation after the loss of the satellites with these indices.

        Raises
        ------
        ArgumentError
            There is no satellite with such an index.
        """
        gone = np.array([whole_number("lost", k) for k in lost], dtype=int)
        for k in gone[(gone < 0) | (gone >= self.size)]:
            allowed = f"allowed 0 to {self.size - 1}" if self.size else "there are no satellites"
            raise ArgumentError(f"lost = {k}: {allowed}")
        kept = np.setdiff1d(np.arange(self.size), gone)
        left: dict[str, Any] = {e: getattr(self, e)[kept] for e in ELEMENTS}
        if self.repeats:
            left |= declared([self.repeats[k] for k in kept])
        return replace(self, satellite_names=tuple(self.satellite_names[k] for k in kept), **left)


def declared(each: Sequence[tuple[int, int] | None]) -> dict[str, Any]:
    """Fields `repeat` and `repeats`: of all where tracks close alike, else of each."""
    if len(set(each)) <= 1:
        return {"repeat": next(iter(each), None), "repeats": ()}
    return {"repeat": None, "repeats": tuple(each)}


#: The names of the six elements, in order.
ELEMENTS = (
    "semi_major_axis",
    "eccentricity",
    "inclination",
    "raan",
    "argument_of_periapsis",
    "mean_anomaly",
)


def check_elements(elements: Mapping[str, NDArray[np.float64]]) -> None:
    """Refuse elements that are no orbits: one row a satellite, finite, closed."""
    size = elements["semi_major_axis"].size
    for name, values in elements.items():
        if values.shape != (size,):
            raise ArgumentError(
                f"{name}: shape {values.shape} for {counted(size, 'satellite')}; give one number "
                "for each"
            )
        if not np.isfinite(values).all():
            raise ArgumentError(
                f"orbital elements: {name} = {values[~np.isfinite(values)][0]}; every element "
                "must be a finite number"
            )
    a, e = elements["semi_major_axis"], elements["eccentricity"]
    if np.any(a <= 0):
        raise ArgumentError(f"semi_major_axis = {a.min()} m: must be positive")
    if np.any((e < 0) | (e >= 1)):
        raise ArgumentError(f"eccentricity = {e[(e < 0) | (e >= 1)][0]}: allowed 0 up to below 1")


def keplerian(
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
    gm: float = MARS_GM.value,
    repeat: tuple[int, int] | None = None,
) -> Constellation:
    """Make a constellation from elements in metres and radians; scalars stand for every satellite.

    `compass.from_elements` is the same in kilometres and degrees.

    Parameters
    ----------
    semi_major_axis, eccentricity, inclination, raan, argument_of_periapsis, mean_anomaly
        Broadcast to a common shape (n,).
    name, epoch, satellite_names, gm, repeat
        As in `Constellation`; satellites without names are numbered.

    Raises
    ------
    ArgumentError
        An element that is not finite, a semi-major axis that is not positive, an eccentricity
        outside [0, 1), names that are too few, too many or used twice.
    """
    given = (
        semi_major_axis,
        eccentricity,
        inclination,
        raan,
        argument_of_periapsis,
        mean_anomaly,
    )
    elements = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, dtype=float)) for x in given))
    names = tuple(satellite_names) or tuple(f"S{k + 1:02d}" for k in range(elements[0].size))
    laid: dict[str, Any] = dict(zip(ELEMENTS, elements, strict=True))
    return Constellation(name, epoch=epoch, satellite_names=names, gm=gm, repeat=repeat, **laid)


def from_pattern(
    pattern: Pattern,
    radius: float,
    *,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
    repeat: tuple[int, int] | None = None,
) -> Constellation:
    """Lay out a symmetric pattern on circular orbits of one radius (metres)."""
    raan, along = pattern.angles()
    return keplerian(
        radius,
        0.0,
        pattern.inclination,
        raan,
        0.0,
        along,
        name=name or pattern.notation,
        epoch=epoch,
        satellite_names=pattern.satellite_names(),
        gm=gm,
        repeat=repeat,
    )

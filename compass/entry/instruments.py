"""What a lander measures beside one-way radio: both ways, height, velocity, surface features."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.kinds import ACCELERATION, BEARING, ECHO, ECHO_RATE, HEIGHT, VELOCITY
from compass.errors import ArgumentError
from compass.frames import direction, latitude_longitude

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """One instrument: its name, the kernels' numbers of what it reads, their unit and meaning."""

    name: str
    numbers: tuple[int, ...]
    unit: str
    title: str


#: All instruments; a further one is a record here and a branch of `compass.core.entry.measure`.
KINDS = (
    Kind("two_way_range", (ECHO,), "m", "range there and back, without the lander's clock"),
    Kind("two_way_rate", (ECHO_RATE,), "m/s", "range rate there and back"),
    Kind("altimeter", (HEIGHT,), "m", "height over the sphere"),
    Kind("velocimeter", tuple(range(VELOCITY, VELOCITY + 3)), "m/s", "velocity over the ground"),
    Kind("features", tuple(range(BEARING, BEARING + 3)), "rad", "directions to surface features"),
    Kind(
        "accelerometers",
        tuple(range(ACCELERATION, ACCELERATION + 3)),
        "m/s^2",
        "accelerations by the air",
    ),
)


@dataclass(frozen=True)
class Instrument:
    """How well one of `KINDS` reads, and when.

    Attributes
    ----------
    kind
        Its name.
    sigma
        One sigma of each number it reads, in its kind's unit.
    share
        One sigma more, as a share of the height (altimeter) or of the speed (velocimeter).
    below
        Metres over the sphere from which on it works.
    interval
        Seconds between readings, a multiple of the time step; of two-way radio that of the ranges.
    """

    kind: str
    sigma: float
    share: float = 0.0
    below: float = float("inf")
    interval: float = 1.0
    names: ClassVar[tuple[str, ...]] = tuple(kind.name for kind in KINDS)

    def __post_init__(self) -> None:
        if self.kind not in self.names:
            raise ArgumentError(f"kind = {self.kind!r}: allowed {', '.join(self.names)}")
        for name in ("sigma", "interval"):
            if not 0 < getattr(self, name) < float("inf"):
                raise ArgumentError(
                    f"{self.kind}: {name} = {getattr(self, name)}: must be positive and finite"
                )
        if not 0 <= self.share < float("inf"):
            raise ArgumentError(f"{self.kind}: share = {self.share}: must be 0 or more")

    @property
    def of_beacons(self) -> bool:
        """Whether it answers to beacons, by radio both ways."""
        return self.kind in ("two_way_range", "two_way_rate")

    @property
    def unit(self) -> str:
        """Unit of what it reads."""
        return KINDS[self.names.index(self.kind)].unit

    @property
    def title(self) -> str:
        """What it reads, in words."""
        return KINDS[self.names.index(self.kind)].title

    @property
    def numbers(self) -> tuple[int, ...]:
        """Kernels' numbers of what it reads."""
        return KINDS[self.names.index(self.kind)].numbers

    def variances(self, path: Array, planet_radius: float) -> Array:
        """Variance of each number it reads at states (..., 6); nan where it does not work."""
        height = np.linalg.norm(path[..., :3], axis=-1) - planet_radius
        size = np.linalg.norm(path[..., 3:], axis=-1) if self.kind == "velocimeter" else height
        variances: Array = self.sigma**2 + (self.share * size) ** 2
        return np.where(height <= self.below, variances, np.nan)


@dataclass(frozen=True)
class Features:
    """Places on the surface that the lander knows by sight.

    Attributes
    ----------
    names
        One a feature.
    latitude, longitude, height
        Radians and metres over the sphere, one a feature.
    """

    names: tuple[str, ...] = ()
    latitude: tuple[float, ...] = ()
    longitude: tuple[float, ...] = ()
    height: tuple[float, ...] = ()

    def places(self, planet_radius: float) -> Array:
        """Mars-fixed, (k, 3), metres."""
        lat, lon = np.array(self.latitude), np.array(self.longitude)
        places: Array = (planet_radius + np.array(self.height))[:, None] * direction(lat, lon)
        return places.reshape(-1, 3)

    def moved(self, planet_radius: float, turn: Array) -> "Features":
        """Return the features turned about the centre by a rotation (3, 3)."""
        at = self.places(planet_radius) @ turn.T
        lat, lon = latitude_longitude(at)
        return replace(self, latitude=tuple(lat.tolist()), longitude=tuple(lon.tolist()))


def in_sight(at: Array, path: Array) -> NDArray[np.bool_]:
    """Whether places (..., k, 3) stand above a lander's horizon along its flight (..., t, 6).

    That is, the lander above theirs; shape (..., t, k).
    """
    line = path[..., :, None, :3] - at[..., None, :, :]
    return np.asarray((line * at[..., None, :, :]).sum(axis=-1) > 0.0)

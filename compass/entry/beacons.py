"""Radio beacons: who transmits, and where they are at any time."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError
from compass.frames import direction, mcmf_from_mci


@dataclass(frozen=True)
class Beacons:
    """Radio beacons over time, in Mars-fixed axes.

    Attributes
    ----------
    names
        One a beacon.
    times
        Seconds, shape (t,).
    r, v
        Position (m) and velocity relative to the rotating planet (m/s), shape (t, n, 3).
    moving
        Whether a beacon orbits, shape (n,).
    masks
        Elevation masks, radians, shape (n,): of the lander over the horizontal of a beacon at
        rest, of an orbiting beacon over the lander's limb; nan for line of sight alone.
    """

    names: tuple[str, ...]
    times: NDArray[np.float64]
    r: NDArray[np.float64]
    v: NDArray[np.float64]
    moving: NDArray[np.bool_]
    masks: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        if not self.masks.size:
            object.__setattr__(self, "masks", np.full(len(self.names), np.nan))
        if self.masks.shape != (len(self.names),):
            raise ArgumentError(f"masks: {self.masks.size} for {len(self.names)} beacons")

    @property
    def size(self) -> int:
        """Number of beacons."""
        return len(self.names)

    @property
    def states(self) -> NDArray[np.float64]:
        """Positions and velocities together, as the kernels take them, (t, n, 6)."""
        return np.concatenate([self.r, self.v], axis=2)

    def with_others(self, other: "Beacons") -> "Beacons":
        """Return these beacons and those of `other` over the same times."""
        if not np.array_equal(self.times, other.times):
            raise ArgumentError("beacons: both sets must be given at the same times")
        return Beacons(
            names=self.names + other.names,
            times=self.times,
            r=np.concatenate([self.r, other.r], axis=1),
            v=np.concatenate([self.v, other.v], axis=1),
            moving=np.concatenate([self.moving, other.moving]),
            masks=np.concatenate([self.masks, other.masks]),
        )

    def above(self, mask: float) -> "Beacons":
        """Return the beacons, all with this elevation mask (radians)."""
        return replace(self, masks=np.full(self.size, mask))

    def chosen(self, index: ArrayLike) -> "Beacons":
        """Return the beacons with these indices (or this mask)."""
        index = np.asarray(index)
        kept = np.arange(self.size)[index if index.size else index.astype(int)]
        return Beacons(
            names=tuple(self.names[k] for k in kept),
            times=self.times,
            r=self.r[:, kept],
            v=self.v[:, kept],
            moving=self.moving[kept],
            masks=self.masks[kept],
        )


def surface_beacons(
    latitude: ArrayLike,
    longitude: ArrayLike,
    times: ArrayLike,
    *,
    planet_radius: float,
    height: ArrayLike = 0.0,
    names: Sequence[str] = (),
) -> Beacons:
    """Beacons at rest on (or over) the sphere of radius `planet_radius`.

    Parameters
    ----------
    latitude, longitude, height
        Radians and metres, broadcast to a common shape (n,).
    times
        Seconds, shape (t,).
    planet_radius
        Metres.
    names
        One a beacon; numbered B1, B2, ... if left out.

    Raises
    ------
    ArgumentError
        A beacon under the surface.
    """
    lat, lon, up = np.broadcast_arrays(*map(np.atleast_1d, (latitude, longitude, height)))
    named = tuple(names) or tuple(f"B{k + 1}" for k in range(lat.size))
    if np.any(up < 0):
        k = int(np.argmin(up))
        raise ArgumentError(
            f"beacon {named[k]}: height = {up[k] / 1e3:g} km: under the surface; must be 0 or more"
        )
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r = (planet_radius + up)[:, None] * direction(lat, lon)
    path = np.repeat(r[None], seconds.size, axis=0)
    return Beacons(named, seconds, path, np.zeros_like(path), np.zeros(lat.size, dtype=bool))


def orbiting_beacons(
    r_mci: ArrayLike,
    v_mci: ArrayLike,
    times: ArrayLike,
    *,
    omega: float,
    angle: float = 0.0,
    planet_radius: float,
    names: Sequence[str] = (),
) -> Beacons:
    """Beacons in orbit, turned from inertial to Mars-fixed axes.

    Parameters
    ----------
    r_mci, v_mci
        Inertial positions (m) and velocities (m/s), shape (n, t, 3), as
        `compass.orbits.states_mci` gives them.
    times
        Seconds, shape (t,).
    omega
        Rotation rate of the Mars-fixed axes, rad/s.
    angle
        Angle from the inertial x axis to the prime meridian at time 0, radians.
    planet_radius
        Metres.
    names
        One a beacon; numbered O1, O2, ... if left out.

    Raises
    ------
    ArgumentError
        A beacon that comes under the surface.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r, v = np.asarray(r_mci, dtype=float), np.asarray(v_mci, dtype=float)
    named = tuple(names) or tuple(f"O{k + 1}" for k in range(r.shape[0]))
    lowest = np.linalg.norm(r, axis=2).min(axis=1, initial=np.inf)
    if np.any(lowest < planet_radius):
        k = int(np.argmin(lowest))
        raise ArgumentError(
            f"beacon {named[k]}: comes down to radius {lowest[k] / 1e3:g} km, under the surface "
            f"({planet_radius / 1e3:g} km), during the entry; give a higher orbit"
        )
    turned = angle + omega * seconds
    spin = np.array([0.0, 0.0, omega])
    fixed_r = mcmf_from_mci(r, turned)
    fixed_v = mcmf_from_mci(v - np.cross(spin, r), turned)
    return Beacons(
        named,
        seconds,
        np.ascontiguousarray(np.moveaxis(fixed_r, 0, 1)),
        np.ascontiguousarray(np.moveaxis(fixed_v, 0, 1)),
        np.ones(r.shape[0], dtype=bool),
    )

"""Radio beacons: where they are, when they are in view, when they are measured."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry_geometry import cartesian_of
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
    """

    names: tuple[str, ...]
    times: NDArray[np.float64]
    r: NDArray[np.float64]
    v: NDArray[np.float64]
    moving: NDArray[np.bool_]

    @property
    def size(self) -> int:
        """Number of beacons."""
        return len(self.names)

    def with_others(self, other: "Beacons") -> "Beacons":
        """Return these beacons and those of `other` over the same times."""
        if not np.array_equal(self.times, other.times):
            raise ArgumentError("beacons: both sets must be given at the same times")
        return Beacons(
            self.names + other.names,
            self.times,
            np.concatenate([self.r, other.r], axis=1),
            np.concatenate([self.v, other.v], axis=1),
            np.concatenate([self.moving, other.moving]),
        )

    def chosen(self, index: ArrayLike) -> "Beacons":
        """Return the beacons with these indices (or this mask)."""
        index = np.asarray(index)
        kept = np.arange(self.size)[index if index.size else index.astype(int)]
        return Beacons(
            tuple(self.names[k] for k in kept),
            self.times,
            self.r[:, kept],
            self.v[:, kept],
            self.moving[kept],
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


def in_view(
    beacons: Beacons, states: ArrayLike, planet_radius: float, mask: float | None = None
) -> NDArray[np.bool_]:
    """Whether the lander is in view of each beacon, shape (t, n).

    Line of sight past the sphere (eqs. 58 to 60 of Yu et al. 2018):
    ``theta < acos(R/|r|) + acos(R/|r_B|)``, theta the central angle; for a beacon on the surface
    that is eq. 52, the lander above its horizon.

    Parameters
    ----------
    beacons
        Beacons at the times of `states`.
    states
        Entry states, shape (t, >= 6).
    planet_radius
        R, metres.
    mask
        Elevation (radians) the lander must have over the horizontal of a beacon at rest, if more
        than line of sight is needed.
    """
    lander = cartesian_of(states)[:, None, :3]
    far_lander = np.linalg.norm(lander, axis=2)
    far_beacon = np.linalg.norm(beacons.r, axis=2)
    cosine = (lander * beacons.r).sum(axis=2) / (far_lander * far_beacon)
    limit = np.arccos(np.minimum(1.0, planet_radius / far_lander)) + np.arccos(
        np.minimum(1.0, planet_radius / far_beacon)
    )
    seen = np.arccos(np.clip(cosine, -1.0, 1.0)) < limit
    if mask is not None:
        line = lander - beacons.r
        length = np.linalg.norm(line, axis=2)
        sine = (line * beacons.r).sum(axis=2) / (far_beacon * np.where(length > 0, length, 1.0))
        seen &= beacons.moving | (sine >= np.sin(mask))
    return seen


def above_horizon(beacons: Beacons, states: ArrayLike) -> NDArray[np.bool_]:
    """Eq. 52 of Yu et al. 2018: the lander stands above each beacon's horizontal, shape (t, n).

    ``arccos(n_B . n_C) < pi/2`` with n_C from beacon to lander, as eq. 51 prints it (the words
    around it say the reverse).
    """
    line = cartesian_of(states)[:, None, :3] - beacons.r
    return (line * beacons.r).sum(axis=2) > 0.0


@dataclass(frozen=True)
class Measurements:
    """What is measured, how well and when.

    Attributes
    ----------
    range_sigma
        One sigma of the range noise, m; None if ranges are not measured.
    rate_sigma
        One sigma of the range-rate noise, m/s; None if rates are not measured.
    interval
        Seconds between measurements, a multiple of the time step.
    start, stop
        Seconds between which measurements are taken; the first at the first epoch from `start` on.
    in_turn
        Whether the lander hears one beacon at a time, in turn, rather than all at once.
    """

    range_sigma: float | None = 50.0
    rate_sigma: float | None = None
    interval: float = 1.0
    start: float = 0.0
    stop: float = float("inf")
    in_turn: bool = False

    def __post_init__(self) -> None:
        for name, unit in (("range_sigma", "m"), ("rate_sigma", "m/s")):
            sigma = getattr(self, name)
            if sigma is not None and not 0 < sigma < float("inf"):
                raise ArgumentError(f"{name} = {sigma} {unit}: must be positive")
        if self.range_sigma is None and self.rate_sigma is None:
            raise ArgumentError("measurements: give range_sigma, rate_sigma or both")
        if not self.interval > 0:
            raise ArgumentError(f"interval = {self.interval} s: must be positive")

    def taken(self, seen: NDArray[np.bool_], times: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which beacons in view are measured, shape (t, n), given `seen` of that shape.

        In turn, the k-th measurement time goes to the next beacon in view after the last heard.
        """
        due = (times >= self.start - 1e-9) & (times <= self.stop + 1e-9)
        since = times - times[due].min() if due.any() else times
        due &= np.abs(np.mod(since / self.interval + 0.5, 1.0) - 0.5) * self.interval < 1e-6
        taken = seen & due[:, None]
        if self.in_turn and seen.shape[1]:
            heard = -1
            for row in taken:  # a few hundred rows; each depends on the one before
                order = (heard + 1 + np.arange(row.size)) % row.size
                ready = order[row[order]]
                row[:] = False
                if ready.size:
                    heard = int(ready[0])
                    row[heard] = True
        return taken


def check_apart(beacons: Beacons, states: ArrayLike) -> None:
    """Refuse beacons at the lander's place, where the direction is undefined.

    Raises
    ------
    ArgumentError
        A beacon within a metre of the trajectory.
    """
    distance = np.linalg.norm(cartesian_of(states)[:, None, :3] - beacons.r, axis=2)
    if distance.size and distance.min() < 1.0:
        t, k = np.unravel_index(int(distance.argmin()), distance.shape)
        raise ArgumentError(
            f"beacon {beacons.names[k]}: at the lander's own place at {beacons.times[t]:g} s "
            f"({distance[t, k]:.3g} m apart); its direction is undefined, move it"
        )

"""Room in the slots: how far satellites may still stray from their pattern, at every moment.

If every satellite stands within ``lambda(r_i) - lambda_min`` of a slot of the pattern, turned and
advanced as a whole in any way, coverage holds: a cap of radius lambda about the satellite contains
one of radius lambda less that angle about the slot, and such caps about the slots cover. Positive
room is a proof for its moment; negative room is none of the contrary.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.slots import rooms
from compass.coverage.cap import cap_radius
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.orbits.trajectory import Trajectory

#: Inclination, radians, below which node and argument of latitude are not told apart.
FLAT = 0.02


@dataclass(frozen=True)
class Room:
    """Room in the slots and where the satellites stand in them, at moments.

    Attributes
    ----------
    times
        Seconds after the epoch, shape (t,).
    room
        Radians, shape (t,).
    along, across, radial
        Misses of the slots along and across the track, radians, and above the pattern's radius,
        m; shape (t, n).
    """

    times: NDArray[np.float64]
    room: NDArray[np.float64]
    along: NDArray[np.float64]
    across: NDArray[np.float64]
    radial: NDArray[np.float64]


@dataclass(frozen=True)
class SlotBox:
    """How far a satellite may leave its slot alone: any one of them to the full.

    Attributes
    ----------
    sideways
        Angle along or across the track, radians.
    radial
        Below the pattern's radius, m.
    """

    sideways: float
    radial: float


def has_slots(constellation: Constellation) -> bool:
    """Whether all orbits are circles of one radius and inclination, so that slots turn as one."""
    c = constellation
    return bool(
        c.size
        and c.is_circular
        and np.ptp(c.semi_major_axis) <= 1e-9 * c.semi_major_axis[0]
        and np.ptp(c.inclination) <= 1e-9
    )


def room_in_slots(
    pattern: Constellation,
    path: Trajectory,
    times: ArrayLike,
    *,
    covering: float,
    sphere_radius: float,
    mask: float = 0.0,
) -> Room:
    """Room at moments: the greatest over turns and phases of the least spare cap less miss.

    Parameters
    ----------
    pattern
        The nominal constellation, whose elements are the slots.
    path
        Where its satellites really are, in the same order.
    times
        Seconds after the epoch, shape (t,).
    covering
        Least cap radius with which the pattern covers, radians.
    sphere_radius, mask
        Metres and radians.

    Raises
    ------
    ArgumentError
        A pattern whose orbits differ in radius or inclination.
    """
    if not has_slots(pattern):
        raise ArgumentError(
            "room in the slots: needs circular orbits of one radius and inclination; look at the "
            "margin instead"
        )
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r, v = (np.moveaxis(a, 0, 1) for a in path.states(seconds))
    distance = np.linalg.norm(r, axis=-1)
    directions = np.ascontiguousarray(r / distance[..., None])
    spare = np.ascontiguousarray(cap_radius(distance, sphere_radius, mask) - covering)
    arguments = pattern.argument_of_periapsis + pattern.mean_anomaly
    inclination = float(pattern.inclination[0])
    turns, phases = _first_guess(r, v, pattern.raan, arguments, inclination)
    misses = np.empty((seconds.size, pattern.size, 2))
    found = rooms(
        np.array(pattern.raan), inclination, arguments, directions, spare, turns, phases, misses
    )
    return Room(
        seconds,
        np.asarray(found),
        misses[..., 0],
        misses[..., 1],
        distance - float(pattern.semi_major_axis[0]),
    )


def slot_box(radius: float, covering: float, sphere_radius: float, mask: float = 0.0) -> SlotBox:
    """Box of a slot: ``sqrt(x^2 + y^2) + lambda(a) - lambda(a - z) <= lambda(a) - lambda_min``.

    Parameters
    ----------
    radius, covering, sphere_radius, mask
        Radius a of the orbits, m; lambda_min, radians; m; radians.
    """
    spare = float(cap_radius(radius, sphere_radius, mask)) - covering
    lowest = sphere_radius * np.cos(mask) / np.cos(covering + mask)
    return SlotBox(spare, float(radius - lowest))


def _first_guess(
    r: NDArray[np.float64],
    v: NDArray[np.float64],
    nodes: NDArray[np.float64],
    arguments: NDArray[np.float64],
    inclination: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn about the pole and phase, from the mean shifts of nodes and arguments of latitude."""

    def mean(angles: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.angle(np.exp(1j * angles).mean(axis=-1)))

    if min(inclination, np.pi - inclination) < FLAT:
        way = 1.0 if inclination < 1.0 else -1.0
        shift = mean(np.arctan2(r[..., 1], r[..., 0]) - nodes - way * arguments)
        return shift, np.zeros_like(shift)
    pole = np.cross(r, v)
    node = np.arctan2(pole[..., 0], -pole[..., 1])
    to_node = np.stack([np.cos(node), np.sin(node), np.zeros_like(node)], axis=-1)
    ahead = np.cross(pole / np.linalg.norm(pole, axis=-1, keepdims=True), to_node)
    latitude_argument = np.arctan2((r * ahead).sum(axis=-1), (r * to_node).sum(axis=-1))
    return mean(node - nodes), mean(latitude_argument - arguments)

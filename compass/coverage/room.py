"""Room in the slots: how far satellites may still stray from their pattern, at every moment.

If every satellite stands within ``lambda(r_i) - lambda_min`` of a slot of the pattern, turned and
advanced as a whole in any way, coverage holds: a cap of radius lambda about the satellite contains
one of radius lambda less that angle about the slot, and such caps about the slots cover. Positive
room is a proof for its moment; negative room is none of the contrary.

How the pattern may be turned depends on where coverage is wanted: in any way for the whole sphere,
about the pole for a belt of latitude. Places that turn with Mars see a pattern of closed tracks as
it is at some time of its own, and nothing is free but that time; without closed tracks what they
have is what all on their latitudes have.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.slots import rooms
from compass.coverage.cap import cap_radius
from compass.coverage.inner_cap import inner_cap_radius
from compass.coverage.margin import covering_radius, highest_mask
from compass.coverage.region import GLOBE, Region, latitude_band
from compass.coverage.symmetry import shortest_span
from compass.errors import ArgumentError
from compass.orbits import Constellation, repeat_period
from compass.orbits.trajectory import Trajectory

#: Inclination, radians, below which node and argument of latitude are not told apart.
FLAT = 0.02

#: Latitudes of a pattern at which an ellipsoid's caps are looked at, radians apart.
STEP = np.radians(1.0)


@dataclass(frozen=True)
class Slots:
    """A pattern's slots, and how large caps about them cover where coverage is wanted.

    Attributes
    ----------
    pattern
        The nominal constellation, whose elements are the slots.
    covering
        Least cap radius with which it covers, radians; infinite where none does.
    region
        Where; one that turns with Mars only for closed tracks.
    repeat, closure
        Time after which those close, s, and the angle by which they miss, radians.
    """

    pattern: Constellation
    covering: float
    region: Region = GLOBE
    repeat: float = np.inf
    closure: float = 0.0

    @property
    def cover(self) -> bool:
        """Whether caps of some size about them cover at all."""
        return bool(np.isfinite(self.covering))

    @property
    def ways(self) -> NDArray[np.float64]:
        """Small turns and phases that are free, shape (m, 4): about x, y and the pole, phase."""
        if self.region.is_globe:
            return np.eye(4)
        if not self.region.mars_fixed:
            return np.eye(4)[2:]
        return np.array([[0.0, 0.0, -_SPIN / float(self.pattern.mean_motion[0]), 1.0]])

    def box(self, sphere_radius: float, mask: float, stretch: float = 1.0) -> "SlotBox":
        """How far a satellite may leave its slot, as `slot_box`."""
        return slot_box(self.pattern, self.covering, sphere_radius, mask, stretch)


#: Rotation of Mars, rad/s.
_SPIN = MARS_ROTATION_RATE.value


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


def slots_for(pattern: Constellation, fold: int, region: Region = GLOBE) -> Slots:
    """Slots of a pattern and the least caps with which they cover a region, proven.

    Parameters
    ----------
    pattern
        Of orbits that form slots.
    fold
        Satellites wanted in view at once.
    region
        One that turns with Mars counts as itself where tracks are declared closed, else as its
        belt of latitude.

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
    if region.is_globe:
        return Slots(pattern, covering_radius(pattern, fold, tolerance=1e-5).radius)
    if region.mars_fixed and pattern.repeat is None:
        region = latitude_band(*region.latitudes())
    span = shortest_span(pattern, region)
    # of which sphere is no matter: caps are angles at the centre
    radius = float(pattern.semi_major_axis[0])
    sphere = 0.1 * radius
    mask = highest_mask(
        pattern, fold, sphere_radius=sphere, region=region, span=span, tolerance=1e-5
    )
    covering = np.inf if mask is None else float(cap_radius(radius, sphere, mask))
    if not region.mars_fixed:
        return Slots(pattern, covering, region)
    return Slots(pattern, covering, region, span.stop, repeat_period(pattern).closure)


def covering_slots(pattern: Constellation, fold: int, region: Region = GLOBE) -> Slots | None:
    """Slots of a pattern; None where its orbits form none, or no caps about them cover a region."""
    if not has_slots(pattern):
        return None
    slots = slots_for(pattern, fold, region)
    return slots if slots.cover else None


def room_in_slots(
    slots: Slots,
    path: Trajectory,
    times: ArrayLike,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    stretch: float = 1.0,
) -> Room:
    """Room at moments: the greatest over turns and phases of the least spare cap less miss.

    Parameters
    ----------
    slots
        The pattern and where it is to cover.
    path
        Where its satellites really are, in the same order.
    times
        Seconds after the epoch, shape (t,).
    sphere_radius, mask, stretch
        Metres and radians; ratio of the equatorial radius to the polar one: on an ellipsoid caps
        are the largest in which all users see a satellite.
    """
    pattern = slots.pattern
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r, v = (np.moveaxis(a, 0, 1) for a in path.states(seconds))
    distance = np.linalg.norm(r, axis=-1)
    directions = np.ascontiguousarray(r / distance[..., None])
    latitudes = np.arcsin(np.clip(directions[..., 2], -1.0, 1.0))
    caps = inner_cap_radius(distance, latitudes, sphere_radius, mask, stretch)
    spare = np.ascontiguousarray(caps - slots.covering)
    arguments = pattern.argument_of_periapsis + pattern.mean_anomaly
    inclination = float(pattern.inclination[0])
    turns, phases = _first_guess(r, v, pattern.raan, arguments, inclination)
    if slots.region.mars_fixed:
        turns, phases = _own_time(seconds, phases, pattern)
    misses = np.empty((seconds.size, pattern.size, 2))
    room = np.asarray(
        rooms(
            np.array(pattern.raan),
            inclination,
            arguments,
            directions,
            spare,
            turns,
            phases,
            slots.ways,
            misses,
        )
    )
    if slots.region.mars_fixed:
        # caps were found over one repeat of the tracks; each further one misses by the closure
        repeats = np.abs(np.floor(phases / float(pattern.mean_motion[0]) / slots.repeat))
        room = room - slots.closure * repeats
    above = distance - float(pattern.semi_major_axis[0])
    return Room(seconds, room, misses[..., 0], misses[..., 1], above)


def slot_box(
    pattern: Constellation,
    covering: float,
    sphere_radius: float,
    mask: float = 0.0,
    stretch: float = 1.0,
) -> SlotBox:
    """Box of a slot: ``sqrt(x^2 + y^2) + lambda(a) - lambda(a - z) <= lambda(a) - lambda_min``.

    On an ellipsoid lambda is the least of the largest caps over all latitudes that the pattern's
    satellites reach, looked at `STEP` apart. A radian of latitude leans the figure's normal by
    ``f = stretch^2 - 1`` at most and changes heights by no more than a share f of the radius, each
    metre h of which is ``cot(lambda) / r`` of a cap: together f (1 + cot(lambda)).

    Parameters
    ----------
    pattern
        Of circular orbits of radius a.
    covering, sphere_radius, mask, stretch
        lambda_min, radians; m; radians; ratio of the equatorial radius to the polar one.
    """
    radius = float(pattern.semi_major_axis[0])
    if stretch == 1.0:
        spare = float(cap_radius(radius, sphere_radius, mask)) - covering
        lowest = sphere_radius * np.cos(mask) / np.cos(covering + mask)
        return SlotBox(spare, float(radius - lowest))
    tilt = float(pattern.inclination[0])
    reach = min(tilt, np.pi - tilt)
    latitudes = np.linspace(0.0, reach, int(np.ceil(reach / STEP)) + 1)

    def cap(distance: float) -> float:
        caps = inner_cap_radius(distance, latitudes, sphere_radius, mask, stretch)
        least = float(caps.min())
        if least <= 0.0:
            return 0.0
        return least - 0.5 * STEP * (stretch**2 - 1.0) * (1.0 + 1.0 / np.tan(min(least, 1.57)))

    spare = cap(radius) - covering
    low, high = (sphere_radius + 1.0, radius) if spare >= 0.0 else (radius, 100.0 * radius)
    while high - low > 100.0:  # metres
        middle = 0.5 * (low + high)
        low, high = (low, middle) if cap(middle) >= covering else (middle, high)
    return SlotBox(spare, radius - high)


def _own_time(
    seconds: NDArray[np.float64], phases: NDArray[np.float64], pattern: Constellation
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn and phase of the pattern at the time of its own that is nearest and has a phase.

    At the time tau, seen from Mars, it stands as it does now turned by ``w (t - tau)``.
    """
    motion = float(pattern.mean_motion[0])
    now = motion * seconds
    if not _is_flat(float(pattern.inclination[0])):
        now = now + np.angle(np.exp(1j * (phases - now)))
    return _SPIN * (seconds - now / motion), now


def _is_flat(inclination: float) -> bool:
    """Whether node and argument of latitude are not told apart."""
    return min(inclination, np.pi - inclination) < FLAT


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

    if _is_flat(inclination):
        way = 1.0 if inclination < 1.0 else -1.0
        shift = mean(np.arctan2(r[..., 1], r[..., 0]) - nodes - way * arguments)
        return shift, np.zeros_like(shift)
    pole = np.cross(r, v)
    node = np.arctan2(pole[..., 0], -pole[..., 1])
    to_node = np.stack([np.cos(node), np.sin(node), np.zeros_like(node)], axis=-1)
    ahead = np.cross(pole / np.linalg.norm(pole, axis=-1, keepdims=True), to_node)
    latitude_argument = np.arctan2((r * ahead).sum(axis=-1), (r * to_node).sum(axis=-1))
    return mean(node - nodes), mean(latitude_argument - arguments)

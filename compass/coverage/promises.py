"""How long what a design wants is kept along real paths, and the room its slots leave for that."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.claims import Claim, claims_of
from compass.coverage.fold_verdict_over_days import claim_lasts, not_followed
from compass.coverage.lasting import Lasting
from compass.coverage.room import (
    Room,
    SlotBox,
    Slots,
    has_slots,
    room_in_slots,
    slot_box,
    slots_for,
)
from compass.design import Design, Requirement
from compass.orbits import Constellation
from compass.orbits.trajectory import Trajectory


@dataclass(frozen=True)
class Promise:
    """What became of a requirement, at the place that loses it first.

    Attributes
    ----------
    requirement
        What is wanted.
    place
        Where it is lost first, or proven for the least time.
    lasting
        How long it is proven there; None if it was not followed.
    room
        Room in the slots at moments, radians, the least of all places; None without slots.
    box
        How far a satellite may leave its slot, the least of all places; None likewise.
    reason
        Why it was not followed; empty if it was.
    """

    requirement: Requirement
    place: str = ""
    lasting: Lasting | None = None
    room: NDArray[np.float64] | None = None
    box: SlotBox | None = None
    reason: str = ""


def promises_of(
    design: Design,
    path: Trajectory,
    times: NDArray[np.float64],
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> tuple[Promise, ...]:
    """Follow every requirement of a design along paths, between the first and the last moment.

    Parameters
    ----------
    design
        Whose pattern is the slots.
    path
        What its satellites do.
    times
        Moments at which room is given, seconds after the epoch.
    progress
        Wraps the list of requirements, as tqdm does.
    """
    return tuple(_follow(design, each, path, times) for each in progress(design.requirements))


def _follow(
    design: Design, requirement: Requirement, path: Trajectory, times: NDArray[np.float64]
) -> Promise:
    """Follow one requirement: the place that is lost first, and the least room."""
    if reason := not_followed(design, requirement):
        return Promise(requirement, reason=reason)
    fold = requirement.fold
    assert fold is not None
    start, stop = float(times[0]), float(times[-1])
    claims = claims_of(design, requirement)
    found = [(claim_lasts(path, fold, claim, start, stop), claim) for claim in claims]
    lasting, claim = min(found, key=lambda one: one[0].proven_until)
    c = design.constellation
    flat = any(each.stretch != 1.0 for each in claims)  # room is known on spheres only
    if not has_slots(c) or c.size < fold or flat:
        return Promise(requirement, claim.name, lasting)
    slots = [slots_for(c, fold, each.region) for each in claims]
    if not all(each.cover for each in slots):
        return Promise(requirement, claim.name, lasting)
    pairs = list(zip(slots, claims, strict=True))
    room = np.min([_room(s, each, path, times).room for s, each in pairs], axis=0)
    boxes = [_box(c, s, each) for s, each in pairs]
    box = min(boxes, key=lambda one: one.sideways)
    return Promise(requirement, claim.name, lasting, room, box)


def _room(slots: Slots, claim: Claim, path: Trajectory, times: NDArray[np.float64]) -> Room:
    return room_in_slots(slots, path, times, sphere_radius=claim.radius, mask=claim.highest)


def _box(c: Constellation, slots: Slots, claim: Claim) -> SlotBox:
    radius = float(c.semi_major_axis[0])
    return slot_box(radius, slots.covering, claim.radius, claim.highest)

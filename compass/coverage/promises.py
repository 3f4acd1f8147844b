"""How long what a design wants is kept along real paths, and the room its slots leave for that."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.claims import claims_of
from compass.coverage.fold_verdict_over_days import claim_lasts, not_followed
from compass.coverage.lasting import Lasting
from compass.coverage.room import SlotBox, covering_slots, room_in_slots
from compass.design import Design, Requirement
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
    followed = Promise(requirement, claim.name, lasting)
    if any(each.stretch != 1.0 for each in claims):  # room is known on spheres only
        return followed
    rooms, boxes = [], []
    for each in claims:
        slots = covering_slots(design.constellation, fold, each.region)
        if slots is None:
            return followed
        on = {"sphere_radius": each.radius, "mask": each.highest}
        rooms.append(room_in_slots(slots, path, times, **on).room)
        boxes.append(slots.box(**on))
    box = min(boxes, key=lambda one: one.sideways)
    return replace(followed, room=np.min(rooms, axis=0), box=box)

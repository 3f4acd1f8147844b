"""How long what a design wants is kept along real paths, and the room its slots leave for that."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certificate import Outcome
from compass.coverage.claims import Claim, claims_of
from compass.coverage.fold_verdict_over_days import claim_lasts, followed_as_caps
from compass.coverage.geometry_over_days import GeometryLasting, geometry_lasts
from compass.coverage.lasting import Lasting
from compass.coverage.room import SlotBox, Slots, covering_slots, room_in_slots
from compass.coverage.verdict import EvidenceKind
from compass.design import Design
from compass.orbits.trajectory import Trajectory
from compass.requirement import Requirement
from compass.words import latitude_words


@dataclass(frozen=True)
class Promise:
    """What became of a requirement, at the place that loses it first.

    Attributes
    ----------
    requirement
        What is wanted.
    claim
        The place where its satellites in view are lost first, or proven for the least time.
    lasting
        How long they are proven there; None if none are wanted.
    geometry
        How long its dilutions of precision, errors and levels are kept, and satellites in view
        that are no caps' (in beams, above satellites or an ellipsoid, for a share); None if none
        are wanted.
    room
        Room in the slots at moments, radians, the least of all places; None without slots.
    box
        How far a satellite may leave its slot, the least of all places; None likewise.
    """

    requirement: Requirement
    claim: Claim | None = None
    lasting: Lasting | None = None
    geometry: GeometryLasting | None = None
    room: NDArray[np.float64] | None = None
    box: SlotBox | None = None

    @property
    def decides(self) -> Lasting | GeometryLasting:
        """What is lost first of it, or proven for the least time."""
        known = [one for one in (self.lasting, self.geometry) if one is not None]
        return min(known, key=lambda one: one.proven_until)

    @property
    def outcome(self) -> Outcome:
        """Lost if one of its parts is, else proven if all are."""
        found = {one.outcome for one in (self.lasting, self.geometry) if one is not None}
        order = (Outcome.REFUTED, Outcome.UNDECIDED, Outcome.PROVEN)
        return next(outcome for outcome in order if outcome in found)

    @property
    def evidence(self) -> EvidenceKind:
        """How sure it is: what is least sure of its parts."""
        known: list[EvidenceKind] = [] if self.lasting is None else ["proven"]
        if self.geometry is not None:
            known.append(self.geometry.verdict.evidence)
        return max(known, key=get_args(EvidenceKind).index)

    @property
    def first_loss_days(self) -> float | None:
        """Days after the epoch at which it is lost; None if it is not."""
        losses = (one.first_loss_days for one in (self.lasting, self.geometry) if one is not None)
        return min((day for day in losses if day is not None), default=None)

    @property
    def place(self) -> str:
        """Where it is lost first, or proven for the least time."""
        if self.decides is self.lasting:
            return "" if self.claim is None else self.claim.name
        if self.geometry is None or (worst := self.geometry.verdict.worst) is None:
            return ""
        if (site := self.geometry.verdict.site) is not None:
            return site.name
        return latitude_words(float(np.degrees(worst.latitude)), ".2f")


def promises_of(
    design: Design,
    path: Trajectory,
    start: float,
    stop: float,
    progress: Callable[[str, float], None] = lambda name, part: None,
) -> tuple[Promise, ...]:
    """Follow every requirement of a design along paths, from `start` to `stop`.

    Parameters
    ----------
    design
        Who wants what where.
    path
        What its satellites do.
    start, stop
        Seconds after the epoch.
    progress
        Called with the name of what is followed, and the part of all that is gone, 0 to 1.
    """
    found: list[Promise] = []
    for each in design.requirements:

        def told(part: float, name: str = each.name) -> None:
            progress(name, (len(found) + part) / len(design.requirements))

        told(0.0)
        found.append(_follow(design, each, path, start, stop, told))
    return tuple(found)


@dataclass(frozen=True)
class Lead:
    """The place that is lost first, and what is wanted there.

    Attributes
    ----------
    fold
        Satellites that are to be in view.
    claim
        The place.
    lasting
        How long they are there.
    asked
        Whether a requirement wants them always; else margins alone are of them.
    """

    fold: int
    claim: Claim
    lasting: Lasting
    asked: bool = True


def lead_of(
    design: Design, promises: Sequence[Promise], path: Trajectory, start: float, stop: float
) -> Lead:
    """Who loses satellites first; where no requirement wants them always, of the design's fold."""
    found = [
        Lead(fold, each.claim, each.lasting)
        for each in promises
        if each.claim is not None
        and each.lasting is not None
        and (fold := in_view(each.requirement)) is not None
    ]
    if not found:
        places = [claim for each in promises for claim in claims_of(design, each.requirement)]
        fold = design.fold
        found = [
            Lead(fold, claim, claim_lasts(path, fold, claim, start, stop), asked=False)
            for claim in places
        ]
    return min(found, key=lambda one: one.lasting.proven_until)


def with_rooms(
    promises: Sequence[Promise], design: Design, path: Trajectory, times: NDArray[np.float64]
) -> tuple[Promise, ...]:
    """Add the room that slots leave at moments, seconds after the epoch, where it is known."""
    return tuple(_with_room(each, design, path, times) for each in promises)


def box_of(design: Design) -> SlotBox | None:
    """How far a satellite may leave its slot with all satellites still in view that are wanted.

    The least of all places of all requirements that want satellites always; None where none does
    or slots are not known to cover one of its places.
    """
    boxes = []
    for each in design.requirements:
        if each.fold is None or each.share < 1.0:
            continue
        known = _slots(design, each)
        if known is None:
            return None
        boxes += [_box(slots, claim) for claim, slots in known]
    return min(boxes, key=lambda one: one.sideways, default=None)


def in_view(requirement: Requirement) -> int | None:
    """Satellites that are to be in view for a requirement: those wanted, and those to be lost."""
    return None if requirement.fold is None else requirement.fold + requirement.losses


def _follow(
    design: Design,
    requirement: Requirement,
    path: Trajectory,
    start: float,
    stop: float,
    progress: Callable[[float], None],
) -> Promise:
    """Follow one requirement: the place that is lost first."""
    asked = replace(requirement, fold=requirement.counts)
    if asked.fold is not None and not followed_as_caps(design, asked):
        boxed = geometry_lasts(design, asked, path, start, stop, progress)
        return Promise(requirement, geometry=boxed)
    lasting, claim, geometry = None, None, None
    if (fold := in_view(asked)) is not None:
        found = [(claim_lasts(path, fold, c, start, stop), c) for c in claims_of(design, asked)]
        lasting, claim = min(found, key=lambda one: one[0].proven_until)
    if asked.limits:
        until = stop if lasting is None else max(lasting.proven_until, start + 1.0)
        bare = replace(asked, fold=None)
        geometry = geometry_lasts(design, bare, path, start, until, progress)
    return Promise(requirement, claim, lasting, geometry)


def _slots(design: Design, requirement: Requirement) -> list[tuple[Claim, Slots]] | None:
    """Slots that cover each place of a requirement; None where one has none."""
    fold, found = in_view(requirement), []
    assert fold is not None
    if requirement.beam is not None:
        return None
    for claim in claims_of(design, requirement):
        slots = covering_slots(design.constellation, fold, claim.region)
        if slots is None:
            return None
        found.append((claim, slots))
    return found


def _box(slots: Slots, claim: Claim) -> SlotBox:
    return slots.box(claim.radius, claim.highest, claim.stretch)


def _with_room(
    promise: Promise, design: Design, path: Trajectory, times: NDArray[np.float64]
) -> Promise:
    if promise.lasting is None or (known := _slots(design, promise.requirement)) is None:
        return promise
    rooms = [
        room_in_slots(
            slots,
            path,
            times,
            sphere_radius=claim.radius,
            mask=claim.highest,
            stretch=claim.stretch,
        ).room
        for claim, slots in known
    ]
    box = min((_box(slots, claim) for claim, slots in known), key=lambda one: one.sideways)
    return replace(promise, room=np.min(rooms, axis=0), box=box)

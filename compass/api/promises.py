"""What becomes of a design's requirements along real paths, as JSON and as blocks."""

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.lasting import Lasting
from compass.coverage.promises import Promise
from compass.coverage.room import SlotBox
from compass.document import Sentence, Table, Value, Verdict
from compass.document.blocks import Block
from compass.quantities import quantity

#: Figures of a requirement in the table.
_FIGURES = ("days_proven", "first_loss_days", "room_deg", "slot_sideways_deg")


def followed(promises: Sequence[Promise]) -> list[Lasting]:
    """How long those requirements last that could be followed."""
    return [each.lasting for each in promises if each.lasting is not None]


def box_dict(box: SlotBox | None) -> dict[str, float] | None:
    """Plain values of a slot box."""
    if box is None:
        return None
    return {"sideways_deg": degrees(box.sideways), "radial_km": box.radial / 1e3}


def promise_dict(promise: Promise) -> dict[str, Any]:
    """Plain values of what became of a requirement."""
    lasting, room = promise.lasting, promise.room
    return {
        "name": promise.requirement.name,
        "wanted": promise.requirement.claim,
        "place": promise.place,
        "outcome": None if lasting is None else lasting.outcome,
        "days_proven": None if lasting is None else lasting.days_proven,
        "first_loss_days": None if lasting is None else lasting.first_loss_days,
        "room_deg": None if room is None else np.degrees(room).tolist(),
        "slot_box": box_dict(promise.box),
        "reason": promise.reason,
    }


def promise_blocks(promises: Sequence[Promise]) -> list[Block]:
    """How long each requirement is proven, where it is lost first, the room that it leaves."""
    if not promises:
        return []
    wanted = followed(promises)
    lost = sum(one.outcome is Outcome.REFUTED for one in wanted)
    proven = sum(one.outcome is Outcome.PROVEN for one in wanted)
    holds = False if lost else True if wanted and proven == len(wanted) else None
    word = {True: "kept", False: "lost", None: "undecided"}[holds]
    told = (
        f"{len(promises)} requirement(s): {proven} proven for the whole span, {lost} lost, "
        f"{len(promises) - len(wanted)} not followed"
    )
    header = ("", "wanted", "first lost at", *(quantity(name).heading for name in _FIGURES))
    return [
        Verdict(word, told, holds),
        Table("Requirements, left alone", header, tuple(_row(each) for each in promises)),
        *(
            Sentence(f"{each.requirement.name} is not followed: {each.reason}")
            for each in promises
            if each.reason
        ),
        Sentence(
            "room: the least of the span; places that turn with Mars are given it at one time of "
            "the pattern's own where its tracks are declared closed, else as all on their "
            "latitudes have it"
        ),
    ]


def _row(promise: Promise) -> tuple[str | Value, ...]:
    lasting, room, box = promise.lasting, promise.room, box_dict(promise.box)
    values = (
        None if lasting is None else lasting.days_proven,
        None if lasting is None else lasting.first_loss_days,
        None if room is None else degrees(float(room.min())),
        None if box is None else box["sideways_deg"],
    )
    figures = (Value(quantity(n), v) for n, v in zip(_FIGURES, values, strict=True))
    return (promise.requirement.name, promise.requirement.wanted, promise.place, *figures)

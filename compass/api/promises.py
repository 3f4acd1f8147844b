"""What becomes of a design's requirements along real paths, as JSON and as blocks."""

from collections import Counter
from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.geometry_over_days import STRETCH
from compass.coverage.promises import Promise
from compass.coverage.room import SlotBox
from compass.coverage.verdict import sure
from compass.document import Sentence, Table, Value, Verdict
from compass.document.blocks import Block
from compass.frames import SECONDS_PER_DAY
from compass.quantities import quantity
from compass.words import counted, latitude_words

#: Figures of a requirement in the table.
_FIGURES = ("days_proven", "first_loss_days", "room_deg", "slot_sideways_deg")

#: What the outcome of requirements is called, and whether all are kept.
_WORDS = {
    Outcome.PROVEN: ("kept", True),
    Outcome.REFUTED: ("lost", False),
    Outcome.UNDECIDED: ("undecided", None),
}

#: What room is.
_ROOM = (
    "room: the least of the span; places that turn with Mars are given it at one time of "
    "the pattern's own where its tracks are declared closed, else as all on their latitudes have it"
)


def box_dict(box: SlotBox | None) -> dict[str, float] | None:
    """Plain values of a slot box."""
    if box is None:
        return None
    return {"sideways_deg": degrees(box.sideways), "radial_km": box.radial / 1e3}


def promise_dict(promise: Promise) -> dict[str, Any]:
    """Plain values of what became of a requirement."""
    decides, room = promise.decides, promise.room
    return {
        "name": promise.requirement.name,
        "wanted": promise.requirement.claim,
        "place": promise.place,
        "outcome": promise.outcome,
        "days_proven": decides.days_proven,
        "first_loss_days": promise.first_loss_days,
        "share": _share(promise),
        "evidence": promise.evidence,
        "room_deg": None if room is None else np.degrees(room).tolist(),
        "slot_box": box_dict(promise.box),
    }


def outcome_of(promises: Sequence[Promise]) -> Outcome:
    """Lost if one is, proven (or kept by samples) if all are."""
    found = {each.outcome for each in promises}
    if Outcome.REFUTED in found:
        return Outcome.REFUTED
    return Outcome.PROVEN if found == {Outcome.PROVEN} else Outcome.UNDECIDED


def promise_blocks(promises: Sequence[Promise]) -> list[Block]:
    """How long each requirement is proven, where it is lost first, the room that it leaves."""
    if not promises:
        return []
    kinds = [
        "lost" if one.outcome is Outcome.REFUTED
        else "undecided" if one.outcome is Outcome.UNDECIDED
        else "kept for the whole span by samples" if one.evidence == "sampled"
        else "proven for the whole span"
        for one in promises
    ]  # fmt: skip
    word, holds = _WORDS[outcome_of(promises)]
    told = ", ".join(f"{number} {kind}" for kind, number in Counter(kinds).items())
    told = f"{counted(len(promises), 'requirement')}: {told}"
    room = [Sentence(_ROOM)] if any(each.room is not None for each in promises) else []
    return [
        Verdict(word, told, holds),
        promise_table([promise_dict(each) for each in promises]),
        *(Sentence(said) for each in promises if (said := _geometry(each))),
        *room,
    ]


def promise_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Requirements as `promise_dict` has them: how long each is proven, and where it is lost."""
    figures = (quantity(name).heading for name in _FIGURES[1:])
    header = ("", "wanted", "evidence", "first lost at", "kept for, days", *figures)
    return Table("Requirements, and how long they last", header, tuple(_row(each) for each in rows))


def _row(row: dict[str, Any]) -> tuple[str | Value, ...]:
    room, box = row["room_deg"], row["slot_box"]
    values = (
        row["days_proven"],
        row["first_loss_days"],
        None if room is None else min(room),
        None if box is None else box["sideways_deg"],
    )
    figures = (Value(quantity(n), v) for n, v in zip(_FIGURES, values, strict=True))
    place = "" if row["outcome"] == Outcome.PROVEN.value else row["place"]
    return (row["name"], row["wanted"], sure(row["evidence"]), place, *figures)


def _share(promise: Promise) -> list[float] | None:
    """Bounds of the share with good geometry in the stretch that was looked at last."""
    geometry = promise.geometry
    if geometry is None or geometry.verdict.share is None:
        return None
    return list(geometry.verdict.share)


def _geometry(promise: Promise) -> str:
    """How its geometry was settled, and what was found where that ended; empty if none."""
    geometry = promise.geometry
    if geometry is None:
        return ""
    name, share, worst = promise.requirement.name, _share(promise), geometry.verdict.worst
    always, sampled = promise.requirement.share == 1.0, geometry.verdict.evidence == "sampled"
    days = f"in stretches of up to {STRETCH / SECONDS_PER_DAY:g} days"
    how = "by random samples" if sampled else "by proven bounds"
    said = f"{name}: looked at {'over the whole span' if always and sampled else days} {how}"
    said += ", always" if always else ", a share of each"
    begin = geometry.proven_until / SECONDS_PER_DAY
    if geometry.outcome is Outcome.UNDECIDED:
        return f"{said}; open from day {begin:.5g}: {geometry.verdict.reason}"
    if geometry.lost_at is None:
        return said
    end = geometry.lost_at / SECONDS_PER_DAY
    if share is not None and promise.requirement.share < 1.0:
        low, high = (100 * bound for bound in share)
        return f"{said}; {low:.5g} to {high:.5g} % in the days {begin:.5g} to {end:.5g}"
    if worst is None:
        return said
    return (
        f"{said}; {worst.value:.4g} on day {end:.6g} at {latitude_words(degrees(worst.latitude))}"
    )

"""The boxes of a certified share at one moment, to be shown: kept, broken, cut and open."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.groups import make_room
from compass.core.certified.shares import BOX, GIVEN, INSIDE, look, split, still_open
from compass.coverage.certified_question import Asked, Question
from compass.errors import ArgumentError
from compass.orbits import Constellation


class BoxKind(IntEnum):
    """What is known of a box."""

    KEPT = 0
    BROKEN = 1
    CUT = 2
    OPEN = 3


@dataclass(frozen=True, eq=False)
class MomentBoxes:
    """Boxes of latitude and longitude at a moment.

    Attributes
    ----------
    boxes
        Centre and half-widths (latitude, longitude), radians, inertial longitudes, shape (m, 4).
    kinds
        `BoxKind` of each: wholly kept, wholly broken, cut so that little is open, or open.
    low, high
        Bounds of the share of area at the moment.
    """

    boxes: NDArray[np.float64]
    kinds: NDArray[np.int64]
    low: float
    high: float


def boxes_at(
    constellation: Constellation,
    limit: float,
    *,
    phase: float = 0.0,
    smallest: float = 0.02,
    **asked: Unpack[Asked],
) -> MomentBoxes:
    """Cut the surface at one moment into boxes by what is surely known of a dilution there.

    Parameters
    ----------
    constellation
        Orbits of one period.
    limit
        Dilution of precision that is good, from 1.
    phase
        Growth of the mean anomalies since the epoch, radians.
    smallest
        Half-width, radians, below which boxes are not split.
    **asked
        As of `compass.coverage.certified_share.certified_share`.

    Raises
    ------
    ArgumentError
        A limit that nothing keeps, a smallest box that is none, or as `Question`.
    """
    if not smallest > 0.0:
        raise ArgumentError(f"smallest = {smallest:g} rad: must be positive")
    question = Question(constellation, **asked)
    question.check(limit)
    n, (south, north) = question.satellites, question.domain.sides[0]
    room, problem = make_room(n), question.problem()
    whole = np.zeros(BOX)
    whole[:3], whole[3:5] = (0.5 * (south + north), np.pi, phase), (0.5 * (north - south), np.pi)
    stack, settled = [whole], []
    while stack:
        box = stack.pop()
        look(box, question.squares([limit]), room, problem)
        part = still_open(box, 0) / box[INSIDE]
        halves = np.zeros(BOX), np.zeros(BOX)
        if part > 0.05 and max(box[3:5]) > smallest and split(box, 1.0, *halves):
            stack += halves
            continue
        kind = BoxKind.OPEN if part > 0.3 else BoxKind.CUT
        kept, broken = box[GIVEN:]
        if part == 0.0 and min(kept, broken) == 0.0:
            kind = BoxKind.KEPT if kept > 0.0 else BoxKind.BROKEN
        settled.append((*box[[0, 1, 3, 4]], kind, kept, broken, still_open(box, 0)))
    table = np.array(settled)
    kept, broken, open_ = table[:, 5:].sum(axis=0)
    total = kept + broken + open_
    return MomentBoxes(
        table[:, :4],
        table[:, 4].astype(np.int64),
        float(kept / total),
        float((kept + open_) / total),
    )

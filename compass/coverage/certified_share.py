"""Shares of area and time with a good dilution of precision, between bounds that are proven."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.shares import GIVEN, INSIDE
from compass.core.compiling import worked
from compass.coverage.certified_longitudes import weighed_share
from compass.coverage.certified_places import for_ever, sides_of
from compass.coverage.certified_question import Asked, Question
from compass.coverage.certified_rounds import Rounds, open_at_most
from compass.coverage.region import Region
from compass.errors import ArgumentError
from compass.orbits import Constellation

#: Part of the whole that a box may keep open in the first round of splitting; four times less in
#: each that follows, but no less in the last than the width asked for needs.
FIRST = 1e-3

#: How near bounds come at most to tell a share from one it is compared with.
NEAREST = 1e-6

#: What sums may be off by: a floor, and for every box.
FLOOR, PER_BOX = 1e-10, 4e-16


@dataclass(frozen=True, eq=False)
class CertifiedShare:
    """A share of area and time, or of time, between proven bounds.

    Attributes
    ----------
    low, high
        The share lies between them.
    boxes
        Boxes looked at.
    scope
        For which motion and how long, and by which symmetry.
    stopped
        Empty, or why it is wider than asked: ``time``, ``boxes``, ``memory`` or ``interrupted``.
    leaves, settled
        Where it can go on from: boxes with something open, and sums of those that have nothing
        (inside, outside, kept of each limit, broken of each).
    """

    low: float
    high: float
    boxes: int
    scope: str
    stopped: str = ""
    leaves: NDArray[np.float64] | None = field(default=None, repr=False)
    settled: tuple[float, ...] = field(default=(0.0, 0.0, 0.0, 0.0), repr=False)

    @property
    def value(self) -> float:
        """Middle of the bounds."""
        return 0.5 * (self.low + self.high)

    @property
    def width(self) -> float:
        """How far the bounds are apart."""
        return self.high - self.low


def certified_share(
    constellation: Constellation,
    limit: float,
    *,
    width: float = 1e-4,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    start: CertifiedShare | None = None,
    against: Sequence[float] = (),
    progress: Callable[[float], None] = lambda open_share: None,
    **asked: Unpack[Asked],
) -> CertifiedShare:
    """Bracket the share of area and time with a dilution of precision of at most a limit.

    Boxes of latitude, longitude and time in which the limit is surely kept or surely broken, by
    first-order cuts whose remainders are bounded (`compass.core.certified`), are added up; the
    rest is split until the bounds are `width` apart. With fewer than four satellites in view a
    dilution is infinite.

    Parameters
    ----------
    constellation
        The orbits.
    limit
        From 1; of an error, above 0 m.
    width, budget_s, budget_boxes
        Stop at bounds so near, after so many seconds, or after so many boxes (which is the same
        on any machine).
    workers
        Threads; the numbers do not depend on them.
    start
        A result of the same question to go on from.
    against
        Shares it is compared with: bounds come nearer than `width` until none is between them.
    progress
        Called with the share that is still open.
    **asked
        ``dop`` (by default ``pdop``), ``figure``, ``mask``, ``place`` and others of `Question`:
        of a region the share is of area and time, of a circle or a spot of time.

    Raises
    ------
    ArgumentError
        A limit that nothing keeps, a width that is not positive, or as `Question`.
    """
    question = Question(constellation, **asked)
    question.check(limit)
    search, began = Search(question, workers), worked()
    share = search.share(
        limit,
        width,
        budget_s=budget_s,
        budget_boxes=budget_boxes,
        start=start,
        progress=progress,
    )
    left = budget_boxes - share.boxes + (start.boxes if start else 0)
    for level in against:
        if share.low < level <= share.high and not share.stopped:
            share = search.share(
                limit,
                NEAREST,
                budget_s=budget_s - (worked() - began),
                budget_boxes=left,
                level=level,
                start=share,
                progress=progress,
            )
    return share


def certified_folds(
    constellation: Constellation,
    folds: Sequence[int],
    *,
    width: float = 1e-4,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    start: CertifiedShare | None = None,
    progress: Callable[[float], None] = lambda open_share: None,
    **asked: Unpack[Asked],
) -> list[CertifiedShare]:
    """Bracket the shares of area and time with so many satellites in view or more.

    All folds are looked at in the same boxes, cut by the rims of satellites' caps.

    Parameters
    ----------
    folds
        From 1.
    constellation, width, budget_s, budget_boxes, workers, start, progress, asked
        As in `certified_share`; ``start`` any result for the same folds.

    Raises
    ------
    ArgumentError
        A fold below 1, a width that is not positive, or as `Question`.
    """
    asked["dop"] = "fold"
    question = Question(constellation, **asked)
    for fold in folds:
        question.check(fold)
    return Search(question, workers).shares(
        folds,
        width,
        budget_s=budget_s,
        budget_boxes=budget_boxes,
        start=start,
        progress=progress,
    )


class Ends(TypedDict):
    """What ends a search of a weighed share."""

    budget_s: float
    budget_boxes: float
    level: float | None
    progress: Callable[[float], None]


class Search:
    """One question, at any limit."""

    def __init__(self, question: Question, workers: int) -> None:
        self.question, self.workers = question, workers
        self.scope = question.domain.scope
        self.rounds = Rounds(question, workers)

    def share(self, limit: float, width: float, **options: Any) -> CertifiedShare:
        """Refine until the bounds are `width` apart; options as of `shares`."""
        (share,) = self.shares([limit], width, **options)
        return share

    def shares(
        self,
        limits: Sequence[float],
        width: float,
        *,
        budget_s: float = np.inf,
        budget_boxes: float = np.inf,
        level: float | None = None,
        start: CertifiedShare | None = None,
        progress: Callable[[float], None] = lambda open_share: None,
    ) -> list[CertifiedShare]:
        """Refine until all bounds are `width` apart, or each pair on one side of `level`.

        All limits are looked at in the same boxes, with which any of the results can go on.
        """
        if not width > 0:
            raise ArgumentError(f"width = {width:g}: must be positive")
        q, m = self.question, len(limits)
        if q.no_fix:
            return [CertifiedShare(0.0, 0.0, 0, self.scope + "; fewer than four satellites")] * m
        if q.domain.weighed is not None:
            ends: Ends = {
                "budget_s": budget_s / m,
                "budget_boxes": budget_boxes / m,
                "level": level,
                "progress": progress,
            }
            return [self._weighed(q.domain.weighed, limit, width, **ends) for limit in limits]
        settled, boxes = np.zeros(GIVEN + 2 * m - INSIDE), 0
        if start is not None and start.leaves is not None:
            leaves, settled, boxes = start.leaves, np.array(start.settled), start.boxes
        else:
            leaves = np.zeros((len(q.boxes()), GIVEN + 2 * m))
            leaves[:, :GIVEN] = q.boxes()[:, :GIVEN]
        rounds = self.rounds
        rounds.begin(budget_s, budget_boxes)
        total = settled[:2].sum() + leaves[:, INSIDE:GIVEN].sum()
        coarse = max(FIRST, 0.1 * width) * total
        eps = 4.0 * min(coarse, open_at_most(leaves))
        while not rounds.stopped:
            shares = self._results(leaves, settled, boxes, "")
            widest = max(one.width for one in shares)
            progress(widest)
            decided = level is not None and all(
                one.low >= level or one.high < level for one in shares
            )
            if widest <= width or decided or not len(leaves):
                break
            # bounds come nearer as the root of what a box may keep open: the last round ends there
            eps *= max(0.25, (0.95 * width / widest) ** 2)
            leaves, sums = rounds.refine(leaves, np.full(m, eps), list(limits))
            settled, boxes = settled + sums[:-1], boxes + int(sums[-1])
        return self._results(leaves, settled, boxes, rounds.stopped)

    def _weighed(
        self, polygon: Region, limit: float, width: float, **ends: Unpack[Ends]
    ) -> CertifiedShare:
        """Weigh belts of latitude by the width of a polygon; begun anew each time."""

        def belt(
            south: float, north: float, near: float, seconds: float, boxes: float
        ) -> tuple[float, float, int, str]:
            search = Search(self.question.belt(south, north), self.workers)
            share = search.share(limit, near, budget_s=seconds, budget_boxes=boxes)
            return share.low, share.high, share.boxes, share.stopped

        q = self.question
        south, north, *_ = sides_of(for_ever(polygon), q.figure)
        e2 = q.domain.flattening
        known = weighed_share(polygon.normals, e2, (south, north), belt, width, **ends)
        low, high, boxes, stopped = known
        return CertifiedShare(max(low, 0.0), min(high, 1.0), boxes, self.scope, stopped)

    def _results(
        self, leaves: NDArray[np.float64], settled: NDArray[np.float64], boxes: int, stopped: str
    ) -> list[CertifiedShare]:
        """Bounds from what is kept, broken and open, rounded outwards.

        Exactly all, or none, where no box has anything open or of the other.
        """
        whole, _, *sums = settled + leaves[:, INSIDE:].sum(axis=0)
        if not whole > 0.0:
            raise ArgumentError("region: has no area")
        kept, broken = np.array(sums).reshape(2, -1)
        given = leaves[:, GIVEN:].reshape(len(leaves), 2, len(kept)).sum(axis=1)
        told = ~(leaves[:, INSIDE, np.newaxis] > given).any(axis=0)
        error = FLOOR + PER_BOX * boxes
        low = np.where(told & (broken == 0.0), 1.0, np.maximum(kept / whole - error, 0.0))
        high = np.where(told & (kept == 0.0), 0.0, np.minimum(1.0 - broken / whole + error, 1.0))
        going = tuple(settled.tolist())
        return [
            CertifiedShare(low, high, boxes, self.scope, stopped, leaves, going)
            for low, high in zip(low.tolist(), high.tolist(), strict=True)
        ]

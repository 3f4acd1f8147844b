"""Shares of area and time below many limits at once, for percentiles that are closed in on.

All limits are looked at in the same boxes. A percentile lies between two limits, and the nearer
they are the fewer boxes matter to it: one that surely keeps the lower counts as below, one that
surely breaks the upper as above, and neither is looked at again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.shares import GIVEN, INSIDE
from compass.core.compiling import worked
from compass.coverage.certified_question import Question
from compass.coverage.certified_rounds import Rounds
from compass.coverage.certified_share import FIRST, FLOOR, PER_BOX, Search


@dataclass(frozen=True)
class Limit:
    """A limit, the percentile for which it is looked at, and how near bounds are to come.

    No nearer than tells whether its share reaches each of `levels`, where there are any.
    """

    at: float
    percentile: int
    width: float = np.inf
    levels: tuple[float, ...] = ()


@dataclass(frozen=True)
class Below:
    """Bounds of the share below a limit; `finest` where they come no nearer at any cost."""

    low: float
    high: float
    finest: bool = False


@dataclass(eq=False)
class Boxes:
    """From where a distribution goes on.

    Attributes
    ----------
    leaves
        Boxes that matter to a percentile, shape (k, GIVEN).
    settled
        Measure of those that do not: for each percentile what counts as below and as above, shape
        (2, n).
    inside
        Measure of those in all.
    eps
        Measure that a box may keep open, for each percentile, shape (n,).
    looked
        Boxes looked at.
    """

    leaves: NDArray[np.float64]
    settled: NDArray[np.float64]
    inside: float
    eps: NDArray[np.float64]
    looked: int = 0


class Distribution:
    """Shares below limits, for some percentiles.

    Parameters
    ----------
    question
        What is asked.
    count
        How many percentiles are looked for.
    workers
        Threads; the numbers do not depend on them.
    boxes
        Where an earlier one of the same question and percentiles stopped.
    """

    def __init__(
        self, question: Question, count: int, workers: int, boxes: Boxes | None = None
    ) -> None:
        self.question, self.scope = question, question.domain.scope
        self.rounds = Rounds(question, workers)
        self._polygon = None
        if question.domain.weighed is not None:
            self._polygon = Search(question, workers)
        leaves = question.boxes()[:, :GIVEN]
        total = float(leaves[:, INSIDE].sum())
        self.boxes = boxes or Boxes(
            leaves, np.zeros((2, count)), 0.0, np.full(count, 4.0 * FIRST * total)
        )

    def shares(self, limits: Sequence[Limit]) -> list[Below]:
        """Bounds of the shares below limits, as near as asked, or as the budget allows."""
        if self._polygon is not None:
            return self._weighed(limits)
        values, of = [limit.at for limit in limits], [limit.percentile for limit in limits]
        near = np.array([limit.width for limit in limits])
        b, rounds = self.boxes, self.rounds
        leaves = np.zeros((len(b.leaves), GIVEN + 2 * len(limits)))
        leaves[:, :GIVEN] = b.leaves
        eps, fresh = np.where(np.isfinite(near), b.eps[of], np.inf), True
        while True:
            leaves, sums = rounds.refine(leaves, eps, values, fresh=fresh, whole=True)
            b.looked, fresh = b.looked + int(sums[-1]), False
            low, high = self._bounds(leaves, of)
            wide = high - low > near
            for k, limit in enumerate(limits):
                wide[k] &= not limit.levels or any(
                    low[k] < level <= high[k] for level in limit.levels
                )
            if rounds.stopped or not wide.any():
                break
            for k in np.unique(np.array(of)[wide]):
                # bounds come nearer as the root of what a box may keep open
                part = (0.95 * near / (high - low))[wide & (np.array(of) == k)].max() ** 2
                b.eps[k] *= max(0.25, float(part))
            eps = np.where(wide, b.eps[of], np.inf)
        self._values, self._leaves = values, leaves
        b.leaves = leaves[:, :GIVEN].copy()
        return [Below(*ends) for ends in zip(low.tolist(), high.tolist(), strict=True)]

    def _bounds(
        self, leaves: NDArray[np.float64], of: list[int]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper bounds of shares, rounded outwards."""
        b, count = self.boxes, len(of)
        below, above = b.settled[:, of]
        sums = leaves[:, INSIDE:].sum(axis=0)
        whole, error = b.inside + sums[0], FLOOR + PER_BOX * b.looked
        low = (below + sums[2 : 2 + count]) / whole - error
        high = 1.0 - (above + sums[2 + count :]) / whole + error
        return np.maximum(low, 0.0), np.minimum(high, 1.0)

    def close_in(self, ends: Mapping[int, tuple[float, float]]) -> None:
        """Set aside boxes that no longer matter.

        Parameters
        ----------
        ends
            Between which limits percentiles lie that are still looked for: 0, infinity or of those
            that `shares` was asked for last.
        """
        if self._polygon is not None or self.rounds.stopped:
            return
        count, columns = len(self._values), self._values
        inside, matters = self._leaves[:, INSIDE], np.zeros(len(self._leaves), dtype=bool)
        of: dict[int, tuple[NDArray[np.bool_], NDArray[np.bool_]]] = {}
        for k, (low, high) in ends.items():
            below, above = np.zeros((2, len(inside)), dtype=bool)
            if low > 0.0:
                below = self._leaves[:, GIVEN + columns.index(low)] >= inside
            if high < np.inf:
                above = self._leaves[:, GIVEN + count + columns.index(high)] >= inside
            of[k] = below, above
            matters |= ~(below | above)
        b = self.boxes
        for k, (below, above) in of.items():
            b.settled[0, k] += inside[~matters & below].sum()
            b.settled[1, k] += inside[~matters & above & ~below].sum()
        b.inside += float(inside[~matters].sum())
        b.leaves = b.leaves[matters]

    def _weighed(self, limits: Sequence[Limit]) -> list[Below]:
        """Share of each limit by itself, where latitudes weigh as a polygon is wide."""
        assert self._polygon is not None
        weighed, rounds = [], self.rounds
        for limit in limits:
            if limit.width == np.inf or rounds.stopped:
                weighed.append(Below(0.0, 1.0))
                continue
            known = self._polygon.share(
                limit.at,
                limit.width,
                budget_s=rounds.end - worked(),
                budget_boxes=rounds.left,
            )
            self.boxes.looked += known.boxes
            rounds.left -= known.boxes
            finest = known.stopped == "resolution"
            rounds.stopped = "" if finest else known.stopped
            weighed.append(Below(known.low, known.high, finest))
        return weighed

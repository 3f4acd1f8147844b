"""Shares and percentiles of dilution of precision between bounds that are proven."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from time import monotonic
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.shares import BOX, refine
from compass.coverage.certified_question import Asked, Question
from compass.errors import ArgumentError
from compass.orbits import Constellation

#: Boxes that one piece of work starts from: fixed, so that sums do not depend on who works.
PIECE = 2048

#: What sums may be off by: a floor, and for every box.
FLOOR, PER_BOX = 1e-10, 4e-16

#: Percentiles beyond this count as infinite.
GREATEST = 1e5


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
        Empty, or why it is wider than asked: ``time``, ``boxes`` or ``interrupted``.
    leaves, settled
        Where it can go on from: boxes with something open, and sums of those that have nothing
        (kept, broken, outside).
    """

    low: float
    high: float
    boxes: int
    scope: str
    stopped: str = ""
    leaves: NDArray[np.float64] | None = None
    settled: tuple[float, ...] = (0.0, 0.0, 0.0)

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
    return _Search(question, workers).share(
        limit,
        width,
        budget_s=budget_s,
        budget_boxes=budget_boxes,
        start=start,
        progress=progress,
    )


@dataclass(frozen=True)
class CertifiedPercentile:
    """A value that a share of area and time does not exceed, between proven bounds.

    `open` is the share at the limit tried last where that could not be told from the percentage:
    with the bounds, where it can go on from.
    """

    low: float
    high: float
    percent: float
    scope: str
    stopped: str = ""
    open: CertifiedShare | None = None

    @property
    def value(self) -> float:
        """Middle of the bounds."""
        return 0.5 * (self.low + self.high)


def certified_percentile(
    constellation: Constellation,
    percent: float,
    *,
    precision: float = 1e-3,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    start: CertifiedPercentile | None = None,
    **asked: Unpack[Asked],
) -> CertifiedPercentile:
    """Bracket the dilution of precision that `percent` of area and time do not exceed.

    Bisection on the limit: each share is refined no further than it takes to tell which side of
    `percent` it lies on. Infinite where limits up to 1e5 are not enough.

    Parameters
    ----------
    percent
        Above 0 and below 100.
    precision
        Stop at bounds that are so near, relative to the value.
    start
        A result of the same question to go on from.
    constellation, budget_s, budget_boxes, workers, asked
        As in `certified_share`, ``dop`` by default ``gdop``.

    Raises
    ------
    ArgumentError
        As in `certified_share`, or a percentage that is not between 0 and 100.
    """
    if not 0 < percent < 100:
        raise ArgumentError(f"percent = {percent:g}: allowed above 0 and below 100")
    if not precision > 0:
        raise ArgumentError(f"precision = {precision:g}: must be positive")
    asked.setdefault("dop", "gdop")
    question = Question(constellation, **asked)
    search = _Search(question, workers)
    if question.satellites < 4:
        return CertifiedPercentile(np.inf, np.inf, percent, search.scope)
    end, level = monotonic() + budget_s, percent / 100
    low, high, stopped = 0.0, np.inf, ""
    still: CertifiedShare | None = None
    if start is not None:
        low, high, still = start.low, start.high, start.open
    while low < GREATEST and not (high < np.inf and high - low <= precision * high):
        tried = _between(low, high)
        found = search.share(
            tried,
            1e-6,
            budget_s=end - monotonic(),
            budget_boxes=budget_boxes,
            level=level,
            start=still,
        )
        budget_boxes -= found.boxes - (still.boxes if still else 0)
        still = None
        if found.low >= level:
            high = tried
        elif found.high < level:
            low = tried
        else:
            still, stopped = found, found.stopped or "nearer than shares can tell"
            break
        if found.stopped == "interrupted":
            stopped = found.stopped
            break
    return CertifiedPercentile(low, high, percent, search.scope, stopped, still)


def _between(low: float, high: float) -> float:
    """The limit to try next, of which all depends on the bounds known so far."""
    if high == np.inf:
        return 4.0 if low == 0.0 else min(4.0 * low, GREATEST)
    return 0.25 * high if low == 0.0 else float((low * high) ** 0.5)


class _Search:
    """One question, at any limit."""

    def __init__(self, question: Question, workers: int) -> None:
        self.question, self.workers = question, workers
        self.scope = question.domain.scope
        if question.satellites >= 4:  # compiled before any clock runs
            self._round(np.empty((0, BOX)), 1.0, 1.0, np.inf, np.inf)

    def share(
        self,
        limit: float,
        width: float,
        *,
        budget_s: float = np.inf,
        budget_boxes: float = np.inf,
        level: float | None = None,
        start: CertifiedShare | None = None,
        progress: Callable[[float], None] = lambda open_share: None,
    ) -> CertifiedShare:
        """Refine until the bounds are `width` apart, or both on one side of `level`."""
        if not width > 0:
            raise ArgumentError(f"width = {width:g}: must be positive")
        if self.question.satellites < 4:
            return CertifiedShare(0.0, 0.0, 0, self.scope + "; fewer than four satellites")
        settled, boxes = np.zeros(3), 0
        if start is not None and start.leaves is not None:
            leaves, settled, boxes = start.leaves, np.array(start.settled), start.boxes
        else:
            leaves = self.question.boxes()
        end, stopped, most = monotonic() + budget_s, "", boxes + budget_boxes
        total = settled.sum() + leaves[:, 6:].sum()
        coarse = max(1e-5, 0.1 * width)
        eps = 4.0 * min(coarse * total, float(leaves[:, 9].max(initial=0.0)))
        while not stopped:
            found = self._result(leaves, settled, boxes, stopped)
            progress(found.width)
            decided = level is not None and (found.low >= level or found.high < level)
            if found.width <= width or decided or not len(leaves):
                break
            eps *= 0.25
            leaves, sums, stopped = self._round(leaves, eps, limit, end, most - boxes)
            settled, boxes = settled + sums[:3], boxes + int(sums[3])
        return self._result(leaves, settled, boxes, stopped)

    def _round(
        self, leaves: NDArray[np.float64], eps: float, limit: float, end: float, most: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
        """Refine all leaves, piece by piece in their order; what the budget leaves undone stays."""
        if most <= 0:
            return leaves, np.zeros(4), "boxes"
        arrays = self.question.arrays(limit)
        pieces = [leaves[k : k + PIECE] for k in range(0, max(len(leaves), 1), PIECE)]
        kept: list[NDArray[np.float64]] = []
        sums, stopped = np.zeros(4), ""

        def work(piece: NDArray[np.float64]) -> tuple[NDArray, NDArray] | None:
            if monotonic() > end:
                return None
            return refine(piece, eps, self.question.speed, *arrays)

        with ThreadPoolExecutor(self.workers) as pool:
            results = pool.map(work, pieces)
            try:
                for piece in pieces:
                    if sums[3] >= most:
                        pool.shutdown(wait=False, cancel_futures=True)
                        kept += pieces[len(kept) :]
                        stopped = "boxes"
                        break
                    done = next(results)
                    stopped = stopped or ("" if done else "time")
                    kept.append(done[1] if done else piece)
                    sums += done[0] if done else 0.0
            except KeyboardInterrupt:
                pool.shutdown(cancel_futures=True)
                kept += pieces[len(kept) :]
                stopped = "interrupted"
        return np.concatenate(kept), sums, stopped

    def _result(
        self, leaves: NDArray[np.float64], settled: NDArray[np.float64], boxes: int, stopped: str
    ) -> CertifiedShare:
        """Bounds from what is kept, broken and open, rounded outwards."""
        kept, broken, _ = settled + leaves[:, 6:9].sum(axis=0)
        still = leaves[:, 9].sum()
        whole = kept + broken + still
        if not whole > 0.0:
            raise ArgumentError("region: has no area")
        error = FLOOR + PER_BOX * boxes
        low = max(float(kept / whole) - error, 0.0)
        high = min(float((kept + still) / whole) + error, 1.0)
        return CertifiedShare(
            low, high, boxes, self.scope, stopped, leaves, tuple(settled.tolist())
        )

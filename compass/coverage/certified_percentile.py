"""What a dilution of precision does not exceed in a part of area and time: proven bounds."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, nan, sqrt
from time import monotonic
from typing import Unpack

import numpy as np

from compass.coverage.certified_question import Asked, Question
from compass.coverage.certified_share import NEAREST, CertifiedShare, Search
from compass.errors import ArgumentError
from compass.orbits import Constellation

#: Percentiles beyond this count as infinite.
GREATEST = 1e5

#: How far to either side of a limit that is too near to be told others are tried, and for which
#: part of the boxes that bisection may take, besides these.
ASIDE, BESIDES = (1.02, 1.1, 1.5), 1 / 2


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
    `percent` it lies on; where one is too near to be told, limits on either side of it are tried,
    in up to half as many boxes again. Infinite where limits up to 1e5 are not enough.

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
    search = Search(question, workers)
    if question.satellites < 4:
        return CertifiedPercentile(np.inf, np.inf, percent, search.scope)
    end, level, besides = monotonic() + budget_s, percent / 100, BESIDES * budget_boxes
    low, high, stopped = 0.0, np.inf, ""
    still: CertifiedShare | None = None
    if start is not None:
        low, high, still = start.low, start.high, start.open
    while low < GREATEST and not (high < np.inf and high - low <= precision * high):
        tried = _between(low, high)
        found = search.share(
            tried,
            NEAREST,
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
            if stopped not in ("time", "interrupted"):
                nearer = _aside(search, tried, (low, high), level, besides, end)
                still = still if nearer == (low, high) else None
                low, high = nearer
            break
        if found.stopped == "interrupted":
            stopped = found.stopped
            break
    return CertifiedPercentile(low, high, percent, search.scope, stopped, still)


def _aside(
    search: Search,
    tried: float,
    bounds: tuple[float, float],
    level: float,
    boxes: float,
    end: float,
) -> tuple[float, float]:
    """Bounds by limits on either side of one whose share is too near the level to be told."""
    (low, high), each = bounds, boxes / (2 * len(ASIDE))
    for sign in (-1.0, 1.0):
        for ratio in ASIDE:
            limit = max(tried * ratio**sign, 1.0)
            if not low < limit < high:
                break
            seconds = end - monotonic()
            found = search.share(limit, NEAREST, budget_s=seconds, budget_boxes=each, level=level)
            low = limit if found.high < level else low
            high = limit if found.low >= level else high
            if limit in (low, high):
                break
    return low, high


def _between(low: float, high: float) -> float:
    """The limit to try next, of which all depends on the bounds known so far."""
    if high == np.inf:
        return 4.0 if low == 0.0 else min(4.0 * low, GREATEST)
    return 0.25 * high if low == 0.0 else float((low * high) ** 0.5)


#: Part of the boxes that one limit near an estimate may take before another is tried.
TRY = 1 / 4

#: Where the search begins at most: shares of larger limits hardly come near, a sample puts any
#: number on a percentile that is infinite, and a lower bound like this tells most of what is asked.
LARGE = 50.0


def percentile_about(
    constellation: Constellation,
    percent: float,
    guess: float,
    *,
    precision: float,
    budget_boxes: float,
    limits: Sequence[float] = (),
    **asked: Unpack[Asked],
) -> CertifiedPercentile:
    """As `certified_percentile`, begun from an estimate such as a sample's.

    Limits are tried on either side of the estimate, somewhat less than half of `precision` away,
    and the estimate moves to where the shares found put it. One whose share is too near `percent`
    to be told from it is left for one farther out, so that whatever ends the search, there are
    bounds.

    Parameters
    ----------
    constellation, percent
        As in `certified_percentile`.
    guess
        The estimate, above 0 or infinite; a wrong one costs boxes, not truth.
    precision, budget_boxes
        As in `certified_percentile`, but that it may be told from `limits` at any price.
    limits
        What the percentile is compared with: one that lies between the bounds is tried itself, on
        the side of the estimate that would decide.
    **asked
        As in `certified_percentile`.
    """
    asked.setdefault("dop", "gdop")
    question = Question(constellation, **asked)
    search = Search(question, 1)
    if question.satellites < 4:
        return CertifiedPercentile(inf, inf, percent, search.scope)
    about = _About(search, percent / 100, guess, -0.45 * log(1.0 - precision), budget_boxes)
    while not about.within(precision) and about.left > 0:
        tried = about.next_limit()
        if tried is None:
            break
        about.go(tried, TRY * budget_boxes)
    for limit in limits:
        if about.low < limit < about.high and about.left > 0:
            about.go(limit * (1.0 + (1e-9 if guess > limit else -1e-9)), about.left)
    stopped = "" if about.within(precision) else "boxes"
    return CertifiedPercentile(about.low, about.high, percent, search.scope, stopped)


class _About:
    """Bounds of a percentile, an estimate between them, and how far from it limits are tried."""

    def __init__(
        self, search: Search, level: float, guess: float, reach: float, boxes: float
    ) -> None:
        self.search, self.level, self.left = search, level, boxes
        self.low, self.high = 0.0, inf
        self.estimate = min(max(guess, 1.0), LARGE)
        self._beyond = [nan, nan]  # share above the lower and above the upper bound
        self._reach = [reach, reach]  # below and above, of logarithms

    def within(self, precision: float) -> bool:
        """Whether the bounds are near enough, or the percentile is infinite."""
        near = self.high < inf and self.high - self.low <= precision * self.high
        return near or self.low >= GREATEST

    def next_limit(self) -> float | None:
        """The limit to try, on the side whose bound is farther; None if none is left."""
        down, up = (exp(reach) for reach in self._reach)
        tried = (max(self.estimate / down, 1.0), min(self.estimate * up, GREATEST))
        farther = self.high * self.low >= self.estimate**2
        for above in (farther, not farther):
            if self.low < tried[above] < self.high:
                return tried[above]
        return None

    def go(self, tried: float, boxes: float) -> None:
        """Look at one limit, and move a bound and the estimate; or try farther out next time."""
        found = self.search.share(
            tried, NEAREST, budget_boxes=min(boxes, self.left), level=self.level
        )
        self.left -= max(found.boxes, 1)
        if found.low >= self.level:
            self.high, self._beyond[1] = tried, 1.0 - found.value
        elif found.high < self.level:
            self.low, self._beyond[0] = tried, 1.0 - found.value
        else:
            self._reach[tried > self.estimate] *= 2.0
            return
        self._move()

    def _move(self) -> None:
        """Put the estimate between the bounds: by both shares, or by a tail that falls as 1/x²."""
        wanted = 1.0 - self.level
        if self.low > 0.0 and self.high < inf:
            first, second = self._beyond
            part = (first - wanted) / max(first - second, 1e-12)
            part = min(max(part, 0.1), 0.9)
            self.estimate = self.low ** (1.0 - part) * self.high**part
        elif self.estimate <= self.low:
            ratio = max(sqrt(self._beyond[0] / wanted), exp(2.0 * self._reach[0]))
            self.estimate = min(self.low * ratio, GREATEST)
        elif self.estimate >= self.high:
            ratio = min(sqrt(self._beyond[1] / wanted), exp(-2.0 * self._reach[1]))
            self.estimate = max(self.high * ratio, 1.0)

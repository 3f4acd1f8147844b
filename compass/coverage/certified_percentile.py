"""What a dilution of precision does not exceed in parts of area and time: proven bounds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp, inf, log, sqrt
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certified_distribution import Below, Boxes, Distribution, Limit
from compass.coverage.certified_question import Asked, Question
from compass.coverage.certified_share import NEAREST
from compass.document import Bracket, Value
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.quantities import quantity

#: Percentiles beyond this count as infinite.
GREATEST = 1e5

#: Limits to begin with where nothing is known, and how near bounds of their shares come.
LADDER = (*(2.0 ** (0.5 * k) for k in range(-1, 12)), 128.0, GREATEST)
COARSE = 0.04

#: Where the search begins at most: shares of larger limits hardly come near, a sample puts any
#: number on a percentile that is infinite, and a lower bound like this tells most of what is asked.
LARGE = 50.0

#: Percentiles above this wait for the others, which they would cut short: about singular geometry
#: boxes have to be as small as their reciprocals.
HARD = 20.0

#: Steps after which a percentile is left as it is known.
STEPS = 60

#: How far beside a limit shares are looked at that tell on which side of it a percentile lies,
#: relative to it: a bound that is the limit itself tells not whether it is below or at most that.
BESIDE = 1e-9


def bounded(name: str, known: Mapping[str, Any], key: str) -> Value:
    """A plain number with the bounds beside it, if any; infinite where it is beyond `GREATEST`."""
    bounds = Bracket.beside(known, key)
    if bounds is not None and bounds.low >= GREATEST:
        return Value(quantity(name), inf, Bracket(inf, inf))
    return Value(quantity(name), known.get(key, "not known"), bounds)


@dataclass(frozen=True)
class CertifiedPercentile:
    """A value that a share of area and time does not exceed, between proven bounds.

    Attributes
    ----------
    low, high
        It lies above the first, and not above the second.
    percent
        The share.
    scope
        For which motion and how long.
    stopped
        Empty, or why it is wider than asked: ``time``, ``boxes``, ``memory``, ``interrupted`` or
        ``nearer than shares can tell``.
    """

    low: float
    high: float
    percent: float
    scope: str
    stopped: str = ""

    @property
    def value(self) -> float:
        """Middle of the bounds."""
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True, eq=False)
class CertifiedPercentiles:
    """Percentiles of one figure.

    Attributes
    ----------
    of
        By per cent.
    boxes, points
        Where it can go on from; see `Boxes`, and shares found so far: percentile, limit, middle
        and half width, shape (k, 4).
    """

    of: Mapping[float, CertifiedPercentile]
    boxes: Boxes | None = None
    points: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 4)))


def certified_percentiles(
    constellation: Constellation,
    percents: Sequence[float],
    *,
    precision: float = 1e-3,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    guess: float | None = None,
    limits: Sequence[float] = (),
    start: CertifiedPercentiles | None = None,
    **asked: Unpack[Asked],
) -> CertifiedPercentiles:
    """Bracket what a dilution of precision does not exceed in parts of area and time.

    The shares below some limits, looked at in the same boxes, say where each percentile is; then
    limits close on either side of it are, as near as it takes to tell on which side they lie.
    Infinite where limits up to 1e5 are not enough.

    Parameters
    ----------
    percents
        Each above 0 and below 100.
    precision
        Stop at bounds that are so near, relative to the value.
    guess
        An estimate, such as a sample's, of one percentile; a wrong one costs boxes, not truth.
    limits
        What they are compared with: bounds come nearer until none is between them, or one of them.
    start
        A result of the same question to go on from.
    constellation, budget_s, budget_boxes, workers, asked
        As in `compass.coverage.certified_share.certified_share`, ``dop`` by default ``gdop``.

    Raises
    ------
    ArgumentError
        As there, or a percentage that is not between 0 and 100.
    """
    for percent in percents:
        if not 0 < percent < 100:
            raise ArgumentError(f"percent = {percent:g}: allowed above 0 and below 100")
    if not precision > 0:
        raise ArgumentError(f"precision = {precision:g}: must be positive")
    asked.setdefault("dop", "gdop")
    question = Question(constellation, **asked)
    scope = question.domain.scope
    if question.no_fix:
        return CertifiedPercentiles({q: CertifiedPercentile(inf, inf, q, scope) for q in percents})
    sought = [_Sought(k, q, precision, guess, limits) for k, q in enumerate(percents)]
    boxes = _go_on(sought, start) if start else None
    distribution = Distribution(question, len(percents), workers, boxes)
    distribution.rounds.begin(budget_s, budget_boxes)
    _close_in(distribution, sought)
    _compare(distribution, sought)
    return CertifiedPercentiles(
        {one.percent: one.result(scope, distribution.rounds.stopped) for one in sought},
        distribution.boxes,
        np.array([(one.index, *point) for one in sought for point in one.points]).reshape(-1, 4),
    )


def certified_percentile(
    constellation: Constellation, percent: float, **options: Any
) -> CertifiedPercentile:
    """Bracket one percentile; options as of `certified_percentiles`."""
    percentiles = certified_percentiles(constellation, (percent,), **options)
    return percentiles.of[percent]


def _go_on(sought: list["_Sought"], start: CertifiedPercentiles) -> Boxes | None:
    """Take what is known; return boxes to go on from if they still hold all that is sought."""
    left = False
    for one in sought:
        of = start.of[one.percent]
        one.low, one.high = of.low, of.high
        one.points = [tuple(p[1:].tolist()) for p in start.points if p[0] == one.index]
        left |= not of.stopped and not one.found
    if left or (known := start.boxes) is None:
        return None
    return replace(known, settled=known.settled.copy(), eps=known.eps.copy())


def _close_in(distribution: Distribution, sought: list["_Sought"]) -> None:
    """Look at limits nearer and nearer to the percentiles sought, all at once."""
    if any(not one.points and one.guess is None for one in sought):
        levels = tuple(one.level for one in sought)  # about singular geometry no more than that
        ladder = [Limit(at, 0, COARSE, levels if at > LARGE else ()) for at in LADDER]
        below = distribution.shares(ladder)
        for one in sought:
            one.take(ladder, below)
    for _ in range(STEPS):
        if all(one.ended for one in sought) or distribution.rounds.stopped:
            return
        easy = any(not one.ended and one.low < HARD for one in sought)
        asked = {
            one.index: one.limits(waits=easy and one.low >= HARD) for one in sought if one.matters
        }
        limits = [limit for ours in asked.values() for limit in ours]
        shares = iter(distribution.shares(limits))
        for k, ours in asked.items():
            sought[k].take(ours, [next(shares) for _ in ours])
        ends = {one.index: (one.low, one.high) for one in sought if one.matters}
        distribution.close_in(ends)


def _compare(distribution: Distribution, sought: list["_Sought"]) -> None:
    """Look beside limits that lie between bounds until it is told on which side each is."""
    for one in sought:
        for limit in one.compared:
            width = COARSE
            while (beside := one.beside(limit)) and width > NEAREST:
                if distribution.rounds.stopped:
                    return
                width *= 0.25
                asked = [Limit(at, one.index, width) for at in beside]
                one.take(asked, distribution.shares(asked))
                if one.untold:
                    break


class _Sought:
    """A percentile: bounds, and the shares below the limits looked at so far."""

    def __init__(
        self,
        index: int,
        percent: float,
        precision: float,
        guess: float | None,
        compared: Sequence[float],
    ) -> None:
        self.index, self.percent, self.level = index, percent, percent / 100.0
        self.low, self.high, self.precision, self.guess = 0.0, inf, precision, guess
        self.points: list[tuple[float, float, float]] = []
        self.finer, self.compared, self.untold = 1.0, compared, False

    @property
    def found(self) -> bool:
        """Whether the bounds are near enough, or the percentile is infinite."""
        near = self.high < inf and self.high - self.low <= self.precision * self.high
        return near or self.low >= GREATEST

    @property
    def ended(self) -> bool:
        """Whether it is found, or no nearer than shares come."""
        return self.found or self.untold

    @property
    def matters(self) -> bool:
        """Whether boxes between the bounds are still to be looked at."""
        return not self.ended or any(self.beside(limit) for limit in self.compared)

    def beside(self, limit: float) -> list[float]:
        """Limits to look at that tell on which side of one it lies; none once that is told."""
        if not self.low <= limit <= self.high:
            return []
        sides = limit * (1.0 - BESIDE), limit * (1.0 + BESIDE)
        return [at for at in sides if self.low < at < self.high]

    def result(self, scope: str, stopped: str) -> CertifiedPercentile:
        """What is known now."""
        late = "" if self.found else stopped or "nearer than shares can tell"
        return CertifiedPercentile(self.low, self.high, self.percent, scope, late)

    def take(self, limits: Sequence[Limit], below: Sequence[Below]) -> None:
        """Learn from the shares below limits."""
        asked = zip(limits, below, strict=True)
        looked = [(limit.at, share) for limit, share in asked if limit.width < inf]
        for at, share in looked:
            if share.low >= self.level:
                self.high = min(self.high, at)
            elif share.high < self.level:
                self.low = max(self.low, at)
        new = [(at, 0.5 * (of.low + of.high), 0.5 * (of.high - of.low)) for at, of in looked]
        least = 2.0 * max((half for *_, half in new), default=inf)
        tried = {at for at, *_ in new}
        # what was known less well between the bounds would mislead
        self.points = new + [
            (at, share, half)
            for at, share, half in self.points
            if at not in tried and (half <= least or not self.low < at < self.high)
        ]
        untold = [share.finest for at, share in looked if self.low < at < self.high]
        self.finer = 0.5 * self.finer if untold else 1.0
        self.untold = any(untold)

    def limits(self, waits: bool) -> list[Limit]:
        """Limits to look at next, unless it waits, and the bounds, by which boxes are set aside."""
        inner = [] if self.ended or waits else self._nearer()
        ends = [end for end in (self.low, self.high) if 0.0 < end < inf]
        return [*(Limit(end, self.index) for end in ends), *inner]

    def _nearer(self) -> list[Limit]:
        coarse = 0.25 * (1.0 - self.level)
        vague = [at for at, _, half in self.points if self.low < at < self.high and half > coarse]
        if len(vague) > 1:  # too far from the tail's own size to estimate anything from
            # but the largest: boxes about singular geometry settle it only when they are small
            return [Limit(at, self.index, coarse) for at in sorted(vague)[:-1]]
        middle, slope, doubt = self._estimate([p for p in self.points if p[0] not in vague])
        near = -log(1.0 - min(self.precision, 0.9))
        reach = max(0.45 * near, doubt)
        tried = [middle * exp(-reach), min(middle * exp(reach), GREATEST)]
        # a limit that would end the search, where there is room between it and the percentile
        down, up = self.high * exp(-near * (1.0 - 1e-9)), self.low * exp(near * (1.0 - 1e-9))
        room = {}
        if self.low < down < inf:
            room[down] = log(middle / down)
        if 0.0 < up < self.high:
            room[up] = log(up / middle)
        last = max(room, key=room.__getitem__, default=0.0)
        if room and room[last] > max(0.2 * near, doubt):
            tried, reach = [last], room[last]
        tried = [at for at in tried if self.low < at < self.high]
        if not tried:  # the estimate is less sure than the bounds are near
            tried, reach = [sqrt(self.low * self.high)], 0.25 * log(self.high / self.low)
        width = max(slope * reach * self.finer, NEAREST)
        return [Limit(at, self.index, width) for at in dict.fromkeys(tried)]

    def _estimate(self, points: Sequence[tuple[float, float, float]]) -> tuple[float, float, float]:
        """Where the percentile may be, how the share grows there by logarithm, doubt of that."""
        tail = 2.0 * (1.0 - self.level)  # of one that falls as 1/x^2
        if not points:
            assert self.guess is not None
            return min(max(self.guess, 1e-3), LARGE), tail, 0.0
        points = sorted(points)
        x = np.log([p[0] for p in points])
        share = np.clip(np.maximum.accumulate([p[1] for p in points]), 1e-7, 1.0 - 1e-7)
        half = np.array([p[2] for p in points])
        least = -2.0 * log(1.0 - min(self.precision, 0.9))
        k = int(np.searchsorted(share, self.level))
        if k == 0:
            ratio = min(sqrt((1.0 - share[0]) / (1.0 - self.level)), exp(-least))
            return float(exp(x[0]) * ratio), tail, -0.3 * log(ratio)
        if k == share.size:
            ratio = max(sqrt((1.0 - share[-1]) / (1.0 - self.level)), exp(least))
            return min(float(exp(x[-1]) * ratio), GREATEST), tail, 0.3 * log(ratio)
        y = np.log(share / (1.0 - share))[k - 1 : k + 1]
        wide, wanted = float(x[k] - x[k - 1]), log(self.level / (1.0 - self.level))
        slope = max(float(y[1] - y[0]), 1e-9) / wide
        middle = float(x[k - 1]) + (wanted - float(y[0])) / slope
        slope *= self.level * (1.0 - self.level)
        doubt = 0.1 * wide + 0.5 * float(half[k - 1 : k + 1].max()) / slope
        return exp(middle), slope, min(doubt, 0.5 * wide)

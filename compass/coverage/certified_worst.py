"""The largest dilution of precision over a place and time, between proven bounds, and where."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from math import degrees
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.worst import LEAF, pursue
from compass.core.compiling import worked
from compass.cores import shared
from compass.coverage.certificate import Outcome
from compass.coverage.certified_question import DOPS, Asked, Question
from compass.coverage.certified_rounds import OPEN, ended, fewer
from compass.coverage.certified_witness import WorstWitness, dilution_at
from compass.errors import ArgumentError
from compass.frames import planetocentric_latitude
from compass.orbits import Constellation
from compass.sites import Site
from compass.words import counted, place_words

#: A dilution above this is called unbounded: near a place where lines of sight lie on a cone it
#: takes every value, and rounding hides more than this.
UNBOUNDED = 1e4

#: How far above the largest value found bounds may lie, in one round after the other.
RATIOS = (4.0, 2.0, 1.25, 1.05)

#: Boxes that one piece of work starts from, and may look at: at first and at most, twice as many
#: in each turn where no clock is to be looked at. Fixed, so that nothing depends on who works.
PIECE, FEW, MANY = 1024, 8192, 262_144


@dataclass(frozen=True, eq=False)
class CertifiedWorst:
    """The largest dilution (exactly: its supremum) between proven bounds.

    Attributes
    ----------
    low, high
        It lies between them; high is inf where it is unbounded, or nothing is known yet.
    witness
        Where and when it is at least `low`; None before anything was looked at.
    boxes
        Boxes looked at.
    scope
        For which motion and how long, and by which symmetry.
    stopped
        Empty, or why bounds are wider than asked: ``time``, ``boxes``, ``memory``,
        ``interrupted`` or ``resolution``: boxes as small as they get have no bound, near where it
        is infinite.
    leaves, best
        Where it can go on from.
    """

    low: float
    high: float
    witness: WorstWitness | None
    boxes: int
    scope: str
    stopped: str = ""
    leaves: NDArray[np.float64] | None = None
    best: tuple[float, ...] = ()

    @property
    def unbounded(self) -> bool:
        """Whether it exceeds all that could be bounded."""
        return bool(self.best) and self.best[0] >= UNBOUNDED**2

    @property
    def sentence(self) -> str:
        """What is known, in words."""
        if self.witness is None:
            return f"not known: {ended(self.stopped)}"
        w = self.witness
        place = place_words(degrees(w.latitude), degrees(w.longitude), ".3f")
        where = f"{place}, {w.time:.3f} s after the epoch"
        if np.isinf(w.value):
            return f"infinite: {counted(len(w.satellites), 'satellite')} in view at {where}"
        if self.unbounded:
            return f"unbounded near {where}"
        bounds = f"between {self.low:.6g} and {self.high:.6g}"
        if np.isinf(self.high):
            bounds = f"{self.low:.6g} or more"
        return f"{bounds}, at {where}"


@dataclass(frozen=True, eq=False)
class CertifiedAlways:
    """What came of the claim that a dilution of precision is always at most a limit.

    Attributes
    ----------
    outcome
        Proven, refuted (at `witness`) or undecided.
    limit
        As claimed.
    witness
        Where and when it is largest of all that was looked at; above the limit if refuted.
    boxes, scope, stopped
        As of `CertifiedWorst`.
    """

    outcome: Outcome
    limit: float
    witness: WorstWitness | None
    boxes: int
    scope: str
    stopped: str = ""


def certified_worst(
    constellation: Constellation,
    *,
    precision: float = 1e-3,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    start: CertifiedWorst | None = None,
    progress: Callable[[float, float], None] = lambda low, high: None,
    **asked: Unpack[Asked],
) -> CertifiedWorst:
    """Bracket the largest dilution of precision over a place and time, and say where it is.

    Boxes of latitude, longitude and time are split until none can hold a value that is more than
    `precision` above the largest one found (`compass.core.certified.worst`).

    Parameters
    ----------
    constellation
        The orbits.
    precision
        How near bounds are to come, relative to the value.
    budget_s, budget_boxes
        Stop after so many seconds, or boxes, those of `start` not counted.
    workers
        Threads; the numbers do not depend on them.
    start
        A result of the same question to go on from.
    progress
        Called with the bounds known so far.
    **asked
        ``dop`` (by default ``pdop``), ``figure``, ``mask``, ``place`` and others of `Question`.

    Raises
    ------
    ArgumentError
        A precision that is not positive, or as `Question`.
    """
    if not precision > 0:
        raise ArgumentError(f"precision = {precision:g}: must be positive")
    search = _Pursuit(Question(constellation, **asked), workers, budget_s, budget_boxes, start)
    for ratio in [*(r for r in RATIOS if r > 1.0 + precision), 1.0 + precision]:
        search.go_on(ratio, 0.0, UNBOUNDED)
        progress(*search.bounds())
        if search.stopped or search.best[0] >= UNBOUNDED**2:
            break
    return search.result()


def certified_always(
    constellation: Constellation,
    limit: float,
    *,
    budget_s: float = np.inf,
    budget_boxes: float = np.inf,
    workers: int = 1,
    **asked: Unpack[Asked],
) -> CertifiedAlways:
    """Prove or refute that a dilution of precision is at most a limit, always and everywhere.

    Parameters
    ----------
    limit
        From 1; of an error, above 0 m.
    constellation, budget_s, budget_boxes, workers, asked
        As in `certified_worst`.

    Raises
    ------
    ArgumentError
        A limit that nothing keeps, or as `Question`.
    """
    question = Question(constellation, **asked)
    question.check(limit)
    search, least = _Pursuit(question, workers, budget_s, budget_boxes), question.dilution(limit)
    search.go_on(1.0, least, least)
    worst = search.result()
    outcome = Outcome.UNDECIDED
    if worst.witness is not None and worst.witness.value > limit:
        outcome = Outcome.REFUTED
    elif not len(search.leaves) and search.best[0] <= least * least:
        outcome = Outcome.PROVEN
    return CertifiedAlways(outcome, limit, worst.witness, worst.boxes, worst.scope, worst.stopped)


class _Pursuit:
    """Boxes that may still hold the largest value, and the largest found."""

    def __init__(
        self,
        question: Question,
        workers: int,
        budget_s: float,
        budget_boxes: float,
        start: CertifiedWorst | None = None,
    ) -> None:
        self.question, self.workers, self.budget = question, workers, budget_boxes
        self.stopped, self.boxes = "", 0
        self.size, self.few, self.many = (
            fewer(boxes, question.satellites)
            for boxes in (PIECE, FEW, MANY if budget_s == np.inf else FEW)
        )
        self.problem = question.problem()
        if start is not None and start.leaves is not None:
            self.leaves, self.best, self.boxes = start.leaves, np.array(start.best), start.boxes
        else:
            boxes = question.boxes()
            self.leaves, self.best = np.full((len(boxes), LEAF), np.inf), np.zeros(4)
            self.leaves[:, :6], self.leaves[:, 7] = boxes[:, :6], 0.0
        self.most = self.boxes + budget_boxes
        self._work(self.leaves[:0], 1.0, 0.0, 1.0)  # compiled before the clock runs
        self.end = worked() + budget_s

    def go_on(self, ratio: float, enough: float, beyond: float) -> None:
        """Refine until all bounds are within a ratio of the largest value, or small enough."""
        self.stopped, halt = "", beyond * beyond
        pending = self.leaves
        done: list[NDArray[np.float64]] = []
        while len(pending) and not self.stopped and self.best[0] <= halt:
            pieces = [pending[k : k + self.size] for k in range(0, len(pending), self.size)]
            left: list[NDArray[np.float64]] = []
            held = float(pending.nbytes + sum(part.nbytes for part in done))
            best, work = self.best, partial(self._work, ratio=ratio, enough=enough, beyond=beyond)
            with closing(shared(work, pieces, self.workers)) as results:
                try:
                    while len(left) < len(pieces) and not self.stopped and best[0] <= halt:
                        if self.boxes >= self.most:
                            self.stopped = "boxes"
                        elif held > OPEN:
                            self.stopped = "memory"
                        elif (result := next(results)) is None:
                            self.stopped = "time"
                        else:
                            found, looked, stuck, open_ = result
                            best = found if found[0] > best[0] else best
                            self.stopped = "resolution" if stuck else ""
                            self.boxes += int(looked)
                            held += open_.nbytes - pieces[len(left)].nbytes
                            left.append(open_)
                except KeyboardInterrupt:
                    self.stopped = "interrupted"
            left += pieces[len(left) :]
            self.best, self.few = best, min(2 * self.few, self.many)
            leaves = np.concatenate(left)
            leaves = leaves[leaves[:, 6] > max(best[0], enough * enough)]
            near = leaves[:, 6] <= best[0] * ratio * ratio
            done.append(leaves[near])
            pending = leaves[~near]
        self.leaves = np.concatenate([*done, pending])
        self.leaves = self.leaves[self.leaves[:, 6] > max(self.best[0], enough * enough)]

    def _work(
        self, piece: NDArray[np.float64], ratio: float, enough: float, beyond: float
    ) -> tuple[NDArray, int, bool, NDArray] | None:
        """Pursue one piece; None where time is over."""
        if len(piece) and worked() > self.end:
            return None
        return pursue(
            np.ascontiguousarray(piece),
            self.best,
            ratio * ratio,
            enough * enough,
            beyond * beyond,
            int(min(self.few, max(self.budget, 1))),
            self.question.speed,
            self.question.domain.sides,
            self.problem,
        )

    def bounds(self) -> tuple[float, float]:
        """What the largest value lies between."""
        low = float(np.sqrt(self.best[0]))
        high = max(low, float(np.sqrt(self.leaves[:, 6].max(initial=0.0))))
        value = self.question.value
        return value(low), np.inf if low >= UNBOUNDED else value(high)

    def result(self) -> CertifiedWorst:
        """What was found."""
        low, high = self.bounds()
        witness = self._witness() if self.best[0] > 0.0 else None
        return CertifiedWorst(
            low,
            high,
            witness,
            self.boxes,
            self.question.domain.scope,
            self.stopped,
            self.leaves,
            tuple(self.best.tolist()),
        )

    def _witness(self) -> WorstWitness:
        """Evaluate the dilution where it is largest, from the orbits themselves."""
        q = self.question
        _, b, longitude, t = self.best
        time, east = q.domain.moment(t, longitude, q.constellation.epoch)
        latitude = float(planetocentric_latitude(b, q.figure))
        site = Site("", latitude, east, q.height, q.horizon, q.figure)
        moved, name = q.domain.motion, DOPS[q.dop]
        value, seen = dilution_at(q.constellation, site, time, moved, name, q.ranges, q.beam)
        value = float(np.hypot(value, np.sqrt(q.shared)))
        return WorstWitness(float(time), latitude, east, value, seen)

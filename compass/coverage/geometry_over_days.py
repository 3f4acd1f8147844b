"""How long dilutions of precision are kept along real paths: for so many days, or missed and when.

Errors and levels likewise, and satellites in view that are no caps'. Settled for one stretch of
days after the other, each by `geometry_verdict`: what is wanted always is looked for to
`RESOLUTION`; a share is taken of every stretch by itself, so that good weeks do not make up for bad
ones. Where samples alone tell, a share is settled by them, and an always refuted by a miss that
they see anywhere in the span.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.fold_verdict_over_days import fold_verdict_over_days
from compass.coverage.geometry_verdict import (
    WIDTH,
    asks_for_folds,
    certified,
    geometry_verdict,
)
from compass.coverage.value_limit import FOLD
from compass.coverage.verdict import Verdict, both
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.orbits.motion import Motion
from compass.orbits.trajectory import Trajectory
from compass.requirement import Requirement

#: A stretch, s, and how near the moment of a miss is found.
STRETCH, RESOLUTION = 7.0 * SECONDS_PER_DAY, 60.0

#: Widths of the bounds of a share that are tried, one after the other.
WIDTHS = (0.03, 3e-3, WIDTH)

OUTCOMES = {True: Outcome.PROVEN, False: Outcome.REFUTED, None: Outcome.UNDECIDED}


@dataclass(frozen=True)
class GeometryLasting:
    """What was settled along paths about dilutions of precision, or what else is no cap's.

    Attributes
    ----------
    outcome
        Proven to the end of the span, refuted (missed), or undecided.
    start, stop
        Span looked at, seconds after the epoch.
    proven_until
        Up to when it is proven.
    lost_at
        When it is surely missed: a moment, or the end of the stretch whose share is too small.
    verdict
        Of the stretch looked at last.
    """

    outcome: Outcome
    start: float
    stop: float
    proven_until: float
    lost_at: float | None
    verdict: Verdict

    @property
    def days_proven(self) -> float:
        """Days from the start for which it is proven."""
        return (self.proven_until - self.start) / SECONDS_PER_DAY

    @property
    def first_loss_days(self) -> float | None:
        """Days after the epoch at which it is missed; None if it is not."""
        return None if self.lost_at is None else self.lost_at / SECONDS_PER_DAY


def geometry_lasts(
    design: Design,
    requirement: Requirement,
    path: Trajectory,
    start: float,
    stop: float,
    progress: Callable[[float], None] = lambda part: None,
) -> GeometryLasting:
    """How long a requirement's limits are kept along paths, and a fold that it has besides.

    Parameters
    ----------
    design, requirement
        The requirement has limits, or a fold that cannot be followed as caps are.
    path
        What the design's satellites do.
    start, stop
        Seconds after the epoch.
    progress
        Called with the part of the way that is gone, 0 to 1.

    Raises
    ------
    ArgumentError
        As `geometry_verdict`.
    """
    flown = replace(design, motion=Motion("ephemeris", table=path))

    def ask(begin: float, end: float) -> Verdict:
        def told(_: str, part: float) -> None:
            progress((begin + part * (end - begin) - start) / (stop - start))

        # holds what is open, so that finer bounds go on from coarser ones
        effort = Effort(progress=told)
        for width in WIDTHS:
            settled = _both(flown, requirement, begin, end, effort, width)
            if settled.met is not None or settled.stopped:
                break
        return settled

    # samples prove no stretch, and may see a miss in any
    at_once = requirement.share == 1.0 and not certified(flown, requirement)
    count = 1 if at_once else max(int(np.ceil((stop - start) / STRETCH - 1e-9)), 1)
    edges = np.linspace(start, stop, count + 1).tolist()
    for begin, end in pairwise(edges):
        verdict = ask(begin, end)
        progress((end - start) / (stop - start))
        if verdict.met is True:
            continue
        lost = None
        if verdict.met is False:
            if requirement.share == 1.0 and not at_once:
                begin, end, verdict = _first_miss(ask, begin, end, verdict)
            lost = end
            if at_once and verdict.worst is not None and verdict.worst.time is not None:
                lost = verdict.worst.time
        return GeometryLasting(OUTCOMES[verdict.met], start, stop, begin, lost, verdict)
    return GeometryLasting(Outcome.PROVEN, start, stop, stop, None, verdict)


def _both(
    design: Design,
    requirement: Requirement,
    begin: float,
    end: float,
    effort: Effort,
    width: float,
) -> Verdict:
    """Verdict on the fold and all limits of a requirement over a stretch."""
    days, start_day = (end - begin) / SECONDS_PER_DAY, begin / SECONDS_PER_DAY
    span: dict[str, Any] = {"days": days, "start_day": start_day, "effort": effort}
    limits, verdicts = list(requirement.limits), []
    if requirement.fold is not None:
        if asks_for_folds(design, requirement, days, start_day):
            limits.insert(0, (FOLD, requirement.fold))
        else:
            verdicts.append(fold_verdict_over_days(design, requirement, **span))
    verdicts += [
        geometry_verdict(design, requirement, name, limit, width=width, by_samples=True, **span)
        for name, limit in limits
    ]
    settled = verdicts[0]
    for further in verdicts[1:]:
        settled = both(settled, further)
    return settled


def _first_miss(
    ask: Callable[[float, float], Verdict], begin: float, end: float, missed: Verdict
) -> tuple[float, float, Verdict]:
    """Halve a stretch with a miss: proven before its begin, missed by its end."""
    while True:
        if missed.worst is not None and missed.worst.time is not None:
            end = min(end, max(missed.worst.time, begin))  # there it is missed, seen by itself
        if end - begin <= RESOLUTION:
            return begin, end, missed
        middle = 0.5 * (begin + end)
        first = ask(begin, middle)
        if first.met is None:
            return begin, end, missed
        if first.met is False:
            end, missed = middle, first
        else:
            begin = middle

"""Whether a fold is kept along real paths for a span of days, by a requirement's users."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations, pairwise
from math import comb
from typing import Any

import numpy as np

from compass.cores import shared
from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.claims import Claim, claims_of
from compass.coverage.fold_verdict import Course, ask, often, users_of
from compass.coverage.lasting import Lasting, prove_span
from compass.coverage.standing import ranked
from compass.coverage.users import Users
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.trajectory import Trajectory
from compass.requirement import Requirement
from compass.words import counted

#: Stretches in which boxes are laid out, s, so short that the boxes allowed to each suffice; and
#: sets of lost satellites that are looked at.
STRETCH, MOST_SETS = SECONDS_PER_DAY, 1000


def fold_verdict_over_days(
    design: Design,
    requirement: Requirement,
    *,
    days: float | None,
    start_day: float = 0.0,
    effort: Effort | None = None,
) -> Verdict:
    """Verdict on "so many satellites in view" along the paths of a design's motion.

    Parameters
    ----------
    design, requirement
        As in `compass.coverage.requirement_verdict.verdict_of`; the requirement wants a fold.
    days, start_day
        The span.
    effort
        Its seconds for each share, if it has any.

    Raises
    ------
    ArgumentError
        As `prove_span` and `compass.orbits.motion.Motion.trajectory`.
    """
    assert days is not None
    assert requirement.fold is not None
    motion = design.motion
    scope = f"over {counted(days, 'day')} from day {start_day:g}, {motion.title}, at the place"
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    path = motion.trajectory(design.constellation, start, stop)
    if not followed_as_caps(design, requirement):
        course = Course((start, stop), False, scope + _given({path.estimated}))
        return _by_boxes(path, users_of(design, requirement), requirement, course, effort)
    # whichever are lost: so many are left if so many more are there
    fold = requirement.fold + requirement.losses
    found = [
        (claim_lasts(path, fold, claim, start, stop), claim.users)
        for claim in claims_of(design, requirement)
    ]
    return _verdict(path, requirement, scope, found)


def followed_as_caps(design: Design, requirement: Requirement) -> bool:
    """Whether a requirement's satellites in view are those whose caps users stand in.

    Not in beams, above satellites, above an ellipsoid or for a share: there boxes of place and
    time tell.
    """
    lowest = design.constellation.periapsis_radius.min(initial=np.inf)
    above = lowest <= design.figure.equatorial_radius + requirement.altitude
    raised = requirement.altitude and not design.figure.is_sphere
    return (
        requirement.beam is None
        and requirement.share == 1.0
        and not (requirement.areas and (above or raised))
    )


def claim_lasts(path: Trajectory, fold: int, claim: Claim, start: float, stop: float) -> Lasting:
    """How long a claim is proven along paths; lost only if it is over its lowest mask too."""
    asked: dict[str, Any] = {
        "sphere_radius": claim.radius,
        "stretch": claim.stretch,
        "region": claim.region,
        "start": start,
        "stop": stop,
    }
    found = prove_span(path, fold, mask=claim.highest, **asked)
    if found.outcome is Outcome.REFUTED and claim.lowest < claim.highest:
        lowest = prove_span(path, fold, mask=claim.lowest, **asked)
        if lowest.outcome is Outcome.REFUTED:  # a loss over the highest may be none
            return replace(found, lost_at=lowest.lost_at, witness=lowest.witness)
        return replace(found, outcome=Outcome.UNDECIDED, lost_at=None, witness=None)
    return found


def _verdict(
    path: Trajectory,
    requirement: Requirement,
    scope: str,
    claimed: list[tuple[Lasting, Users]],
) -> Verdict:
    """Verdict of the claims about all places: the first loss counts."""
    found = [lasting for lasting, _ in claimed]
    lost = [one for one in claimed if one[0].outcome is Outcome.REFUTED]
    if lost:
        first, users = min(lost, key=lambda one: one[0].lost_at or np.inf)
        w = first.witness
        assert w is not None
        where = w.time, w.latitude, w.longitude
        worst, gone = _after_losses(path, users, requirement, where, w.fold)
        kept = first.days_proven / ((first.stop - first.start) / SECONDS_PER_DAY)
        return Verdict(requirement, False, "proven", scope, (kept, 1.0), -w.shortfall, worst, gone)
    if all(one.outcome is Outcome.PROVEN for one in found):
        given = _given({one.estimated for one in found})
        return Verdict(requirement, True, "proven", scope + given, (1.0, 1.0))
    days = min(one.days_proven for one in found)
    return undecided(requirement, scope, f"proven for {days:.6g} days; then neither could be shown")


def _given(estimated: set[str]) -> str:
    """What a proof is given that is no bound, in words."""
    known = ", ".join(sorted(estimated - {""}))
    return f"; given an estimated {known}" if known else ""


def _by_boxes(
    path: Trajectory,
    users: Sequence[Users],
    requirement: Requirement,
    course: Course,
    effort: Effort | None,
) -> Verdict:
    """Verdict along paths from boxes of place and time: beams, users above, shares, any figure.

    What is wanted always is settled for one stretch after the other, up to the first that misses
    it or is left open.
    """
    assert requirement.fold is not None
    assert course.span is not None
    if requirement.share < 1.0:
        return often(_without(path, requirement.losses), users, requirement, course, effort)
    # whichever are lost: so many are left if so many more are there
    fold, (start, stop) = requirement.fold + requirement.losses, course.span
    low, tightest = np.inf, None
    edges = np.linspace(start, stop, max(int(np.ceil((stop - start) / STRETCH - 1e-9)), 1) + 1)
    for begin, end in pairwise(edges.tolist()):
        part = Course((begin, end), False, course.words)
        asked = partial(ask, path, fold=fold, course=part)
        found = list(zip(shared(asked, users), users, strict=True))
        low = min(low, *(one.low for one, _ in found))
        closest, who = min(found, key=lambda one: one[0].high)
        if tightest is None or closest.high < tightest.high:
            tightest, whose = closest, who
        if low < 0.0:
            break
    assert tightest is not None
    if low < 0.0 <= tightest.high:
        days = (begin - start) / SECONDS_PER_DAY
        reason = f"proven for {days:.6g} days; then neither could be shown"
        return undecided(requirement, course.words, reason)
    met = low >= 0.0
    margin = low if met else tightest.high
    worst: Worst | None = None
    gone: tuple[str, ...] = ()
    if np.isfinite(tightest.high):
        where = tightest.time, tightest.latitude, tightest.longitude
        worst, gone = _after_losses(path, whose, requirement, where, tightest.seen)
    share = (1.0, 1.0) if met else ((begin - start) / (stop - start), 1.0)
    return Verdict(
        requirement,
        met,
        "proven",
        course.words,
        share,
        margin if np.isfinite(margin) else None,
        worst,
        gone,
    )


def _after_losses(
    path: Trajectory,
    users: Users,
    requirement: Requirement,
    where: tuple[float, float, float],
    seen: int,
) -> tuple[Worst, tuple[str, ...]]:
    """What is left at a moment and place once the satellites are lost that stand best there.

    Who is lost of those that clear the horizon by more, the one that counts then is the same.
    """
    order, losses, fold = ranked(path, users, *where), requirement.losses, requirement.fold
    assert fold is not None
    lost, left = order[:losses], order[losses:]
    elevation = left[fold - 1][1] if len(left) >= fold else None
    worst = Worst(*where, max(seen - losses, 0), rank=fold, elevation=elevation)
    return worst, tuple(name for name, _ in lost)


def _without(path: Trajectory, losses: int) -> Iterator[tuple[tuple[str, ...], int, Trajectory]]:
    """Every set of satellites that may be lost, and the paths of the others."""
    if comb(path.size, losses) > MOST_SETS:
        raise ArgumentError(
            f"losses = {losses}: {comb(path.size, losses)} sets of {path.size} satellites, more "
            f"than {MOST_SETS}; ask for fewer, or for always"
        )
    for lost in combinations(path.satellite_names, losses):
        yield lost, 1, path.of([name for name in path.satellite_names if name not in lost])

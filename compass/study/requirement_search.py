"""The smallest constellations that meet requirements: every pattern of every size, proven.

For each size, every pattern at every inclination, and where tracks are closed every turn over the
ground, is looked at at random moments, the first of which refutes most. Those left are asked for
the folds wanted always, proven by boxes; they must keep their satellites apart and have the
geometry wanted: the samples put the most promising first, certified figures decide. The first size
at which something is met is the smallest.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np

from compass.coverage.certified_effort import Effort
from compass.coverage.clearance import least_clearance
from compass.coverage.fold_verdict import course_of, fold_always_met, users_of
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.orbits.kinds import kind_of
from compass.study.lasting import left_alone, real_motion
from compass.study.requirement_patterns import grids, sampled
from compass.study.requirement_question import Found, KeptOut, Outcome, Question
from compass.study.requirement_samples import is_hopeless
from compass.study.search import MOST_SATELLITES, pair_cosines

#: Candidates of a size whose figures are certified at most, the most promising first; and
#: inclinations or turns of one pattern.
MOST_CERTIFIED, TRIES = 16, 2

#: Patterns without the geometry wanted that are asked whether they have at least the folds.
BARE = 8


def search_for(
    question: Question,
    *,
    finalists: int = 5,
    workers: int = 2,
    progress: Callable[..., Iterable[Any]] = lambda items, **_: items,
) -> Outcome:
    """Find the smallest constellations that meet requirements.

    Parameters
    ----------
    question
        What is looked for.
    finalists
        How many of the smallest size to tell, of different patterns.
    workers
        Threads; the result does not depend on them.
    progress
        Wraps the sizes, as tqdm does.

    Raises
    ------
    ArgumentError
        Out of range, or as `verdict_of`.
    """
    _check(question, finalists)
    kept: dict[str, KeptOut] = {}
    met: list[Found] = []
    looked_at = 0
    for size in progress(range(question.least, question.largest + 1)):
        tried = list(grids(question, size))
        looked_at += sum(len(grid.inclinations) for grid in tried)
        unknown = bool(question.geometry) and "geometry" not in kept
        able, bare = sampled(question, tried, workers, unknown)
        found = _folded(question, able, workers)
        _keep_out(question, bare[:BARE], kept)
        apart = [one for one in found if one.closest_approach >= question.least_approach]
        for one in found:
            if one.closest_approach < question.least_approach and "close" not in kept:
                angle = np.degrees(one.closest_approach)
                kept["close"] = KeptOut(
                    one.constellation, f"two satellites come within {angle:.2f} deg of each other"
                )
        good = _certified(question, apart, finalists if not met else 1, workers, kept)
        if met:
            next_best = good[0] if good else None
            return Outcome(tuple(met), next_best, tuple(kept.values()), looked_at)
        met = good
    return Outcome(tuple(met), None, tuple(kept.values()), looked_at)


def _check(question: Question, finalists: int) -> None:
    if not 1 <= question.largest <= MOST_SATELLITES:
        raise ArgumentError(f"max_satellites = {question.largest}: allowed 1 to {MOST_SATELLITES}")
    if finalists < 1:
        raise ArgumentError(f"finalists = {finalists}: must be 1 or more")
    if not 0 <= question.least_approach < np.pi:
        angle = np.degrees(question.least_approach)
        raise ArgumentError(f"least_approach_deg = {angle:g}: allowed 0 up to below 180")
    for kind in question.kinds:
        kind_of(kind)


def _folded(question: Question, found: Sequence[Found], workers: int) -> list[Found]:
    """Candidates with every fold that is wanted always."""
    if not found or not question.always:
        return list(found)
    # who is asked, and for how long, is the same for all
    design = question.design(found[0].constellation)
    course = course_of(design, None, 0.0)
    assert course is not None
    users = [users_of(design, wanted) for wanted in question.always]

    def holds(one: Found) -> bool:
        return all(
            fold_always_met(one.constellation, places, wanted, course)
            for places, wanted in zip(users, question.always, strict=True)
        )

    with ThreadPoolExecutor(workers) as pool:
        kept = list(pool.map(holds, found))
    return [one for one, keep in zip(found, kept, strict=True) if keep]


def _certified(
    question: Question,
    found: list[Found],
    wanted: int,
    workers: int,
    kept: dict[str, KeptOut],
) -> list[Found]:
    """The best of a size that meet everything, of different patterns."""
    with ThreadPoolExecutor(workers) as pool:
        rank = list(pool.map(lambda one: _rank(question, one), found))
    ranked = [found[k] for k in sorted(range(len(found)), key=lambda k: rank[k])]
    good: list[Found] = []
    tries: dict[tuple[str, int, int], int] = {}
    known = set()
    share = min((r.share for r in question.geometry), default=0.0)
    for one in ranked:
        p = one.constellation.pattern
        assert p is not None
        name = (p.kind, p.planes, p.phasing)
        tried = tries.get(name, 0)
        if len(good) >= wanted or sum(tries.values()) >= MOST_CERTIFIED:
            break
        if tried >= TRIES or (tries and is_hopeless(np.array(one.sampled), share)):
            continue
        shape = _shape(one.constellation)
        if shape in known:  # the same satellites, numbered or turned otherwise
            continue
        known.add(shape)
        verdicts, failed = _verdicts(question, one)
        tries[name] = tried + 1
        lost = None if failed else _lost(question, one)
        if lost and "days" not in kept:
            kept["days"] = KeptOut(
                one.constellation,
                f"left alone on real orbits, no proof of {lost.requirement.wanted} for "
                f"{question.days:g} days ({lost.requirement.name})",
            )
        if failed is not None and "geometry" not in kept:
            kept["geometry"] = KeptOut(one.constellation, _why(failed))
        if not failed and not lost:
            tries[name] = TRIES
            good.append(replace(one, verdicts=verdicts))
    if not question.geometry:
        good.sort(key=lambda one: -(one.margin or 0.0))
    return good


def _shape(c: Constellation) -> tuple[float, bytes]:
    """What twins have in common: node (over the ground), and how far every two satellites are."""
    raan = float(np.round(c.raan[0], 9)) if c.repeat is not None else 0.0
    pairs = np.round(np.stack(pair_cosines(c), axis=-1), 9) + 0.0
    return raan, pairs[np.lexsort(pairs.T)].tobytes()


def _keep_out(question: Question, bare: Sequence[Found], kept: dict[str, KeptOut]) -> None:
    """Note the first that has the folds proven, and by what its geometry fails."""
    for one in _folded(question, bare, 1)[:1]:
        _, failed = _verdicts(question, one)
        if failed is not None:
            kept["geometry"] = KeptOut(one.constellation, _why(failed))


def _verdicts(question: Question, one: Found) -> tuple[tuple[Verdict, ...], Verdict | None]:
    """Verdicts in the order of the requirements, geometry settled first; the first not met."""
    design = question.design(one.constellation)
    known: dict[int, Verdict] = {}
    numbers = range(len(question.requirements))
    order = sorted(numbers, key=lambda k: not question.requirements[k].limits)
    for k in order:
        effort = Effort(budget_s=question.budget_s)  # one each: it keeps what was left open
        known[k] = verdict_of(design, question.requirements[k], effort=effort)
        if known[k].met is not True:
            return (), known[k]
    return tuple(known[k] for k in range(len(order))), None


def _lost(question: Question, one: Found) -> Verdict | None:
    """The first requirement that is not proven to hold for the days wanted on real orbits.

    Under all forces, with nobody to steer, and trimmed once where that helps.
    """
    if question.days is None:
        return None
    design = question.design(left_alone(one.constellation, question.days))
    design = replace(design, motion=real_motion())
    for wanted in question.requirements:
        effort = Effort(budget_s=question.budget_s)
        verdict = verdict_of(design, wanted, days=question.days, effort=effort)
        if verdict.met is not True:
            return verdict
    return None


def _why(verdict: Verdict) -> str:
    wanted, worst = verdict.requirement, verdict.worst
    if verdict.met is None:
        return f"{wanted.name} is undecided: {verdict.reason}"
    if verdict.share is not None:
        percent = 100 * verdict.share[1]
        return f"{wanted.wanted} for at most {percent:.2f} % ({wanted.name})"
    assert worst is not None  # what is refuted has a witness
    place = f"latitude {np.degrees(worst.latitude):.1f} deg"
    return f"{wanted.wanted} broken at {place} ({wanted.name})"


def _rank(question: Question, one: Found) -> tuple[float, ...]:
    """Where a candidate stands: more good samples, the worst better, more room for its folds."""
    if question.geometry:
        return -one.sampled, one.worst
    c, room = one.constellation, np.inf
    design = question.design(c)
    for wanted in question.always:
        assert wanted.fold is not None
        for users in users_of(design, wanted):
            span = None
            if c.repeat is not None and not users.is_belt:
                course = course_of(design, None, 0.0)
                span = course.span if course is not None else None
            asked = users if span is not None else users.belt()
            about = least_clearance(c, asked, wanted.fold, span=span, tolerance=3e-3, most=20_000)
            room = min(room, about.high)
    return -one.sampled, -room

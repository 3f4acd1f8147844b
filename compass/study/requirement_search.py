"""The smallest constellations that meet requirements: every pattern of every size, proven.

For each size, every pattern at every inclination, and where tracks are closed every turn over the
ground, is looked at at random moments, the first of which refutes most. Those left are asked for
the folds wanted always, proven by boxes; they must keep their satellites apart and have the
geometry wanted: the samples put the most promising first, certified figures decide. The first size
at which something is met is the smallest.
"""

from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import replace
from typing import Any

import numpy as np

from compass.allowed import check_all_allowed
from compass.cores import shared
from compass.coverage.certified_effort import Effort
from compass.coverage.clearance import least_clearance
from compass.coverage.fold_verdict import course_of, fold_always_met, users_of
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.orbits.kinds import kind_of
from compass.orbits.motion import Motion
from compass.study.lasting import paths_left_alone
from compass.study.requirement_patterns import grids, sampled
from compass.study.requirement_question import KeptOut, Outcome, Question, Trial
from compass.study.requirement_samples import is_hopeless
from compass.study.search import pair_cosines
from compass.words import counted, latitude_words

#: Candidates of a size whose figures are certified at most, the most promising first; and
#: inclinations or turns of one pattern.
MOST_CERTIFIED, TRIES = 16, 2

#: Boxes for the room of a candidate.
ROOM_BOXES = 20_000

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
    met: list[Trial] = []
    looked_at = 0
    for size in progress(range(question.least, question.largest + 1)):
        tried = list(grids(question, size))
        looked_at += sum(len(grid.inclinations) for grid in tried)
        # without a fold wanted always any few satellites would be worth a word
        unknown = bool(question.geometry and question.always) and "geometry" not in kept
        able, bare = sampled(question, tried, workers, unknown)
        _keep_out(question, bare[:BARE], kept)
        apart = [one for one in able if one.closest_approach >= question.least_approach]
        close = [one for one in able if one.closest_approach < question.least_approach]
        if "close" not in kept and (first := _first_folded(question, close, workers)):
            angle = np.degrees(first.closest_approach)
            kept["close"] = KeptOut(
                first.constellation, f"two satellites come within {angle:.2f} deg of each other"
            )
        good = _certified(question, apart, finalists if not met else 1, workers, kept)
        if met and (good or len(met) > 1):
            next_best = good[0] if good else None
            return Outcome(tuple(met), next_best, tuple(kept.values()), looked_at)
        met = met or good
    return Outcome(tuple(met), None, tuple(kept.values()), looked_at)


def _check(question: Question, finalists: int) -> None:
    check_all_allowed(
        max_satellites=question.largest, least_approach_deg=np.degrees(question.least_approach)
    )
    if finalists < 1:  # a fold alone may do without
        raise ArgumentError(f"finalists = {finalists}: must be 1 or more")
    for kind in question.kinds:
        kind_of(kind)


def _first_folded(question: Question, found: Sequence[Trial], workers: int) -> Trial | None:
    """The first candidate with every fold that is wanted always; None if none has."""
    with closing(shared(lambda one: _holds(question, one), found, workers)) as held:
        return next((one for one, holds in zip(found, held, strict=True) if holds), None)


def _holds(question: Question, one: Trial) -> bool:
    """Whether a candidate has every fold that is wanted always."""
    if not question.always:
        return True
    design = question.design(one.constellation)
    course = course_of(design, None, 0.0)
    assert course is not None
    return all(
        fold_always_met(one.constellation, users_of(design, wanted), wanted, course)
        for wanted in question.always
    )


def _certified(
    question: Question,
    found: list[Trial],
    wanted: int,
    workers: int,
    kept: dict[str, KeptOut],
) -> list[Trial]:
    """The best of a size that meet everything, of different patterns."""
    by_pattern: dict[tuple[str, int, int], list[Trial]] = {}
    for one in found:
        by_pattern.setdefault(_name(one), []).append(one)
    best = shared(lambda some: _best(question, some), by_pattern.values(), workers)
    placed = sorted((pair for pairs in best for pair in pairs), key=lambda pair: pair[0])
    ranked = [one for _, one in placed]
    good: list[Trial] = []
    tries: dict[tuple[str, int, int], int] = {}
    known = set()
    share = min((r.share for r in question.geometry), default=0.0)
    for one in ranked:
        name = _name(one)
        tried = tries.get(name, 0)
        if len(good) >= wanted or sum(tries.values()) >= MOST_CERTIFIED:
            break
        if tried >= TRIES or (tries and is_hopeless(np.array(one.sampled), share)):
            continue
        shape = _shape(one.constellation)
        if shape in known:  # the same satellites, numbered or turned otherwise
            continue
        if not _holds(question, one):
            continue
        known.add(shape)
        verdicts, failed = _verdicts(question, one)
        tries[name] = tried + 1
        lost = None if failed else _lost(question, one)
        if lost and question.days and "days" not in kept:
            kept["days"] = KeptOut(
                one.constellation,
                f"left alone on real orbits, no proof of {lost.requirement.wanted} for "
                f"{counted(question.days, 'day')} ({lost.requirement.name})",
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


def _keep_out(question: Question, bare: Sequence[Trial], kept: dict[str, KeptOut]) -> None:
    """Note the first that has the folds proven, and by what its geometry fails."""
    if one := _first_folded(question, bare, 1):
        _, failed = _verdicts(question, one)
        if failed is not None:
            kept["geometry"] = KeptOut(one.constellation, _why(failed))


def _verdicts(question: Question, one: Trial) -> tuple[tuple[Verdict, ...], Verdict | None]:
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


def _lost(question: Question, one: Trial) -> Verdict | None:
    """The first requirement that is not proven to hold for the days wanted on real orbits.

    Under all forces, with nobody to steer, and trimmed once where that helps.
    """
    if question.days is None:
        return None
    design = question.design(one.constellation)
    folds_first = sorted(question.requirements, key=lambda wanted: bool(wanted.limits))
    for days, path in paths_left_alone(one.constellation, question.days):
        flown = replace(design, motion=Motion("ephemeris", table=path))
        for wanted in folds_first:
            if wanted.limits and days < question.days:
                continue
            effort = Effort(budget_s=question.budget_s)
            verdict = verdict_of(flown, wanted, days=days, effort=effort)
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
    place = latitude_words(float(np.degrees(worst.latitude)), ".1f")
    return f"{wanted.wanted} broken at {place} ({wanted.name})"


def _name(one: Trial) -> tuple[str, int, int]:
    """Which pattern a candidate is of, at whatever inclination and turn."""
    p = one.constellation.pattern
    assert p is not None
    return p.kind, p.planes, p.phasing


def _best(question: Question, some: Sequence[Trial]) -> list[tuple[tuple[float, ...], Trial]]:
    """Candidates of one pattern that may be tried, each with its place: the lowest first.

    Those of more good samples, the worst better; then of more room for the folds. Of folds alone no
    more than `TRIES` are looked for: what the first glance at a candidate shows is no less than its
    room, so that most need no second one.
    """
    if question.geometry:
        return [((-one.sampled, one.worst), one) for one in some]
    if len(question.always) < len(question.requirements):
        return [((-one.sampled, -_room(question, one, ROOM_BOXES)), one) for one in some]
    hopes = [_room(question, one, 0) for one in some]
    best: list[tuple[float, int]] = []
    for k in sorted(range(len(some)), key=lambda k: -hopes[k]):
        if hopes[k] < 0.0 or (len(best) == TRIES and hopes[k] < -best[-1][0]):
            break
        if _holds(question, some[k]):
            best = sorted([*best, (-_room(question, some[k], ROOM_BOXES), k)])[:TRIES]
    return [((-some[k].sampled, room), some[k]) for room, k in best]


def _room(question: Question, one: Trial, most: int) -> float:
    """Least clearance that a look of so many boxes shows for the folds wanted, radians: or less."""
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
            about = least_clearance(c, asked, wanted.fold, span=span, tolerance=3e-3, most=most)
            room = min(room, about.high)
    return room

"""The smallest constellations that meet requirements: every pattern of every size, proven.

For each size, every pattern at every inclination, and where tracks are closed every turn over the
ground, is asked for the folds wanted always: proven by boxes, most refuted by the first few. What
is left must keep its satellites apart and have the geometry wanted: random samples put the most
promising first, certified figures decide. The first size at which something is met is the smallest.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compass.coverage.clearance import least_clearance
from compass.coverage.fold_verdict import course_of, fold_always_met, users_of
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.design import Design, Requirement
from compass.errors import ArgumentError
from compass.frames import Figure
from compass.orbits import Constellation, Pattern
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import kind_of
from compass.orbits.symmetry import shifts
from compass.sites import Mask
from compass.study.requirement_samples import is_hopeless, sampled_geometry
from compass.study.search import MOST_SATELLITES, closest_approach, pair_cosines

#: Step of inclinations and of turns over the ground, degrees.
STEP, TURN_STEP = 1.0, 3.0

#: Candidates of a size whose figures are certified at most, the most promising first; and
#: inclinations or turns of one pattern.
MOST_CERTIFIED, TRIES = 16, 2


@dataclass(frozen=True)
class Found:
    """A constellation and how it does.

    Attributes
    ----------
    constellation
        The pattern.
    closest_approach
        Least angle between two satellites at any time, radians.
    verdicts
        On each requirement; empty if it was kept out before.
    sampled
        Share of random samples with the geometry wanted, the least of all requirements; 1 without.
    """

    constellation: Constellation
    closest_approach: float
    verdicts: tuple[Verdict, ...] = ()
    sampled: float = 1.0

    @property
    def met(self) -> bool:
        """Whether all requirements are met."""
        return bool(self.verdicts) and all(v.met is True for v in self.verdicts)

    @property
    def margin(self) -> float | None:
        """Least proven margin of its folds, radians."""
        margins = [v.margin for v in self.verdicts if v.margin is not None]
        return min(margins) if margins else None

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        p = self.constellation.pattern
        assert p is not None
        margin = self.margin
        return {
            "pattern": p.kind,
            "satellites": p.satellites,
            "planes": p.planes,
            "phasing": p.phasing,
            "inclination_deg": round(float(np.degrees(p.inclination)), 6),
            "raan_deg": round(float(np.degrees(p.raan)), 6),
            "radius_km": float(self.constellation.semi_major_axis[0]) / 1e3,
            "notation": p.notation,
            "closest_approach_deg": float(np.degrees(self.closest_approach)),
            "margin_deg": None if margin is None else float(np.degrees(margin)),
            "met": self.met,
            "requirements": [verdict.as_dict() for verdict in self.verdicts],
        }


@dataclass(frozen=True)
class KeptOut:
    """The smallest constellation that was kept out for a reason, and what it is."""

    constellation: Constellation
    reason: str


@dataclass(frozen=True)
class Outcome:
    """What a search found.

    Attributes
    ----------
    met
        Of the smallest size that meets all, the best first; empty if none does.
    next_best
        The best of the next size that meets all, or None.
    kept_out
        Smaller ones, or equal, that have the folds and were kept out.
    looked_at
        Patterns at an inclination and a turn.
    """

    met: tuple[Found, ...]
    next_best: Found | None
    kept_out: tuple[KeptOut, ...]
    looked_at: int


@dataclass(frozen=True)
class Question:
    """What is looked for.

    Attributes
    ----------
    requirements, figure, mask
        As of a design.
    radius, repeat
        Of the circular orbits, metres; and how their tracks close, if that is declared.
    least_approach
        Least angle that must lie between two satellites at any time, radians.
    kinds
        Kinds of pattern.
    largest
        Largest size.
    """

    requirements: tuple[Requirement, ...]
    figure: Figure
    mask: Mask
    radius: float
    repeat: tuple[int, int] | None
    least_approach: float
    kinds: tuple[str, ...]
    largest: int

    @property
    def always(self) -> tuple[Requirement, ...]:
        """The folds wanted always."""
        return tuple(r for r in self.requirements if r.fold is not None and r.share == 1.0)

    @property
    def geometry(self) -> tuple[Requirement, ...]:
        """What is wanted of geometry."""
        return tuple(r for r in self.requirements if r.limits)

    @property
    def least(self) -> int:
        """Fewest satellites that could do."""
        folds = [(r.fold or 0) + r.losses for r in self.requirements]
        return max([*folds, *(4 + r.losses for r in self.geometry), 1])

    def design(self, constellation: Constellation) -> Design:
        """Design of a candidate."""
        return Design(constellation, figure=self.figure, mask=self.mask)


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
        candidates = list(_candidates(question, size))
        looked_at += len(candidates)
        folded = _folded(question, candidates, workers)
        found = [Found(c, closest_approach(c)) for c in folded]
        apart = [one for one in found if one.closest_approach >= question.least_approach]
        for one in found:
            if one.closest_approach < question.least_approach and "close" not in kept:
                angle = np.degrees(one.closest_approach)
                kept["close"] = KeptOut(
                    one.constellation, f"two satellites come within {angle:.2f} deg of each other"
                )
        good = _certified(question, apart, finalists if not met else 1, workers, kept)
        if met and good:
            return Outcome(tuple(met), good[0], tuple(kept.values()), looked_at)
        if met:
            return Outcome(tuple(met), None, tuple(kept.values()), looked_at)
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


def _candidates(question: Question, size: int) -> Iterable[Constellation]:
    """Every pattern of a size at every inclination, and at every turn where that counts."""
    seen = set()
    for kind in question.kinds:
        layout = kind_of(kind).layout
        for planes in (p for p in range(1, size + 1) if size % p == 0):
            for phasing in range(planes):
                if not kind_of(kind).writes(size, planes, phasing):
                    continue
                if (layout, planes, phasing) in seen:
                    continue
                seen.add((layout, planes, phasing))
                pattern = Pattern(layout, size, planes, phasing, 0.0)
                for raan in _turns(question, pattern):
                    for degrees in np.arange(0.0, 90.0 + 0.5 * STEP, STEP):
                        tilted = replace(pattern, inclination=float(np.radians(degrees)), raan=raan)
                        yield from_pattern(tilted, question.radius, repeat=question.repeat)


def _turns(question: Question, pattern: Pattern) -> list[float]:
    """Nodes of the first plane that are not alike over the ground; one where tracks do not close.

    In the time that a satellite takes for a phase, Mars turns by rotations over revolutions of it:
    nodes and phases together count as ``node + phase rotations/revolutions``.
    """
    if question.repeat is None:
        return [0.0]
    revolutions, rotations = question.repeat
    moves = shifts(from_pattern(replace(pattern, inclination=0.5), question.radius))
    part = rotations / revolutions
    along = np.concatenate([moves.turn + part * moves.phase, [2 * np.pi * part, 2 * np.pi]])
    rest = np.mod(along, 2 * np.pi)
    apart = np.sort(np.minimum(rest, 2 * np.pi))
    apart = apart[apart > 1e-6]
    width = float(apart[0]) if apart.size else 2 * np.pi
    count = max(1, int(np.ceil(width / np.radians(TURN_STEP))))
    return [width * k / count for k in range(count)]


def _folded(
    question: Question, candidates: Sequence[Constellation], workers: int
) -> list[Constellation]:
    """Candidates with every fold that is wanted always."""
    if not candidates or not question.always:
        return list(candidates)
    # who is asked, and for how long, is the same for all
    design = question.design(candidates[0])
    course = course_of(design, None, 0.0)
    assert course is not None
    users = [users_of(design, wanted) for wanted in question.always]

    def holds(c: Constellation) -> bool:
        return all(
            fold_always_met(c, places, wanted, course)
            for places, wanted in zip(users, question.always, strict=True)
        )

    with ThreadPoolExecutor(workers) as pool:
        kept = list(pool.map(holds, candidates, chunksize=64))
    return [c for c, keep in zip(candidates, kept, strict=True) if keep]


def _certified(
    question: Question,
    found: list[Found],
    wanted: int,
    workers: int,
    kept: dict[str, KeptOut],
) -> list[Found]:
    """The best of a size that meet everything, of different patterns."""
    with ThreadPoolExecutor(workers) as pool:
        ranked = list(pool.map(lambda one: _ranked(question, one), found))
    ranked.sort(key=lambda one: one[0])
    good: list[Found] = []
    tries: dict[tuple[str, int, int], int] = {}
    known = set()
    share = min((r.share for r in question.geometry), default=0.0)
    for _, one in ranked:
        p = one.constellation.pattern
        assert p is not None
        name = (p.kind, p.planes, p.phasing)
        tried = tries.get(name, 0)
        if len(good) >= wanted or sum(tries.values()) >= MOST_CERTIFIED:
            break
        if tried >= TRIES or (tries and is_hopeless(one.sampled, share)):
            continue
        shape = _shape(one.constellation)
        if shape in known:  # the same satellites, numbered or turned otherwise
            continue
        known.add(shape)
        verdicts, failed = _verdicts(question, one)
        tries[name] = tried + 1
        if failed is None:
            tries[name] = TRIES
            good.append(replace(one, verdicts=verdicts))
        elif "geometry" not in kept:
            kept["geometry"] = KeptOut(one.constellation, _why(failed))
    if not question.geometry:
        good.sort(key=lambda one: -(one.margin or 0.0))
    return good


def _shape(c: Constellation) -> tuple[float, bytes]:
    """What twins have in common: node (over the ground), and how far every two satellites are."""
    raan = float(np.round(c.raan[0], 9)) if c.repeat is not None else 0.0
    pairs = np.round(np.stack(pair_cosines(c), axis=-1), 9) + 0.0
    return raan, pairs[np.lexsort(pairs.T)].tobytes()


def _verdicts(question: Question, one: Found) -> tuple[tuple[Verdict, ...], Verdict | None]:
    """Verdicts in the order of the requirements, geometry settled first; the first not met."""
    design = question.design(one.constellation)
    known: dict[int, Verdict] = {}
    numbers = range(len(question.requirements))
    order = sorted(numbers, key=lambda k: not question.requirements[k].limits)
    for k in order:
        known[k] = verdict_of(design, question.requirements[k])
        if known[k].met is not True:
            return (), known[k]
    return tuple(known[k] for k in range(len(order))), None


def _why(verdict: Verdict) -> str:
    if verdict.met is None or verdict.share is None:
        return f"{verdict.requirement.name} is undecided: {verdict.reason}"
    percent = 100 * verdict.share[1]
    return f"{verdict.requirement.wanted} for at most {percent:.2f} % ({verdict.requirement.name})"


def _ranked(question: Question, one: Found) -> tuple[tuple[float, ...], Found]:
    """Where a candidate stands: more samples with good geometry, the worst better, more room."""
    c, share, room, worst = one.constellation, 1.0, np.inf, 0.0
    design = question.design(c)
    for wanted in question.geometry:
        for users in users_of(design, wanted):
            found, most = sampled_geometry(c, users, wanted)
            share, worst = min(share, found), max(worst, most)
    for wanted in () if question.geometry else question.always:
        assert wanted.fold is not None
        for users in users_of(design, wanted):
            span = None
            if c.repeat is not None and not users.is_belt:
                course = course_of(design, None, 0.0)
                span = course.span if course is not None else None
            asked = users if span is not None else users.belt()
            about = least_clearance(c, asked, wanted.fold, span=span, tolerance=3e-3, most=20_000)
            room = min(room, about.high)
    return (-share, worst, -room), replace(one, sampled=share)

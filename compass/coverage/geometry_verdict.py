"""Whether a dilution of precision, or an error, is small enough, always or for long enough.

Errors are asked about of ranges that are no better than they ever are, as with the Sun overhead of
all users, when the ionosphere delays most, and of those that are no worse, as with the Sun set:
what is kept by the first is kept, what is broken by the second is broken.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import FOLD_PER_SHARE, Effort
from compass.coverage.certified_places import Circle, Spot
from compass.coverage.certified_ranges import (
    ERROR_DOPS,
    Ranges,
    sigma_allowed,
    skies_of,
)
from compass.coverage.certified_rounds import ended
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.certified_witness import WorstWitness, in_view
from compass.coverage.certified_worst import CertifiedAlways
from compass.coverage.certified_worst_place import certified_worst_place
from compass.coverage.fold_verdict import Course, course_of, losses_of, users_of
from compass.coverage.protection import LEVELS
from compass.coverage.region import latitude_band
from compass.coverage.sampled_verdict import sampled_verdict
from compass.coverage.users import Users, by_horizon, centric, geodetic
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design
from compass.errors import said_of
from compass.orbits import Constellation
from compass.orbits.symmetry import alike_longitudes, one_circle
from compass.requirement import DILUTIONS, Requirement
from compass.sites import Site
from compass.words import counted

#: Boxes for each share, and for that at the worst of several places; and how near bounds of shares
#: are to come where the requirement leaves it open.
SHARE_BOXES, WORST_BOXES, WIDTH = 600_000, 500_000, 1e-4

#: How near bounds of the share at the worst place come where that is wanted, and where it is open
#: on which side of the share wanted they are.
WORST_WIDTH, WORST_FINEST = 1e-3, 1e-5

#: What satellites in view are called among figures; so many or more keep their limit.
FOLD = "fold"

#: How near bounds of the largest value come, relative to it.
LARGEST = 1e-2


Span = tuple[float, float] | None


@dataclass(frozen=True)
class _Asked:
    """A figure and its largest value allowed, and how it is found.

    Attributes
    ----------
    name, limit
        One of `compass.requirement.LIMITS`, and its limit as kernels of figures take it.
    title
        Of the figure, in words.
    factor
        What values found are multiplied by to mean what the requirement does.
    skies
        Ranges that errors are of, no better than they are and, where that differs, no worse; of a
        dilution None.
    """

    name: str
    limit: float
    title: str
    factor: float
    skies: tuple[Ranges | None, ...]

    def share(
        self,
        effort: Effort,
        left: Constellation,
        lost: Sequence[int],
        where: dict[str, Any],
        width: float,
        level: float,
    ) -> CertifiedShare:
        """Share with the figure small enough, wherever the Sun stands, its bounds so near.

        By fold, of which rims are nearly everywhere, so near only where they lie on both sides of
        `level`.
        """
        if self.name == FOLD and effort.width is None:
            coarse = effort.share(
                left, self.limit, width=FOLD_PER_SHARE * width, **self._asked(None, lost), **where
            )
            if coarse.stopped or not coarse.low < level <= coarse.high:
                return coarse
        found = [
            effort.share(left, self.limit, width=width, **self._asked(sky, lost), **where)
            for sky in self.skies
        ]
        return found[0] if len(found) == 1 else replace(found[0], high=found[1].high)

    def worst_place(
        self,
        effort: Effort,
        left: Constellation,
        lost: Sequence[int],
        where: dict[str, Any],
        level: float,
        thorough: bool,
    ) -> tuple[CertifiedShare, float]:
        """Share of time with the figure small enough where that is least, and the latitude.

        Bounds of each sky, until they tell whether it is a share of `level` or more; if `thorough`
        until they are near one another too.
        """
        width, narrow = (WORST_FINEST, WORST_WIDTH) if thorough else (WORST_WIDTH, inf)
        found = [
            certified_worst_place(
                left,
                self.limit,
                level,
                effort=effort,
                width=width,
                narrow=narrow,
                **self._asked(sky, lost),
                **where,
            )
            for sky in self.skies
        ]
        if len(found) == 1:
            return found[0]
        return replace(found[0][0], high=found[1][0].high), found[0][1]

    def always(
        self, effort: Effort, left: Constellation, lost: Sequence[int], where: dict[str, Any]
    ) -> CertifiedAlways:
        """Claim that it is always small enough: proven by the first sky, refuted by the last."""
        claim = effort.always(left, self.limit, **self._asked(self.skies[0], lost), **where)
        if len(self.skies) > 1 and claim.outcome == Outcome.REFUTED:
            claim = effort.always(left, self.limit, **self._asked(self.skies[1], lost), **where)
            if claim.outcome == Outcome.PROVEN:  # of the better ranges alone
                return replace(claim, outcome=Outcome.UNDECIDED)
        return claim

    def largest(
        self, effort: Effort, left: Constellation, lost: Sequence[int], where: dict[str, Any]
    ) -> tuple[WorstWitness | None, float]:
        """Where and when it is largest, of ranges no worse than they are, and an upper bound."""
        found = [
            effort.worst(left, precision=LARGEST, **self._asked(sky, lost), **where)
            for sky in self.skies
        ]
        return found[-1].witness, found[0].high

    def _asked(self, sky: Ranges | None, lost: Sequence[int]) -> dict[str, Any]:
        return {"dop": self.name, "ranges": None if sky is None else sky.without(lost)}


def _question(
    design: Design, requirement: Requirement, name: str, limit: float, span: Span, height: float
) -> _Asked:
    if name == FOLD:
        return _Asked(name, limit, f"{counted(int(limit), 'satellite')} in view", 1.0, (None,))
    title = f"{requirement.titled(name)} small enough"
    if name not in ERROR_DOPS:
        return _Asked(name, limit, title, 1.0, (None,))
    allowed = sigma_allowed(requirement, limit)
    return _Asked(name, allowed, title, limit / allowed, skies_of(design, span, height))


def geometry_verdict(
    design: Design,
    requirement: Requirement,
    name: str,
    limit: float,
    *,
    days: float | None = None,
    start_day: float = 0.0,
    effort: Effort | None = None,
    width: float = WIDTH,
    thorough: bool = False,
    by_samples: bool = False,
) -> Verdict:
    """Verdict on a dilution of precision, or an error, of at most a limit, by certified shares.

    Parameters
    ----------
    design, requirement, days, start_day, effort
        As in `compass.coverage.requirement_verdict.verdict_of`.
    name, limit
        One of `compass.requirement.LIMITS` and the largest value allowed, or `FOLD` and the fewest.
    width
        How near the bounds of each share are to come where `effort` does not say.
    thorough
        Whether the largest value is found of what is always kept or is missed; and `by_samples`.
    by_samples
        Whether what nothing certifies, protection levels and errors of users who look down from
        orbit, is settled by samples (`compass.coverage.sampled_verdict`), or left open.

    Raises
    ------
    ArgumentError
        As `certified_share`; an error of a design without a signal.
    """
    effort, c = effort or Effort(), design.constellation
    course = course_of(design, days, start_day)
    if course is None:
        title = requirement.titled(name)
        reason = f"{title} is certified for ever for orbits of one period alone; give days"
        return undecided(requirement, f"under {design.motion.title}", reason)
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]] = []
    claims: list[_Claim] = []
    everyone = users_of(design, requirement)
    if not _is_certified(name, everyone):
        if thorough or by_samples:
            sets = losses_of(c, requirement, everyone, course, alike=name in DILUTIONS)
            return sampled_verdict(
                design, requirement, name, limit, everyone, [one[:2] for one in sets], course
            )
        reason = f"{requirement.titled(name)} of these users is not certified, but sampled by "
        reason += "`compass check`"
        return undecided(requirement, course.words, reason)
    height = max(users.height for users in everyone)
    asked = _question(design, requirement, name, limit, course.span, height)
    sky = asked.skies[0]
    same = sky is None or sky.keeps_symmetry
    for lost, alike, left in losses_of(c, requirement, everyone, course, alike=same):
        gone = [c.satellite_names.index(satellite) for satellite in lost]
        with said_of(requirement.name):
            for users in everyone:
                seen = by_horizon(users, design.constellation, design.motion)
                by_place = requirement.share < 1.0 and requirement.share_of == "time"
                among = by_place and users.south != users.north
                where = asked_place(seen, course)
                if among:
                    where = _worst_asked(seen, course, left if same else None)
                where |= {
                    "figure": users.figure,
                    "mask": seen.mask,
                    "beam": seen.beam,
                    "budget_boxes": WORST_BOXES if among else SHARE_BOXES,
                    "motion": design.motion,
                }
                if "south" in where:
                    share, latitude = asked.worst_place(
                        effort, left, gone, where, requirement.share, thorough
                    )
                    there = geodetic(latitude, users.figure)
                    found.append((share, replace(users, south=there, north=there), lost, alike))
                    continue
                if requirement.share == 1.0:
                    claim = asked.always(effort, left, gone, where)
                    claims.append(_Claim(claim, users, left, lost, alike, gone, where))
                    if claim.outcome != Outcome.UNDECIDED:
                        continue
                share = asked.share(effort, left, gone, where, width, requirement.share)
                found.append((share, users, lost, alike))
    scope = course.words
    if sky is not None:
        scope += "; of a fix that weighs ranges by their variances, wherever the Sun stands"
    settled = _always(design, requirement, asked, scope, claims, effort if thorough else None)
    return settled or _verdict(requirement, asked, scope, found)


def asks_for_folds(
    design: Design, requirement: Requirement, days: float | None, start_day: float
) -> bool:
    """Whether satellites in view are wanted for a share that is a figure like a dilution's.

    Not always, where clearances say by how much.
    """
    everyone = users_of(design, requirement)
    return (
        requirement.share < 1.0
        and course_of(design, days, start_day) is not None
        and _is_certified(FOLD, everyone)
    )


def certified(design: Design, requirement: Requirement) -> bool:
    """Whether bounds are known of all figures that a requirement limits."""
    everyone = users_of(design, requirement)
    return all(_is_certified(name, everyone) for name, _ in requirement.limits)


def _is_certified(name: str, everyone: Sequence[Users]) -> bool:
    """Whether bounds of a figure are known: of errors not below the level, of levels never."""
    level = name in (*DILUTIONS, FOLD) or all(users.mask.lowest >= 0.0 for users in everyone)
    return name not in LEVELS and level


@dataclass(frozen=True)
class _Claim:
    """What came of a figure wanted always: whose, and after which loss, for how many alike."""

    found: CertifiedAlways
    users: Users
    left: Constellation
    lost: tuple[str, ...]
    alike: int
    gone: Sequence[int]
    where: dict[str, Any]


def _always(
    design: Design,
    requirement: Requirement,
    asked: _Asked,
    scope: str,
    claims: list[_Claim],
    effort: Effort | None,
) -> Verdict | None:
    """Verdict where one claim is refuted, or all are proven; None where that is open.

    With an effort for it the largest value is found: of all claims, or of the one missed most.
    """
    missed = [one for one in claims if one.found.outcome == Outcome.REFUTED and one.found.witness]
    if missed:
        missed = [max(missed, key=_shown)]
    elif not claims or any(one.found.outcome != Outcome.PROVEN for one in claims):
        return None
    looked = missed or claims
    highest = max(looked, key=_shown)
    w, highs = highest.found.witness, []
    if effort is not None:
        for one in looked:
            witness, high = asked.largest(effort, one.left, one.gone, one.where)
            highs.append(high * asked.factor)
            if witness is not None and (w is None or witness.value > w.value):
                highest, w = one, witness
    if w is None or not (missed or highs):
        return Verdict(requirement, True, "proven", scope, (1.0, 1.0))
    users = highest.users
    place = Site("", w.latitude, w.longitude, users.height, users.mask, users.figure)
    _, around = in_view(highest.left, place, w.time, design.motion)
    worst = Worst(
        w.time,
        w.latitude,
        w.longitude,
        w.value * asked.factor,
        asked.name,
        seen=len(w.satellites),
        around=len(around),
        most=max(highs) if len(highs) == len(claims) else None,
    )
    lost, alike, share = highest.lost, highest.alike, None if missed else (1.0, 1.0)
    return Verdict(requirement, not missed, "proven", scope, share, None, worst, lost, alike)


def _shown(claim: _Claim) -> float:
    """Largest value that was seen."""
    return -inf if claim.found.witness is None else claim.found.witness.value


def _worst_asked(users: Users, course: Course, c: Constellation | None) -> dict[str, Any]:
    """Among which places the worst is looked for, as `certified_worst_place` asks.

    Of satellites that are alike but for their places, some longitudes may stand for all; and of
    circles, half a revolution later seen from the other side of the equator, north for south.
    """
    south, north = (centric(b, users.figure) for b in (users.south, users.north))
    asked: dict[str, Any] = {"height": users.height, "south": south, "north": north}
    if course.span is not None:
        start, stop = course.span
        asked |= {"since": start, "duration": stop - start, "region": users.region}
        if c is not None and c.repeat is not None and course.for_ever and users.is_belt:
            asked["longitudes"] = alike_longitudes(c, *c.repeat)
            if one_circle(c) and users.alike_all_around and south < 0.0 < north:
                asked |= {"south": 0.0, "north": max(-south, north)}
    return asked


def asked_place(users: Users, course: Course) -> dict[str, Any]:
    """Where and when users are looked at, as certified figures ask."""
    south, north = (centric(b, users.figure) for b in (users.south, users.north))
    asked: dict[str, Any] = {"height": users.height}
    # what holds for ever at all longitudes needs no span
    if course.span is not None and not (course.for_ever and users.is_belt):
        start, stop = course.span
        asked |= {"since": start, "duration": stop - start}
    if users.south == users.north:
        if users.longitude is None or "duration" not in asked:
            return asked | {"place": Circle(south)}
        return asked | {"place": Spot(south, users.longitude)}
    if users.is_belt:
        return asked | {"place": latitude_band(south, north)}
    return asked | {"place": users.region}


def _verdict(
    requirement: Requirement,
    asked: _Asked,
    scope: str,
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]],
) -> Verdict:
    """Verdict of the shares of all users, after all losses."""
    low = min(share.low for share, *_ in found)
    least, users, lost, alike = min(found, key=lambda one: one[0].high)
    high, wanted = least.high, requirement.share
    if requirement.share_of == "area-time" and wanted < 1.0:  # a mean lies between its parts
        parts: dict[tuple[str, ...], list[float]] = {}
        for share, _, without, _ in found:
            parts.setdefault(without, []).append(share.high)
        high = min(max(highs) for highs in parts.values())
    met = True if low >= wanted else False if high < wanted else None
    verdict = Verdict(requirement, met, "bracket", scope, (low, high), None, None, lost, alike)
    if users.south == users.north:
        latitude = centric(users.south, users.figure)
        verdict = replace(verdict, worst=Worst(None, latitude, None, least.high, "share"))
    if met is None:
        reason = f"the share with {asked.title} lies between {low:.6g} and {high:.6g}"
        if least.stopped:
            reason += f"; {ended(least.stopped)}; `compass check --budget-s` looks longer"
        return replace(verdict, reason=reason, stopped=least.stopped)
    return verdict

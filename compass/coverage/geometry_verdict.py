"""Whether a dilution of precision, or an error, is small enough, always or for long enough."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Circle, Spot
from compass.coverage.certified_rounds import ended
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.certified_witness import in_view
from compass.coverage.certified_worst import CertifiedAlways
from compass.coverage.fold_verdict import (
    LOOKED_AT,
    MEETING,
    Course,
    course_of,
    losses_of,
    users_of,
)
from compass.coverage.protection import LEVELS
from compass.coverage.region import latitude_band
from compass.coverage.sampled_verdict import sampled_verdict
from compass.coverage.users import Users, by_horizon, centric, geodetic
from compass.coverage.value_limit import FOLD, ValueLimit, value_limit
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design
from compass.errors import said_of
from compass.orbits import Constellation
from compass.orbits.symmetry import alike_longitudes, one_circle, one_period
from compass.requirement import DILUTIONS, Requirement
from compass.sites import Site

#: Boxes for each share, and for that at the worst of several places; and how near bounds of shares
#: are to come where the requirement leaves it open.
SHARE_BOXES, WORST_BOXES, WIDTH = 600_000, 500_000, 1e-4


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
        orbit, and of users in beams that no horizon stands for what bounds leave open when they
        end early, is settled by samples (`compass.coverage.sampled_verdict`), or left open.

    Raises
    ------
    ArgumentError
        As `certified_share`; an error of a design without a signal.
    """
    effort, c = effort or Effort(), design.constellation
    course = course_of(design, days, start_day)
    if course is None:
        return _missed_soon(design, requirement, name, limit, effort)
    if requirement.losses >= c.size:
        reason = f"no satellite is left of {c.size}"
        return Verdict(requirement, False, "proven", course.words, (0.0, 0.0), reason=reason)
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]] = []
    claims: list[_Claim] = []
    everyone = users_of(design, requirement)

    def sampled() -> Verdict:
        sets = losses_of(c, requirement, everyone, course, alike=name in DILUTIONS)
        lost = [one[:2] for one in sets]
        return sampled_verdict(design, requirement, name, limit, everyone, lost, course)

    if not _is_certified(name, everyone):
        if thorough or by_samples:
            return sampled()
        reason = f"{requirement.titled(name)} of these users is not certified, but sampled by "
        reason += "`compass check`"
        return undecided(requirement, course.words, reason)
    height = max(users.height for users in everyone)
    asked = value_limit(design, requirement, name, limit, course.span, height)
    sky = asked.skies[0]
    same = sky is None or sky.keeps_symmetry
    for lost, alike, left in losses_of(c, requirement, everyone, course, alike=same):
        gone = [c.satellite_names.index(satellite) for satellite in lost]
        with said_of(requirement.name):
            for users in everyone:
                seen = by_horizon(users, design.constellation, design.motion)
                by_place = requirement.share < 1.0 and requirement.share_of == "time"
                among = by_place and users.south != users.north
                where = asked_place(seen, course, c)
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
    settled = settled or _verdict(requirement, asked, scope, found)
    in_beams = any(by_horizon(users, c, design.motion).beam is not None for users in everyone)
    ended_early = settled.met is None and settled.stopped and not effort.interrupted
    if in_beams and ended_early and name != FOLD and (thorough or by_samples):
        return _beside(settled, sampled(), everyone)
    return settled


def _missed_soon(
    design: Design, requirement: Requirement, name: str, limit: float, effort: Effort
) -> Verdict:
    """Verdict where nothing can be proven for ever: what is missed once is not always so."""
    if requirement.share == 1.0:
        some = geometry_verdict(design, requirement, name, limit, days=LOOKED_AT, effort=effort)
        if some.met is False:
            return some
    title = "so many in view" if name == FOLD else requirement.titled(name)
    reason = f"{title} is proven for ever of orbits that keep pace, or close; {MEETING}"
    return undecided(requirement, f"for ever, {design.motion.title}", reason)


def _beside(proof: Verdict, sampled: Verdict, everyone: Sequence[Users]) -> Verdict:
    """Verdict of samples beside a proof that is open, which stays where samples tell no more."""
    wanted, bounds, seen = proof.requirement, proof.share, sampled.share
    assert bounds is not None
    assert seen is not None
    together = wanted.share < 1.0 and wanted.share_of == "time"
    together &= any(users.south != users.north for users in everyone)
    if sampled.met is None and (together or bounds[1] - bounds[0] <= seen[1] - seen[0]):
        return proof
    said = f"no proof: the share surely lies between {bounds[0]:.6g} and {bounds[1]:.6g}; "
    said += f"{ended(proof.stopped)}; `compass check --budget-s` looks longer"
    return replace(sampled, scope=f"{sampled.scope}; {said}", stopped=proof.stopped)


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
    asked: ValueLimit,
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


def asked_place(users: Users, course: Course, c: Constellation) -> dict[str, Any]:
    """Where and when users are looked at, as certified figures ask."""
    south, north = (centric(b, users.figure) for b in (users.south, users.north))
    asked: dict[str, Any] = {"height": users.height}
    # what holds for ever at all longitudes needs no span
    if course.span is not None and not (course.for_ever and users.is_belt and one_period(c)):
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
    asked: ValueLimit,
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

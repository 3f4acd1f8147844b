"""Whether a dilution of precision is small enough, always or for long enough, for users."""

from dataclasses import replace
from typing import Any

from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Circle, Spot
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.certified_worst import CertifiedAlways
from compass.coverage.fold_verdict import Course, course_of, losses_of, users_of
from compass.coverage.region import latitude_band
from compass.coverage.users import Users, centric
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design, Requirement

#: Boxes for each share, and how near its bounds are to come where the requirement leaves it open.
SHARE_BOXES, WIDTH = 600_000, 1e-4


def geometry_verdict(
    design: Design,
    requirement: Requirement,
    dop: str,
    limit: float,
    *,
    days: float | None = None,
    start_day: float = 0.0,
    effort: Effort | None = None,
    width: float = WIDTH,
) -> Verdict:
    """Verdict on a dilution of precision of at most a limit, by certified shares.

    Parameters
    ----------
    design, requirement, days, start_day, effort
        As in `compass.coverage.requirement_verdict.verdict_of`.
    dop, limit
        One of `compass.design.LIMITS` and the largest value allowed.
    width
        How near the bounds of each share are to come where `effort` does not say.

    Raises
    ------
    ArgumentError
        As `certified_share`.
    """
    effort = effort or Effort()
    course = course_of(design, days, start_day)
    if course is None:
        reason = f"{dop.upper()} is certified for ever for orbits of one period alone; give days"
        return undecided(requirement, f"under {design.motion.title}", reason)
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]] = []
    claims: list[tuple[CertifiedAlways, tuple[str, ...], int]] = []
    everyone = users_of(design, requirement)
    for lost, alike, left in losses_of(design.constellation, requirement, everyone, course):
        for users in everyone:
            where = _place(users, requirement, course)
            if where is None:
                reason = f"{dop.upper()} of these users is not certified yet"
                return undecided(requirement, course.words, reason)
            asked: dict[str, Any] = {
                "dop": dop,
                "figure": users.figure,
                "mask": users.mask,
                "budget_boxes": SHARE_BOXES,
                "motion": design.motion,
                **where,
            }
            if requirement.share == 1.0:
                claim = effort.always(left, limit, **asked)
                claims.append((claim, lost, alike))
                if claim.outcome != Outcome.UNDECIDED:
                    continue
            share = effort.share(left, limit, width=width, **asked)
            found.append((share, users, lost, alike))
    settled = _always(requirement, course.words, claims)
    return settled or _verdict(requirement, dop, course.words, found)


def _always(
    requirement: Requirement,
    scope: str,
    claims: list[tuple[CertifiedAlways, tuple[str, ...], int]],
) -> Verdict | None:
    """Verdict where one claim is refuted, or all are proven; None where that is open."""
    for claim, lost, alike in claims:
        if claim.outcome == Outcome.REFUTED and claim.witness is not None:
            w = claim.witness
            worst = Worst(w.time, w.latitude, w.longitude, w.value)
            return Verdict(requirement, False, "proven", scope, None, None, worst, lost, alike)
    if claims and all(claim.outcome == Outcome.PROVEN for claim, *_ in claims):
        return Verdict(requirement, True, "proven", scope, (1.0, 1.0))
    return None


def _place(users: Users, requirement: Requirement, course: Course) -> dict[str, Any] | None:
    """Where and when a claim is looked at, as certified figures ask; None where they cannot yet."""
    if users.below < 0.0:
        return None
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
    if requirement.share_of == "time" and requirement.share < 1.0:
        return None
    if users.is_belt:
        return asked | {"place": latitude_band(south, north)}
    return asked | {"place": users.region} if "duration" in asked else None


def _verdict(
    requirement: Requirement,
    dop: str,
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
        verdict = replace(verdict, worst=Worst(None, latitude, None, least.value))
    if met is None:
        late = f", stopped early ({least.stopped})" if least.stopped else ""
        reason = f"the share with {dop.upper()} small enough lies between {low:.6g} and {high:.6g}"
        return replace(verdict, reason=reason + late)
    return verdict

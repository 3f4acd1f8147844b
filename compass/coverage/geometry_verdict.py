"""Whether a dilution of precision is small enough, always or for long enough, for users."""

from dataclasses import replace

from compass.coverage.certified_domain import Circle, Place
from compass.coverage.certified_share import CertifiedShare, certified_share
from compass.coverage.clearance import Users, centric
from compass.coverage.fold_verdict import course_of, losses_of, users_of
from compass.coverage.region import latitude_band
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
    budget_s: float | None = None,
) -> Verdict:
    """Verdict on a dilution of precision of at most a limit, by certified shares.

    Parameters
    ----------
    design, requirement, days, start_day, budget_s
        As in `compass.coverage.requirement_verdict.verdict_of`.
    dop, limit
        One of `compass.design.LIMITS` and the largest value allowed.

    Raises
    ------
    ArgumentError
        As `certified_share`.
    """
    course = None
    if design.motion.model in ("two-body", "j2"):
        course = course_of(design, days, start_day)
    if course is None or course.span is not None:
        scope = course.words if course is not None else f"under {design.motion.title}"
        reason = f"{dop.upper()} is certified for ever on circles of latitude alone"
        return undecided(requirement, scope, reason)
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]] = []
    everyone = users_of(design, requirement)
    for lost, alike, left in losses_of(design.constellation, requirement, everyone, course):
        for users in everyone:
            place = _place(users, requirement)
            if place is None:
                reason = f"{dop.upper()} of these users is not certified yet"
                return undecided(requirement, course.words, reason)
            share = certified_share(
                left,
                limit,
                dop=dop,
                figure=users.figure,
                mask=users.mask,
                place=place,
                width=WIDTH,
                budget_s=float("inf") if budget_s is None else budget_s,
                budget_boxes=SHARE_BOXES,
                drifting=design.motion.model == "j2",
            )
            found.append((share, users, lost, alike))
    return _verdict(requirement, dop, course.words, found)


def _place(users: Users, requirement: Requirement) -> Place | None:
    """Where the share is taken; None where it is not certified."""
    if users.height and users.longitude is None:
        return None
    if users.south == users.north:
        return None if users.height else Circle(centric(users.south, users.figure))
    if not users.is_belt or (requirement.share_of == "time" and requirement.share < 1.0):
        return None
    south, north = (centric(b, users.figure) for b in (users.south, users.north))
    return latitude_band(south, north)


def _verdict(
    requirement: Requirement,
    dop: str,
    scope: str,
    found: list[tuple[CertifiedShare, Users, tuple[str, ...], int]],
) -> Verdict:
    """Verdict of the shares of all users, after all losses."""
    low = min(share.low for share, *_ in found)
    least, users, lost, alike = min(found, key=lambda one: one[0].high)
    high = least.high
    wanted = requirement.share
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

"""A requirement's verdict: on its fold, its geometry, or both at once."""

from dataclasses import replace
from typing import Any

from compass.allowed import check_all_allowed
from compass.coverage.beacon_verdict import sampled_at_sites, verdict_with_beacons
from compass.coverage.certified_effort import Effort
from compass.coverage.fold_verdict import course_of, fold_verdict
from compass.coverage.fold_verdict_over_days import fold_verdict_over_days
from compass.coverage.geometry_verdict import asks_for_folds, geometry_verdict
from compass.coverage.period_verdict import by_parts
from compass.coverage.value_limit import FOLD
from compass.coverage.verdict import Verdict, both
from compass.design import Design
from compass.errors import ArgumentError
from compass.orbits.symmetry import one_period
from compass.requirement import Requirement

#: A share of which it is soon told that what is not always there has less.
NEARLY = 1.0 - 1e-9


def verdict_of(
    design: Design,
    requirement: Requirement,
    *,
    days: float | None = None,
    start_day: float = 0.0,
    effort: Effort | None = None,
    thorough: bool = False,
) -> Verdict:
    """Settle a requirement on a design.

    Parameters
    ----------
    design
        Its own motion counts.
    requirement
        Of this design or any other.
    days, start_day
        For so many days from a day after the epoch on; without days for ever, which only
        ellipses that keep their shape allow.
    effort
        How far to go with each share of geometry, and seconds for those of satellites in view; by
        default so many boxes, which is the same on any machine.
    thorough
        Whether to find the largest value of geometry, and what nothing certifies by samples.

    Raises
    ------
    ArgumentError
        A motion that needs days without them, days out of range, users above the satellites, a
        mask below the limb, too many sets of lost satellites.
    """
    _check_days(design, days, start_day)
    if design.beacons:
        asked: dict[str, Any] = {"days": days, "start_day": start_day}
        rest: dict[str, Any] = {"effort": effort, "thorough": thorough}
        bare = replace(design, beacons=())
        return verdict_with_beacons(
            design,
            requirement,
            lambda part: verdict_of(bare, part, **asked, **rest),
            lambda part: sampled_at_sites(design, part, **asked),
        )
    course = course_of(design, None, 0.0) if days is None else None
    if days is not None or (course is not None and one_period(design.constellation)):
        return _of_all(design, requirement, days, start_day, effort, thorough)
    found = None
    if course is not None:
        found = _of_all(design, requirement, None, 0.0, effort, thorough)
        if found.met is not None:
            return found
    often = thorough and requirement.share < 1.0  # bounds of a part are bounds of all

    def settle(part: Design) -> Verdict:
        return verdict_of(part, requirement, effort=effort, thorough=often)

    alone = by_parts(design, requirement, settle)
    if alone.met is not None:
        return alone.met
    found = found or _of_all(design, requirement, None, 0.0, effort, thorough)
    if found.met is not None or not alone.told:
        return found
    known = found.share or ((0.0, 1.0) if requirement.share < 1.0 else None)
    share = None if known is None else (max(known[0], alone.least), known[1])
    return replace(found, reason=f"{alone.told}; {found.reason}", share=share)


def _of_all(
    design: Design,
    requirement: Requirement,
    days: float | None,
    start_day: float,
    effort: Effort | None,
    thorough: bool,
) -> Verdict:
    """Verdict on all satellites together: of the fold and of each limit."""
    verdicts, limits = [], list(requirement.limits)
    if (fold := requirement.counts) is not None:
        if asks_for_folds(design, requirement, days, start_day):
            limits.insert(0, (FOLD, fold))
        else:
            asked: dict[str, Any] = {"days": days, "start_day": start_day, "effort": effort}
            verdicts.append(_fold_verdict(design, requirement, fold, thorough, asked))
    for name, limit in limits:
        verdicts.append(
            geometry_verdict(
                design,
                requirement,
                name,
                limit,
                days=days,
                start_day=start_day,
                effort=effort,
                thorough=thorough,
            )
        )
    if not verdicts:
        raise ArgumentError(f"{requirement.name}: asks for nothing; add a fold or a limit")
    verdict = verdicts[0]
    for further in verdicts[1:]:
        verdict = both(verdict, further)
    return verdict


def _fold_verdict(
    design: Design, requirement: Requirement, fold: int, thorough: bool, asked: dict[str, Any]
) -> Verdict:
    """Verdict on a fold; if `thorough`, of one that is not always there the share of time too."""
    if not closed_form(design, asked["days"]):
        return fold_verdict_over_days(design, requirement, **asked)
    often = replace(requirement, share=NEARLY, share_of="time")
    certified = thorough and asks_for_folds(design, often, asked["days"], asked["start_day"])
    verdict = fold_verdict(design, requirement, missed_share=not certified, **asked)
    if not (certified and verdict.met is False and verdict.share is None):
        return verdict
    share = geometry_verdict(design, often, FOLD, fold, thorough=True, **asked).share
    return replace(verdict, share=share)


def closed_form(design: Design, days: float | None) -> bool:
    """Whether claims are settled on ellipses: not along paths that are integrated or drift."""
    return design.motion.model == "two-body" or (design.motion.model == "j2" and days is None)


def _check_days(design: Design, days: float | None, start_day: float) -> None:
    if days is None:
        if not design.motion.is_closed_form:
            raise ArgumentError(
                f"days: missing; under {design.motion.title} nothing is for ever: give the days to "
                "prove"
            )
        if start_day:
            raise ArgumentError(
                f"start_day = {start_day:g}: counts with days only; give days too, or leave it out"
            )
        return
    check_all_allowed(days=days, start_day=start_day)

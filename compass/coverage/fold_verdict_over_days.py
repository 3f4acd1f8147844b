"""Whether a fold is kept along real paths for a span of days, by a requirement's users."""

from dataclasses import replace
from typing import Any

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.claims import Claim, claims_of
from compass.coverage.lasting import Lasting, prove_span
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design, Requirement
from compass.frames import SECONDS_PER_DAY
from compass.orbits.trajectory import Trajectory
from compass.words import counted


def fold_verdict_over_days(
    design: Design, requirement: Requirement, *, days: float | None, start_day: float = 0.0
) -> Verdict:
    """Verdict on "so many satellites in view" along the paths of a design's motion.

    Parameters
    ----------
    design, requirement
        As in `compass.coverage.requirement_verdict.verdict_of`; the requirement wants a fold.
    days, start_day
        The span.

    Raises
    ------
    ArgumentError
        As `prove_span` and `compass.orbits.motion.Motion.trajectory`.
    """
    assert days is not None
    assert requirement.fold is not None
    motion = design.motion
    scope = f"over {counted(days, 'day')} from day {start_day:g}, {motion.title}, at the place"
    if reason := not_followed(design, requirement):
        return undecided(requirement, scope, reason)
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    path = motion.trajectory(design.constellation, start, stop)
    # whichever are lost: so many are left if so many more are there
    fold = requirement.fold + requirement.losses
    found = [
        claim_lasts(path, fold, claim, start, stop) for claim in claims_of(design, requirement)
    ]
    return _verdict(requirement, scope, found)


def not_followed(design: Design, requirement: Requirement) -> str:
    """Why a requirement's satellites in view cannot be settled along paths; empty if they can."""
    if requirement.beam is not None:
        return "beams of antennas are not looked at along real paths; leave out beam_deg"
    if requirement.fold is None:
        return ""
    lowest = design.constellation.periapsis_radius.min(initial=np.inf)
    if requirement.areas and lowest <= design.figure.equatorial_radius + requirement.altitude:
        return "users above satellites are not looked at along real paths"
    if requirement.share < 1.0:
        return (
            "shares of satellites in view along real paths are not bracketed; ask for a dilution "
            "of precision, which is, or for always"
        )
    if requirement.areas and requirement.altitude and not design.figure.is_sphere:
        return "users above an ellipsoid are not looked at along real paths; name a sphere"
    return ""


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


def _verdict(requirement: Requirement, scope: str, found: list[Lasting]) -> Verdict:
    """Verdict of the claims about all places: the first loss counts."""
    lost = [one for one in found if one.outcome is Outcome.REFUTED]
    if lost:
        first = min(lost, key=lambda one: one.lost_at or np.inf)
        w = first.witness
        assert w is not None
        worst = Worst(w.time, w.latitude, w.longitude, w.fold)
        kept = first.days_proven / ((first.stop - first.start) / SECONDS_PER_DAY)
        return Verdict(requirement, False, "proven", scope, (kept, 1.0), -w.shortfall, worst)
    if all(one.outcome is Outcome.PROVEN for one in found):
        estimated = {one.estimated for one in found} - {""}
        given = f"; given an estimated {', '.join(estimated)}" if estimated else ""
        return Verdict(requirement, True, "proven", scope + given, (1.0, 1.0))
    days = min(one.days_proven for one in found)
    return undecided(requirement, scope, f"proven for {days:.6g} days; then neither could be shown")

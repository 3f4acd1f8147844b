"""Whether a fold is kept along real paths for a span of days, by a requirement's users."""

from dataclasses import replace
from typing import Any

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.fold_verdict import users_of
from compass.coverage.lasting import Lasting, prove_span
from compass.coverage.region import Region, convex_polygon, read_regions
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design, Requirement
from compass.frames import SECONDS_PER_DAY
from compass.sites import Site

#: Half a side of the square that stands for a site, radians: 60 m.
SQUARE = 2e-5


def fold_verdict_over_days(
    design: Design, requirement: Requirement, *, days: float | None, start_day: float = 0.0
) -> Verdict:
    """Verdict on "so many satellites in view" along the paths of a design's motion.

    A site stands for the points of a small square about it, on the sphere through it: its up leans
    from the radius by a known angle, which the mask is raised by to prove and lowered by to refute.
    A mask that depends on azimuth proves with its highest all around and refutes with its lowest.

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
    scope = f"over {days:g} days from day {start_day:g}, {motion.title}, at the place"
    if requirement.share < 1.0 or requirement.losses:
        what = "shares" if requirement.share < 1.0 else "losses"
        return undecided(requirement, scope, f"{what} along real paths are not bracketed")
    regions = requirement.regions or (() if requirement.sites else ("globe",))
    if regions and requirement.altitude and not design.figure.is_sphere:
        reason = "users above an ellipsoid are not looked at along real paths; name a sphere"
        return undecided(requirement, scope, reason)
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    path = motion.trajectory(design.constellation, start, stop)
    own, outcomes, figure = _mask(design, requirement), [], design.figure
    claims = [
        (region, figure.equatorial_radius + requirement.altitude, figure.stretch, *own)
        for text in regions
        for region in read_regions(text)
    ]
    users = users_of(design, requirement)
    for site, each in zip(requirement.sites, users, strict=False):
        lean = abs(each.south - site.latitude) + 2 * SQUARE
        low, high = each.mask.lowest - lean, each.mask.highest + lean
        claims.append((square(site), float(np.linalg.norm(site.r_mcmf)), 1.0, low, high))
    for region, radius, stretch, low, high in claims:
        asked: dict[str, Any] = {
            "sphere_radius": radius,
            "stretch": stretch,
            "region": region,
            "start": start,
            "stop": stop,
        }
        found = prove_span(path, requirement.fold, mask=high, **asked)
        if found.outcome is Outcome.REFUTED and low < high:
            lowest = prove_span(path, requirement.fold, mask=low, **asked)
            if lowest.outcome is Outcome.REFUTED:  # a loss over the highest may be none
                found = replace(found, lost_at=lowest.lost_at, witness=lowest.witness)
            else:
                found = replace(found, outcome=Outcome.UNDECIDED, lost_at=None, witness=None)
        outcomes.append(found)
    return _verdict(requirement, scope, outcomes)


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


def _mask(design: Design, requirement: Requirement) -> tuple[float, float]:
    """Lowest and highest elevation of the mask of regions, radians."""
    if requirement.mask is not None:
        return requirement.mask, requirement.mask
    return design.mask.lowest, design.mask.highest


def square(site: Site) -> Region:
    """A convex polygon of some hundred metres about a site."""
    east, north, _ = site.enu_mcmf
    middle = site.r_mcmf / np.linalg.norm(site.r_mcmf)
    corners = [middle + SQUARE * (x * east + y * north) for x, y in _CORNERS]
    r = np.array(corners)
    latitudes = np.arctan2(r[:, 2], np.hypot(r[:, 0], r[:, 1]))
    return convex_polygon(latitudes, np.arctan2(r[:, 1], r[:, 0]))


_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))

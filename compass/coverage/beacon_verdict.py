"""Ground beacons beside satellites: at sites they count as satellites that never set.

A beacon over a site's horizon is there always: of satellites in view so many fewer are wanted. It
makes no dilution larger, so that what satellites keep alone is kept; what they do not keep alone
random samples tell, with beacons. Over regions and in metres satellites count alone, for beacons
are seen from next to nowhere, and nothing is said of their ranges.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from compass.coverage.fold_verdict import MEETING, course_of, losses_of, users_of
from compass.coverage.sampled_verdict import EVER, sampled_verdict
from compass.coverage.verdict import Verdict, both, gathered, undecided
from compass.design import Design
from compass.requirement import DILUTIONS, Requirement
from compass.sites import Mask, Site
from compass.words import counted, listed


def heard(site: Site, mask: Mask, beacons: Sequence[Site]) -> list[Site]:
    """Beacons over a site's horizon or the mask, but for one that is where it is, within 1 m."""
    looks = replace(site, mask=site.mask.or_higher(mask))
    return [
        one
        for one in beacons
        if np.linalg.norm(one.r_mcmf - site.r_mcmf) > 1.0 and looks.sees(one.r_mcmf)
    ]


def verdict_with_beacons(
    design: Design,
    requirement: Requirement,
    alone: Callable[[Requirement], Verdict],
    sampled: Callable[[Requirement], Verdict],
) -> Verdict:
    """Verdict on a requirement of a design with beacons.

    Parameters
    ----------
    design, requirement
        As of `compass.coverage.requirement_verdict.verdict_of`.
    alone
        Gives the verdict of satellites alone.
    sampled
        Gives that of random samples, beacons counted, on one dilution.
    """
    mask = design.mask if requirement.mask is None else Mask.constant(requirement.mask)
    seen = {site: heard(site, mask, design.beacons) for site in requirement.sites}
    most = max(map(len, seen.values()), default=0)
    names = dict.fromkeys(one.name for ones in seen.values() for one in ones)
    if not most:
        return _said(alone(requirement), "no beacon is over the horizon of a site that it asks of")
    counts = replace(requirement, limits=())
    found = []
    if (fold := requirement.counts) is not None:
        groups = {k: [site for site in seen if len(seen[site]) == k] for k in range(most + 1)}
        parts = [
            alone(replace(counts, sites=tuple(sites), regions=(), fold=fold - k))
            for k, sites in groups.items()
            if sites and fold > k
        ]
        if requirement.regions:
            parts.append(alone(replace(counts, sites=())))
        found.append(gathered(requirement, parts))
    for name, limit in requirement.limits:
        one = replace(requirement, fold=None, limits=((name, limit),))
        verdict = alone(one)
        if verdict.met is not True and name in DILUTIONS and not requirement.regions:
            verdict = sampled(one)
        found.append(verdict)
    verdict = found[0]
    for further in found[1:]:
        verdict = both(verdict, further)
    told = f"{counted(most, 'beacon')} at most over a horizon ({listed(list(names))}), counted"
    return _said(replace(verdict, requirement=requirement), f"{told} with satellites at sites")


def sampled_at_sites(
    design: Design, requirement: Requirement, *, days: float | None, start_day: float
) -> Verdict:
    """Verdict on one dilution at sites by random moments, beacons counted.

    For ever at moments of `EVER` at the place itself, for no other of its circle has its beacons.
    """
    course = course_of(design, days, start_day)
    if course is None:
        return undecided(requirement, f"for ever, {design.motion.title}", MEETING)
    if course.span is None:
        words = f"for ever, {design.motion.title}, at the place"
        course = replace(course, span=EVER, words=words)
    ((name, limit),) = requirement.limits
    everyone = users_of(design, requirement)
    lost = [
        one[:2]
        for one in losses_of(design.constellation, requirement, everyone, course, alike=False)
    ]
    return sampled_verdict(design, requirement, name, limit, everyone, lost, course)


def _said(verdict: Verdict, what: str) -> Verdict:
    return replace(verdict, scope=f"{verdict.scope}; {what}")

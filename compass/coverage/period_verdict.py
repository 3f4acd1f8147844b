"""What satellites of one period prove by themselves, where no more is known of several for ever.

Orbits of different periods meet in every combination of their phases. More satellites in view only
help, so that what those of one period keep for ever all keep together; and of satellites in view
always so many are there as the groups of each period have always, added up.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from compass.coverage.fold_verdict import course_of, fold_always_met, users_of
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.requirement import Requirement
from compass.words import counted

#: Groups that are looked at, the largest first: past them satellites hardly share a period.
GROUPS = 8


def by_one_period(
    design: Design, requirement: Requirement, settle: Callable[[Design], Verdict]
) -> Verdict | None:
    """Verdict where satellites of one period, or of several each for itself, suffice; else None.

    Parameters
    ----------
    design
        Of orbits of several periods.
    requirement
        What is wanted for ever.
    settle
        Gives the verdict on a design with fewer satellites.
    """
    groups = [
        replace(design, constellation=some)
        for some in _groups(design.constellation)
        if course_of(replace(design, constellation=some), None, 0.0) is not None
    ]
    for group in groups:
        if group.constellation.size < (requirement.counts or 4) + requirement.losses:
            continue
        try:
            found = settle(group)
        except ArgumentError:  # users above these satellites, or too many sets of lost ones
            continue
        if found.met:
            alone = f"by {_words(group)} alone; {found.scope}"
            share = None if found.share is None else (found.share[0], 1.0)
            return replace(found, scope=alone, share=share, worst=None, lost=(), alike=1)
    if requirement.share < 1.0 or requirement.limits or (wanted := requirement.counts) is None:
        return None
    return _added_up(requirement, groups, wanted + requirement.losses)


def _added_up(requirement: Requirement, groups: Sequence[Design], wanted: int) -> Verdict | None:
    """Verdict where what groups always have in view, each for itself, adds up to what is wanted."""
    counts, total, scope = [], 0, ""
    for group in groups:
        c, users, course = (
            group.constellation,
            users_of(group, requirement),
            course_of(group, None, 0.0),
        )
        assert course is not None
        always = 0
        while total + always < wanted and always < c.size:
            more = replace(requirement, fold=always + 1, losses=0)
            if not fold_always_met(c, users, more, course):
                break
            always += 1
        if always:
            counts.append(f"{always} of {_words(group)}")
            total, scope = total + always, course.words
        if total >= wanted:
            words = f"{' and '.join(counts)}, each always in view by themselves; {scope}"
            return Verdict(requirement, True, "proven", words, (1.0, 1.0))
    return None


def _groups(c: Constellation) -> list[Constellation]:
    """Satellites of one period each, the largest group first."""
    of = {a: np.flatnonzero(c.semi_major_axis == a) for a in np.unique(c.semi_major_axis)}
    largest = sorted(of.values(), key=len, reverse=True)[:GROUPS]
    return [c.without(np.setdiff1d(np.arange(c.size), some).tolist()) for some in largest]


def _words(group: Design) -> str:
    """How many satellites of which axis."""
    c = group.constellation
    return f"{counted(c.size, 'satellite')} at {float(c.semi_major_axis[0]) / 1e3:.6g} km"

"""What parts of a constellation prove by themselves, each for ever, where no more is known of all.

Orbits of different periods meet in every combination of their phases, unless all their tracks
close. More satellites in view never make fewer, nor a dilution or the error of a fix that weighs
ranges by their variances larger: what one part keeps for ever, all together keep; and of satellites
in view always so many are there as parts without a satellite in common have always, added up.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compass.coverage.fold_verdict import Course, course_of, fold_always_met, users_of
from compass.coverage.protection import LEVELS
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.requirement import Requirement
from compass.words import counted, listed

#: Parts that are looked at, the largest first: past them satellites hardly share a period.
PARTS = 8


@dataclass(frozen=True)
class Alone:
    """What came of parts of a constellation, each by itself.

    Attributes
    ----------
    met
        The verdict where that suffices, else None.
    least
        Lower bound of the share for which all together keep it, where shares are wanted.
    told
        What each part has come to, in words; empty where there is none to look at.
    """

    met: Verdict | None
    least: float = 0.0
    told: str = ""


def by_parts(
    design: Design, requirement: Requirement, settle: Callable[[Design], Verdict]
) -> Alone:
    """What satellites of one period, or of closed tracks, keep for ever, each part for itself.

    Parameters
    ----------
    design
        Of orbits of several periods.
    requirement
        What is wanted for ever.
    settle
        Gives the verdict on a design with fewer satellites.
    """
    if any(name in LEVELS for name, _ in requirement.limits):
        return Alone(None)  # a further satellite is one more that may fail
    parts = _parts(design)
    least, told = 0.0, []
    for part in parts:
        few = part.constellation.size < (requirement.counts or 4) + requirement.losses
        try:
            found = None if few else settle(part)
        except ArgumentError:  # users above these satellites, or too many sets of lost ones
            found = None
        if found is None:
            told.append(f"{_words(part)} {'have too few' if few else 'cannot be asked'}")
            continue
        if found.met:
            alone = f"by {_words(part)} alone; {found.scope}"
            share = None if found.share is None else (found.share[0], 1.0)
            kept = replace(found, scope=alone, share=share, worst=None, lost=(), alike=1)
            return Alone(kept, 1.0)
        if requirement.share < 1.0 and found.share is not None:
            least = max(least, found.share[0])
        told.append(f"{_words(part)} {_come_to(found)}")
    if requirement.share == 1.0 and not requirement.limits and requirement.counts is not None:
        wanted = requirement.counts + requirement.losses
        if (added := _added_up(requirement, parts, wanted)) is not None:
            return Alone(added, 1.0)
    return Alone(None, least, f"by themselves {listed(told)}" if told else "")


def _come_to(found: Verdict) -> str:
    """What a part that does not suffice comes to."""
    word = "miss it" if found.met is False else "leave it open"
    if found.share is None:
        return word
    low, high = (f"{100 * one:.4g}" for one in found.share)
    return f"{word}, kept for {low if low == high else f'{low} to {high}'} %"


def _added_up(requirement: Requirement, parts: Sequence[Design], wanted: int) -> Verdict | None:
    """Verdict where what parts always have in view, each for itself, adds up to what is wanted."""
    counts, total, scopes = [], 0, []
    for part in parts:
        c, users, course = part.constellation, users_of(part, requirement), _course(part)
        assert course is not None
        always = 0
        while total + always < wanted and always < c.size:
            more = replace(requirement, fold=always + 1, losses=0)
            if not fold_always_met(c, users, more, course):
                break
            always += 1
        if always:
            counts.append(f"{always} of {_words(part)}")
            total += always
            scopes.append(course.words)
        if total >= wanted:
            words = f"{listed(counts)}, each always in view by themselves; "
            words += "; ".join(dict.fromkeys(scopes))
            return Verdict(requirement, True, "proven", words, (1.0, 1.0))
    return None


def _course(design: Design) -> Course | None:
    """For how long what is true of it is true for ever."""
    return course_of(design, None, 0.0)


def _parts(design: Design) -> list[Design]:
    """Satellites whose tracks close, unless all do, and of others those of one pace each.

    The largest first. Under J2 those of one inclination keep pace alone.
    """
    c, drifts = design.constellation, design.motion.model == "j2"
    closed = [k for k, repeat in enumerate(c.each_repeat) if repeat is not None]
    if len(closed) in (0, c.size) or _course(design.with_satellites(closed)) is None:
        closed = []
    each: dict[object, list[int]] = {"closed": closed} if closed else {}
    for k in range(c.size):
        if k not in closed:
            pace = (c.semi_major_axis[k], c.inclination[k] if drifts else 0.0)
            each.setdefault(pace, []).append(k)
    largest = sorted(each.values(), key=len, reverse=True)[:PARTS]
    parts = [design.with_satellites(some) for some in largest]
    return [part for part in parts if _course(part) is not None]


def _words(part: Design) -> str:
    """How many satellites of which axes."""
    c: Constellation = part.constellation
    axes = [f"{axis / 1e3:.6g}" for axis in np.unique(c.semi_major_axis)]
    return f"{counted(c.size, 'satellite')} at {listed(axes)} km"

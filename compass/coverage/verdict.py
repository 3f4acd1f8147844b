"""What came of a requirement: met, missed or open, with the evidence, the margin and the worst."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Literal

import numpy as np

from compass.requirement import Requirement
from compass.sites import Site

#: A verdict at a latitude this near to a site's, radians, is about the site.
NEAR = 1e-4

EvidenceKind = Literal["proven", "bracket", "sampled", "none"]


@dataclass(frozen=True)
class Worst:
    """Where and when it is worst.

    Attributes
    ----------
    time
        Seconds after the epoch, or None where a share of time is meant.
    latitude, longitude
        Planetocentric and Mars-fixed, radians; longitude None where it does not count.
    value
        Satellites in view, the dilution of precision, the error as the requirement means it, or
        what the share of time is at most; of the largest a lower bound, where `most` is one above.
    of
        Which of these: ``fold``, one of `compass.requirement.LIMITS`, or ``share``.
    rank, elevation
        Of a fold the satellite that it hangs on, counted from the best, and how high that stands
        there, radians; None where that is not told.
    seen, around
        Of geometry at a moment: satellites in view, and how many there were, did their antennas
        reach all around; None where that is not told.
    most
        Upper bound of the largest dilution or error, None where that was not looked for.
    """

    time: float | None
    latitude: float
    longitude: float | None
    value: float
    of: str = "fold"
    rank: int | None = None
    elevation: float | None = None
    seen: int | None = None
    around: int | None = None
    most: float | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        return {
            "time_s": self.time,
            "latitude_deg": float(np.degrees(self.latitude)),
            "longitude_deg": None if self.longitude is None else float(np.degrees(self.longitude)),
            "value": self.value,
            "of": self.of,
            "rank": self.rank,
            "elevation_deg": None if self.elevation is None else float(np.degrees(self.elevation)),
            "in_view": self.seen,
            "in_view_all_around": self.around,
            "value_at_most": self.most,
        }


@dataclass(frozen=True)
class Verdict:
    """The answer to a requirement.

    Attributes
    ----------
    requirement
        The question.
    met
        Whether it is met; None if that could not be told.
    evidence
        ``proven``; ``bracket``: a share between proven bounds; ``sampled``; ``none``.
    scope
        For which motion and how long, on the place or on its circle of latitude.
    share
        Bounds of the share for which it is so, or None.
    margin
        How much higher the horizon may be, radians, proven; of a miss how much too high it is,
        negative. None where that was not asked.
    worst
        Where and when it is tightest, or missed.
    lost
        Names of the satellites whose loss does that, and how many sets they stand for.
    reason
        Why it is open, in a sentence; empty if it is not.
    stopped
        What ended the search for bounds early, ``time``, ``boxes``, ``memory`` or
        ``interrupted``; else empty.
    """

    requirement: Requirement
    met: bool | None
    evidence: EvidenceKind
    scope: str
    share: tuple[float, float] | None = None
    margin: float | None = None
    worst: Worst | None = None
    lost: tuple[str, ...] = ()
    alike: int = 1
    reason: str = ""
    stopped: str = ""

    @property
    def word(self) -> str:
        """Met, missed or undecided."""
        return {True: "met", False: "missed", None: "undecided"}[self.met]

    @property
    def sure(self) -> str:
        """How sure it is, in the words of other figures; nothing where nothing is known."""
        return sure(self.evidence)

    @property
    def site(self) -> Site | None:
        """Which of the sites asked about it is worst at, or on whose latitude; None elsewhere."""
        if self.worst is None:
            return None
        latitude = self.worst.latitude
        sites = self.requirement.sites
        return next((one for one in sites if abs(one.latitude - latitude) < NEAR), None)

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        site = {"site": None if self.site is None else self.site.name}
        return {
            "name": self.requirement.name,
            "met": self.met,
            "evidence": self.evidence,
            "share": None if self.share is None else list(self.share),
            "margin_deg": None if self.margin is None else float(np.degrees(self.margin)),
            "worst": None if self.worst is None else self.worst.as_dict() | site,
            "scope": self.scope,
            "lost": list(self.lost),
            "alike": self.alike,
            "reason": self.reason,
        }


def sure(evidence: str) -> str:
    """Evidence in the words of other figures; nothing where nothing is known."""
    return {"bracket": "between proven bounds", "none": ""}.get(evidence, evidence)


def undecided(requirement: Requirement, scope: str, reason: str) -> Verdict:
    """Return the verdict that nothing can be said, and why."""
    return Verdict(requirement, None, "none", scope, reason=reason)


def gathered(requirement: Requirement, parts: Sequence[Verdict]) -> Verdict:
    """Verdict on a requirement of which parts ask at some of its places each: the worst of theirs.

    Of no parts it is met: nothing is left to ask for.
    """
    if not parts:
        return Verdict(requirement, True, "proven", "always", (1.0, 1.0))
    order = {False: 0, None: 1, True: 2}
    worst = min(parts, key=lambda v: (order[v.met], inf if v.margin is None else v.margin))
    known = [part.share for part in parts if part.share is not None]
    share = None
    if len(known) == len(parts):
        share = min(low for low, _ in known), min(high for _, high in known)
    return replace(worst, requirement=requirement, share=share)


def both(first: Verdict, second: Verdict) -> Verdict:
    """Verdict on two halves of one requirement: met if both are, missed if one is.

    Both shares hold together for at least what they leave of one another, and at most for the
    smaller; margins and the worst are those of the half that is missed, open or closer.
    """
    order = {False: 0, None: 1, True: 2}
    worse, other = sorted((first, second), key=lambda v: order[v.met])
    share = None
    if first.share is not None and second.share is not None:
        (a, b), (c, d) = first.share, second.share
        share = (max(0.0, a + c - 1.0), min(b, d))
    met = worse.met
    if first.requirement.share < 1.0 and share is not None:
        wanted = first.requirement.share
        met = True if share[0] >= wanted else False if share[1] < wanted else None
    reason = worse.reason or (other.reason if met is None else "")
    if met is None and not reason:
        reason = "each of its parts holds for long enough, both together may not"
    kinds = {worse.evidence, other.evidence}
    evidence = worse.evidence if len(kinds) == 1 else "sampled" if "sampled" in kinds else "bracket"
    return replace(
        worse,
        met=met,
        evidence=evidence,
        share=share if share is not None else worse.share,
        margin=first.margin if first.margin is not None else second.margin,
        scope=worse.scope if worse.scope == other.scope else f"{worse.scope}; {other.scope}",
        reason=reason,
    )

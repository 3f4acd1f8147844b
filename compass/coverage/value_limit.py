"""A value with its largest allowed, and how bounds of what keeps it are found.

Errors are asked about of ranges that are no better than they ever are, as with the Sun overhead of
all users, when the ionosphere delays most, and of those that are no worse, as with the Sun set:
what is kept by the first is kept, what is broken by the second is broken.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import FOLD_PER_SHARE, Effort
from compass.coverage.certified_ranges import ERROR_DOPS, Ranges, sigma_allowed, skies_of
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.certified_witness import WorstWitness
from compass.coverage.certified_worst import CertifiedAlways
from compass.coverage.certified_worst_place import certified_worst_place
from compass.design import Design
from compass.orbits import Constellation
from compass.requirement import Requirement
from compass.words import counted

#: How near bounds of the share at the worst place come where that is wanted, and where it is open
#: on which side of the share wanted they are.
WORST_WIDTH, WORST_FINEST = 1e-3, 1e-5

#: What satellites in view are called among figures; so many or more keep their limit.
FOLD = "fold"

#: How near bounds of the largest value come, relative to it.
LARGEST = 1e-2


Span = tuple[float, float] | None


@dataclass(frozen=True)
class ValueLimit:
    """A value and the largest allowed, and how it is found.

    Attributes
    ----------
    name, limit
        One of `compass.requirement.LIMITS`, and its limit as kernels take it.
    title
        Of the value, in words.
    factor
        What values found are multiplied by to mean what the requirement does.
    skies
        Ranges that errors are of, no better than they are and, where that differs, no worse; of a
        dilution None.
    """

    name: str
    limit: float
    title: str
    factor: float
    skies: tuple[Ranges | None, ...]

    def share(
        self,
        effort: Effort,
        left: Constellation,
        lost: Sequence[int],
        where: dict[str, Any],
        width: float,
        level: float,
    ) -> CertifiedShare:
        """Share with the value small enough, wherever the Sun stands, its bounds so near.

        By fold, of which rims are nearly everywhere, so near only where they lie on both sides of
        `level`.
        """
        if self.name == FOLD and effort.width is None:
            coarse = effort.share(
                left, self.limit, width=FOLD_PER_SHARE * width, **self._asked(None, lost), **where
            )
            if coarse.stopped or not coarse.low < level <= coarse.high:
                return coarse
        found = [
            effort.share(left, self.limit, width=width, **self._asked(sky, lost), **where)
            for sky in self.skies
        ]
        return found[0] if len(found) == 1 else replace(found[0], high=found[1].high)

    def worst_place(
        self,
        effort: Effort,
        left: Constellation,
        lost: Sequence[int],
        where: dict[str, Any],
        level: float,
        thorough: bool,
    ) -> tuple[CertifiedShare, float]:
        """Share of time with the value small enough where that is least, and the latitude.

        Bounds of each sky, until they tell whether it is a share of `level` or more; if `thorough`
        until they are near one another too.
        """
        width, narrow = (WORST_FINEST, WORST_WIDTH) if thorough else (WORST_WIDTH, inf)
        found = [
            certified_worst_place(
                left,
                self.limit,
                level,
                effort=effort,
                width=width,
                narrow=narrow,
                **self._asked(sky, lost),
                **where,
            )
            for sky in self.skies
        ]
        if len(found) == 1:
            return found[0]
        return replace(found[0][0], high=found[1][0].high), found[0][1]

    def always(
        self, effort: Effort, left: Constellation, lost: Sequence[int], where: dict[str, Any]
    ) -> CertifiedAlways:
        """Claim that it is always small enough: proven by the first sky, refuted by the last."""
        claim = effort.always(left, self.limit, **self._asked(self.skies[0], lost), **where)
        if len(self.skies) > 1 and claim.outcome == Outcome.REFUTED:
            claim = effort.always(left, self.limit, **self._asked(self.skies[1], lost), **where)
            if claim.outcome == Outcome.PROVEN:  # of the better ranges alone
                return replace(claim, outcome=Outcome.UNDECIDED)
        return claim

    def largest(
        self, effort: Effort, left: Constellation, lost: Sequence[int], where: dict[str, Any]
    ) -> tuple[WorstWitness | None, float]:
        """Where and when it is largest, of ranges no worse than they are, and an upper bound."""
        found = [
            effort.worst(left, precision=LARGEST, **self._asked(sky, lost), **where)
            for sky in self.skies
        ]
        return found[-1].witness, found[0].high

    def _asked(self, sky: Ranges | None, lost: Sequence[int]) -> dict[str, Any]:
        return {"dop": self.name, "ranges": None if sky is None else sky.without(lost)}


def value_limit(
    design: Design, requirement: Requirement, name: str, limit: float, span: Span, height: float
) -> ValueLimit:
    """Limit on a value that a requirement asks for, of users at most so high."""
    if name == FOLD:
        return ValueLimit(name, limit, f"{counted(int(limit), 'satellite')} in view", 1.0, (None,))
    title = f"{requirement.titled(name)} small enough"
    if name not in ERROR_DOPS:
        return ValueLimit(name, limit, title, 1.0, (None,))
    allowed = sigma_allowed(requirement, limit)
    return ValueLimit(name, allowed, title, limit / allowed, skies_of(design, span, height))

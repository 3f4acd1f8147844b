"""What is looked for by requirements, and what was found: plain records."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import Figure
from compass.orbits import Constellation
from compass.ranging import Signal
from compass.requirement import PROTECTIONS, Requirement
from compass.sites import Mask


@dataclass(frozen=True)
class Trial:
    """A constellation and how it does.

    Attributes
    ----------
    constellation
        The pattern.
    closest_approach
        Least angle between two satellites at any time, radians.
    verdicts
        On each requirement; empty if it was kept out before.
    sampled, worst
        Least share of random moments that keep a requirement, and the largest dilution over its
        limit that any of them showed.
    """

    constellation: Constellation
    closest_approach: float
    verdicts: tuple[Verdict, ...] = ()
    sampled: float = 1.0
    worst: float = 0.0

    @property
    def met(self) -> bool:
        """Whether all requirements are met."""
        return bool(self.verdicts) and all(v.met is True for v in self.verdicts)

    @property
    def margin(self) -> float | None:
        """Least proven margin of its folds, radians."""
        margins = [v.margin for v in self.verdicts if v.margin is not None]
        return min(margins) if margins else None

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        p = self.constellation.pattern
        assert p is not None
        margin = self.margin
        return {
            "pattern": p.kind,
            "satellites": p.satellites,
            "planes": p.planes,
            "phasing": p.phasing,
            "inclination_deg": round(float(np.degrees(p.inclination)), 6),
            "raan_deg": round(float(np.degrees(p.raan)), 6),
            "radius_km": float(self.constellation.semi_major_axis[0]) / 1e3,
            "notation": p.notation,
            "closest_approach_deg": float(np.degrees(self.closest_approach)),
            "margin_deg": None if margin is None else float(np.degrees(margin)),
            "met": self.met,
            "requirements": [verdict.as_dict() for verdict in self.verdicts],
        }


@dataclass(frozen=True)
class KeptOut:
    """The smallest constellation that was kept out for a reason, and what it is."""

    constellation: Constellation
    reason: str


@dataclass(frozen=True)
class Outcome:
    """What a search found.

    Attributes
    ----------
    met
        Of the smallest size that meets all, the best first; empty if none does.
    next_best
        The best of the next size that meets all, or None; where nothing else of the smallest size
        does, sizes up to the largest are looked at for it.
    kept_out
        Smaller ones, or equal, that have the folds and were kept out.
    looked_at
        Patterns at an inclination and a turn.
    """

    met: tuple[Trial, ...]
    next_best: Trial | None
    kept_out: tuple[KeptOut, ...]
    looked_at: int


@dataclass(frozen=True)
class Question:
    """What is looked for.

    Attributes
    ----------
    requirements, figure, mask, signal
        As of a design.
    radius, repeat
        Of the circular orbits, metres; and how their tracks close, if that is declared.
    least_approach
        Least angle that must lie between two satellites at any time, radians.
    kinds
        Kinds of pattern.
    largest
        Largest size.
    budget_s
        Seconds that each share of geometry may take; by default so many boxes.
    days
        From the epoch on, for which everything must hold on real orbits left alone, too.
    """

    requirements: tuple[Requirement, ...]
    figure: Figure
    mask: Mask
    radius: float
    repeat: tuple[int, int] | None
    least_approach: float
    kinds: tuple[str, ...]
    largest: int
    budget_s: float | None = None
    signal: Signal | None = None
    days: float | None = None

    def __post_init__(self) -> None:
        """Refuse what bounds cannot settle: nothing would be left out for sure."""
        for each in self.requirements:
            for name, _ in each.limits:
                if name in PROTECTIONS:
                    raise ArgumentError(
                        f"requirement {each.name}: {name}_at_most: is sampled, by compass check "
                        "alone; to search ask for fold = 5, with losses: who sees five may notice "
                        "a fault"
                    )

    @property
    def always(self) -> tuple[Requirement, ...]:
        """The folds wanted always."""
        return tuple(r for r in self.requirements if r.fold is not None and r.share == 1.0)

    @property
    def geometry(self) -> tuple[Requirement, ...]:
        """What is wanted of geometry."""
        return tuple(r for r in self.requirements if r.limits)

    @property
    def least(self) -> int:
        """Fewest satellites that could do."""
        folds = [(r.fold or 0) + r.losses for r in self.requirements]
        return max([*folds, *(4 + r.losses for r in self.geometry), 1])

    def design(self, constellation: Constellation) -> Design:
        """Design of a candidate."""
        return Design(constellation, figure=self.figure, mask=self.mask, signal=self.signal)

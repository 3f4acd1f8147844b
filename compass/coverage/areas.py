"""How users at sites and in regions fare: fold, geometry and metres, each proven or bracketed.

Of a site all shares are of time, of a region of area and time. Parts of a region that is not convex
are asked for one by one: what holds of all its parts holds of the whole, so its bounds are the
least and the greatest of theirs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from compass.coverage.certified_effort import Effort
from compass.coverage.certified_ranges import skies_of
from compass.coverage.fold_verdict import Course, course_of, users_of
from compass.coverage.geometry_verdict import asked_place
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.users import Users
from compass.coverage.verdict import Verdict
from compass.design import ERRORS, Design, Requirement
from compass.frames import SECONDS_PER_DAY
from compass.sites import Site

#: How near bounds of a share are to come, and those of a percentile, relative to it; and boxes.
WIDTH, PRECISION, BOXES = 2e-4, 2e-2, 300_000

#: Of the time, or of area and time, in per cent: what values are given for.
PERCENTS = (50, 95)

#: Bounds between which a number lies.
Bounds = tuple[float, float]


@dataclass(frozen=True)
class AreaFigures:
    """What users at a site or in a region have.

    Attributes
    ----------
    name
        Of the site, or the region's text.
    scope
        For which motion and how long, on the place or its circle of latitude.
    fold
        Whether the satellites wanted are always in view, by how much, and where least.
    availability
        Share with a PDOP of at most `pdop_max`.
    gdop
        By per cent of `PERCENTS`: what GDOP does not exceed for so much.
    errors
        By name, of designs with a signal: share with an error of at most `error_max`, m, one sigma,
        wherever the Sun stands.
    """

    name: str
    scope: str
    fold: Verdict
    pdop_max: float
    availability: Bounds
    gdop: dict[int, Bounds]
    error_max: float
    errors: dict[str, Bounds]

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        fold = self.fold.as_dict()
        return {
            "name": self.name,
            "scope": self.scope,
            "fold": {key: fold[key] for key in ("met", "evidence", "share", "margin_deg", "worst")},
            "availability_bracket": list(self.availability),
            "gdop": {f"p{q}_bracket": list(bounds) for q, bounds in self.gdop.items()},
            **{name: {"share_bracket": list(bounds)} for name, bounds in self.errors.items()},
            **({"error_limit_m": self.error_max} if self.errors else {}),
        }


def area_figures(
    design: Design,
    *,
    sites: Sequence[Site] = (),
    regions: Sequence[str] = (),
    fold: int,
    pdop_max: float,
    error_max: float,
    span: tuple[float, float],
    limited: bool = False,
    effort: Effort | None = None,
) -> tuple[AreaFigures, ...]:
    """Figures of every site and region, in this order.

    For ever where that can be said of the place; else over the span.

    Parameters
    ----------
    design
        Its motion and mask count; sites have the higher of it and their own horizon.
    sites, regions
        As of a requirement.
    fold, pdop_max, error_max
        Satellites wanted, the largest PDOP that is good, and the largest error, m.
    span, limited
        Seconds after the epoch from and to which is looked where nothing can be said for ever, or
        wherever it is `limited` to that.
    effort
        How far to go; by default `WIDTH`, `PRECISION` and a number of boxes.

    Raises
    ------
    ArgumentError
        As `compass.coverage.requirement_verdict.verdict_of`, and a region that cannot be read.
    """
    wanted = [Requirement(site.name, sites=(site,), fold=fold) for site in sites]
    wanted += [Requirement(text, regions=(text,), fold=fold) for text in regions]
    effort, ever = effort or Effort(), not limited and design.motion.is_closed_form
    return tuple(_figures(design, each, pdop_max, error_max, span, ever, effort) for each in wanted)


def _figures(
    design: Design,
    wanted: Requirement,
    pdop_max: float,
    error_max: float,
    span: tuple[float, float],
    ever: bool,
    effort: Effort,
) -> AreaFigures:
    everyone = users_of(design, wanted)
    start, days = span[0] / SECONDS_PER_DAY, (span[1] - span[0]) / SECONDS_PER_DAY
    course = course_of(design, None, 0.0) if ever else None
    if course is None:
        course = course_of(design, days, start)
        assert course is not None  # days were given
    later: dict[str, Any] = {} if course.for_ever else {"days": days, "start_day": start}
    found = [_Part(design, users, course, effort) for users in everyone]
    availability = _hull([part.share("pdop", pdop_max) for part in found])
    gdop = {q: _hull([part.gdop(q) for part in found]) for q in PERCENTS}
    names = ERRORS[:3] if design.signal is not None else ()
    errors = {name: _hull([part.share(name, error_max) for part in found]) for name in names}
    fold = verdict_of(design, wanted, **later)
    return AreaFigures(
        wanted.name, course.words, fold, pdop_max, availability, gdop, error_max, errors
    )


@dataclass(frozen=True)
class _Part:
    """Users in one convex part, and how they are asked about."""

    design: Design
    users: Users
    course: Course
    effort: Effort

    def share(self, name: str, limit: float) -> Bounds:
        """Share with a dilution or an error of at most a limit, wherever the Sun stands."""
        skies: list[Any] = [None]
        if name in ERRORS:
            skies = list(skies_of(self.design, self.course.span, self.users.height))
        found = [
            self.effort.share(
                self.design.constellation,
                limit,
                width=WIDTH,
                dop=name,
                ranges=sky,
                **self._asked(),
            )
            for sky in skies
        ]
        return found[0].low, found[-1].high

    def gdop(self, percent: int) -> Bounds:
        """What GDOP does not exceed."""
        found = self.effort.percentile(
            self.design.constellation,
            float(percent),
            precision=PRECISION,
            dop="gdop",
            **self._asked(),
        )
        return found.low, found.high

    def _asked(self) -> dict[str, Any]:
        return asked_place(self.users, self.course) | {
            "figure": self.users.figure,
            "mask": self.users.mask,
            "motion": self.design.motion,
            "budget_boxes": BOXES,
        }


def _hull(parts: Sequence[Bounds]) -> Bounds:
    return min(low for low, _ in parts), max(high for _, high in parts)

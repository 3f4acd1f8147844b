"""How users at sites and in regions fare: fold, geometry and metres, each proven or bracketed.

Of a site all shares are of time, of a region of area and time. Parts of a region that is not convex
are asked for one by one: what holds of all its parts holds of the whole, so its bounds are the
least and the greatest of theirs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from compass.coverage.beacon_verdict import heard
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_ranges import skies_of
from compass.coverage.fold_verdict import Course, course_of, users_of
from compass.coverage.geometry_verdict import asked_place
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.users import Users, by_horizon
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.requirement import ERRORS, Requirement
from compass.sites import Mask, Site
from compass.words import listed

#: Of the time, or of area and time, in per cent: what values are given for.
PERCENTS = (50, 95)

#: Bounds between which a number lies.
Bounds = tuple[float, float]


@dataclass(frozen=True)
class Near:
    """How near bounds come: of a share, of a percentile relative to it; and in how many boxes."""

    width: float = 2e-4
    precision: float = 2e-2
    boxes: int = 300_000


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


@dataclass(frozen=True)
class Area:
    """A site or a region, and how its users are asked about; `areas_of` makes them."""

    design: Design
    wanted: Requirement
    course: Course
    users: tuple[Users, ...]
    effort: Effort
    near: Near

    @property
    def name(self) -> str:
        """Of the site, or the region's text."""
        return self.wanted.name

    @property
    def errors(self) -> tuple[str, ...]:
        """Errors that are told of it: those of who looks down have no bounds."""
        level = self.wanted.mask is None or self.wanted.mask >= 0.0
        return ERRORS[:3] if self.design.signal is not None and level else ()

    @cached_property
    def hears(self) -> tuple[str, ...]:
        """Beacons over the horizon, if it is a site."""
        mask, beacons = self.design.mask, self.design.beacons
        if self.wanted.mask is not None:
            mask = Mask.constant(self.wanted.mask)
        return tuple(b.name for site in self.wanted.sites for b in heard(site, mask, beacons))

    @property
    def scope(self) -> str:
        """For which motion and how long, and which beacons it counts."""
        beacons = f"; with {listed(list(self.hears))} over its horizon" if self.hears else ""
        return self.course.words + beacons

    def over_horizons(self) -> tuple[Users, ...]:
        """Its users over horizons that stand for beams, where some do."""
        c, motion = self.design.constellation, self.design.motion
        return tuple(by_horizon(users, c, motion) for users in self.users)

    def fold(self) -> Verdict:
        """Whether the satellites wanted are always in view."""
        if self.course.for_ever:
            return verdict_of(self.design, self.wanted)
        assert self.course.span is not None
        start, stop = (t / SECONDS_PER_DAY for t in self.course.span)
        return verdict_of(self.design, self.wanted, days=stop - start, start_day=start)

    def share(self, name: str, limit: float) -> Bounds:
        """Share with a dilution or an error of at most a limit, wherever the Sun stands.

        Beacons over a site's horizon may make a dilution less and its share more.
        """
        low, high = _hull([self._share(users, name, limit) for users in self.users])
        return low, 1.0 if name not in ERRORS and self.hears else high

    def _share(self, users: Users, name: str, limit: float) -> Bounds:
        skies: list[Any] = [None]
        if name in ERRORS:
            skies = list(skies_of(self.design, self.course.span, users.height))
        found = [
            self.effort.share(
                self.design.constellation,
                limit,
                width=self.near.width,
                dop=name,
                ranges=sky,
                **self._asked(users),
            )
            for sky in skies
        ]
        return found[0].low, found[-1].high

    def gdop(self, percents: Sequence[int]) -> dict[int, Bounds]:
        """What GDOP does not exceed for so many per cent each."""
        found = [
            self.effort.percentiles(
                self.design.constellation,
                percents,
                precision=self.near.precision,
                dop="gdop",
                **self._asked(users),
            )
            for users in self.users
        ]
        hulls = {q: _hull([(of[q].low, of[q].high) for of in found]) for q in percents}
        return {q: (0.0 if self.hears else low, high) for q, (low, high) in hulls.items()}

    def _asked(self, users: Users) -> dict[str, Any]:
        return asked_place(users, self.course, self.design.constellation) | {
            "figure": users.figure,
            "mask": users.mask,
            "beam": users.beam,
            "motion": self.design.motion,
            "budget_boxes": self.near.boxes,
        }


def areas_of(
    design: Design,
    *,
    sites: Sequence[Site] = (),
    regions: Sequence[str] = (),
    fold: int,
    span: tuple[float, float],
    limited: bool = False,
    mask: float | None = None,
    altitude: float = 0.0,
    beam: float | None = None,
    effort: Effort | None = None,
    near: Near | None = None,
) -> tuple[Area, ...]:
    """Every site and region, in this order, to ask about.

    For ever where that can be said of the place; else over the span.

    Parameters
    ----------
    design
        Its motion counts, and its mask; sites have the higher of it and their own horizon.
    sites, regions
        As of a requirement.
    fold
        Satellites wanted.
    span, limited
        Seconds after the epoch from and to which is looked where nothing can be said for ever, or
        wherever it is `limited` to that.
    mask, altitude, beam
        Elevation mask instead of the design's, height of the users of regions above the figure,
        metres, and half angle of the antennas, radians.
    effort, near
        How far to go; by default as near as `Near` says.

    Raises
    ------
    ArgumentError
        A region that cannot be read.
    """
    asked = Requirement("", fold=fold, mask=mask, beam=beam)
    wanted = [replace(asked, name=site.name, sites=(site,)) for site in sites]
    wanted += [replace(asked, name=text, regions=(text,), altitude=altitude) for text in regions]
    course = None
    if not limited and design.motion.is_closed_form:
        course = course_of(design, None, 0.0)
    if course is None:
        days = (span[1] - span[0]) / SECONDS_PER_DAY
        course = course_of(design, days, span[0] / SECONDS_PER_DAY)
        assert course is not None  # days were given
    effort, near = effort or Effort(), near or Near()
    areas = (Area(design, each, course, users_of(design, each), effort, near) for each in wanted)
    return tuple(replace(area, users=area.over_horizons()) for area in areas)


def area_figures(
    areas: Sequence[Area], pdop_max: float, error_max: float
) -> tuple[AreaFigures, ...]:
    """Figures of every area: the share with a good PDOP, GDOP, the share with a good error, m.

    Raises
    ------
    ArgumentError
        As `compass.coverage.requirement_verdict.verdict_of`.
    """
    return tuple(
        AreaFigures(
            area.name,
            area.scope,
            area.fold(),
            pdop_max,
            area.share("pdop", pdop_max),
            area.gdop(PERCENTS),
            error_max,
            {name: area.share(name, error_max) for name in area.errors},
        )
        for area in areas
    )


def _hull(parts: Sequence[Bounds]) -> Bounds:
    return min(low for low, _ in parts), max(high for _, high in parts)

"""Geometry over area and time between proven bounds: how often PDOP is good, percentiles of DOPs.

The one place where these two are found for one constellation. What is sampled, for pictures and to
sort many candidates, is the value of nearest rank (`compass.core.ranking`) of the same quantities.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any

from compass.coverage.certified_effort import FOLD_PER_SHARE, PERCENTILE_PER_SHARE, Effort
from compass.coverage.certified_percentile import CertifiedPercentile
from compass.coverage.certified_rounds import ended
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.certified_worst import CertifiedWorst
from compass.coverage.in_view import InView, satellites_in_view
from compass.design import PDOP_MAX
from compass.frames import Figure
from compass.orbits import Constellation
from compass.orbits.motion import AnyMotion
from compass.sites import Mask
from compass.words import counted

#: How near bounds of a share are to come; those of one by fold `FOLD_PER_SHARE` times that, of a
#: percentile `PERCENTILE_PER_SHARE` times, relative to it.
WIDTH = 2e-4

#: Boxes after which a bracket is taken as it is, and boxes times satellites: some seconds, and the
#: same on any machine.
BUDGET_BOXES, BUDGET_SIGHTS = 600_000, 40_000_000


@dataclass(frozen=True)
class CertifiedGeometry:
    """Share of area and time with a good PDOP, and what dilutions do not exceed in parts of them.

    Attributes
    ----------
    pdop_max
        Largest PDOP that is good.
    availability
        The share.
    dops
        Percentiles by dilution, then by per cent.
    worst
        The largest PDOP anywhere and at any time; None if it was not asked for.
    folds
        Shares with so many satellites in view or more.
    in_view
        How many are in view; None if that was not asked for.
    """

    pdop_max: float
    availability: CertifiedShare
    dops: Mapping[str, Mapping[int, CertifiedPercentile]]
    worst: CertifiedWorst | None = None
    folds: Mapping[int, CertifiedShare] = field(default_factory=dict)
    in_view: InView | None = None

    @property
    def brackets(self) -> dict[str, tuple[float, float]]:
        """Bounds by name: ``availability``, ``gdop.p95``, ``fold_share.5``, ``count.min``, ...

        Those that say nothing, 0 and 1 of a share or 0 and infinity of a dilution, are left out:
        what is not here is not known.
        """
        shares = {"availability": self.availability}
        shares |= {f"fold_share.{fold}": share for fold, share in self.folds.items()}
        told = {name: (one.low, one.high) for name, one in shares.items() if one.width < 1.0}
        told |= {
            f"{name}.p{percent}": (p.low, p.high)
            for name, of in self.dops.items()
            for percent, p in of.items()
            if p.low > 0.0 or p.high < inf
        }
        return told | (self.in_view.brackets if self.in_view else {})

    def numbers(self) -> dict[str, Any]:
        """Plain values: the middle of every one of `brackets`, and the bracket beside it."""
        found: dict[str, Any] = {name: {} for name in (*self.dops, "fold_share")}
        if self.in_view:
            found["count"] = self.in_view.numbers()
        for path, (low, high) in self.brackets.items():
            name, _, key = path.rpartition(".")
            if name == "count":
                continue
            of = found[name] if name else found
            of |= {key: 0.5 * (low + high), f"{key}_bracket": [low, high]}
        w = self.worst
        if w is not None and w.witness is not None:
            found["pdop_worst_bracket"] = [w.low, w.high]
            found["pdop_worst_at"] = w.witness.as_dict()
        return found

    @property
    def scope(self) -> str:
        """For which motion and how long, and how it was found."""
        percentiles = [p.stopped for of in self.dops.values() for p in of.values()]
        folds = [share.stopped for share in self.folds.values()]
        reasons = [self.availability.stopped, *percentiles, *folds]
        late = "; ".join(dict.fromkeys(ended(why) for why in reasons if why))
        how = f"branch and bound, {counted(self.availability.boxes, 'box')}"
        return "; ".join(part for part in (self.availability.scope, how, late) if part)


def certified_geometry(
    constellation: Constellation,
    *,
    figure: Figure,
    mask: Mask,
    beam: float | None = None,
    pdop_max: float = PDOP_MAX,
    percents: Sequence[int] = (95,),
    dops: Sequence[str] = ("gdop",),
    since: float = 0.0,
    duration: float | None = None,
    motion: AnyMotion = "two-body",
    height: float = 0.0,
    worst: bool = False,
    folds: Sequence[int] = (),
    found: tuple[int, int] | None = None,
    width: float = WIDTH,
    effort: Effort | None = None,
) -> CertifiedGeometry:
    """Bracket shares and percentiles of dilutions over the whole surface.

    For all time where the motion repeats up to a turn of the figure, else over a duration.

    Parameters
    ----------
    constellation, figure, mask, beam, since, duration, motion, height
        As in `compass.coverage.certified_question.Question`.
    pdop_max
        Largest PDOP that is good, from 1.
    percents, dops
        Which percentiles, of which dilutions.
    worst
        Whether to look for the largest PDOP too.
    folds
        Satellites in view whose shares are wanted.
    found
        Fewest and most in view that some place was found to have: then bounds of these and of
        their mean are wanted too, and `folds` begin with one and reach as far.
    width
        How near bounds of a share are to come where effort says nothing of that.
    effort
        How far to go; by default to `width`, in a number of boxes.
    """
    effort = effort or Effort()
    asked: dict[str, Any] = {
        "figure": figure,
        "mask": mask,
        "beam": beam,
        "since": since,
        "duration": duration,
        "motion": motion,
        "height": height,
        "budget_boxes": min(BUDGET_BOXES, BUDGET_SIGHTS // max(constellation.size, 1)),
    }
    availability = effort.share(constellation, pdop_max, dop="pdop", width=width, **asked)
    near = PERCENTILE_PER_SHARE * width
    bounded = {
        name: effort.percentiles(constellation, percents, dop=name, precision=near, **asked)
        for name in dops
    }
    ranks = {name: {q: of[q] for q in percents} for name, of in bounded.items()}
    wide = FOLD_PER_SHARE * width
    by_fold = effort.folds(constellation, folds, width=wide, **asked) if folds else []
    shares = dict(zip(folds, by_fold, strict=True))
    largest = effort.worst(constellation, dop="pdop", **asked) if worst else None
    in_view = None
    if found is not None:
        named = ("figure", "mask", "beam", "motion", "since", "duration", "height")
        in_view = satellites_in_view(
            constellation, shares, found, **{name: asked[name] for name in named}
        )
    return CertifiedGeometry(pdop_max, availability, ranks, largest, shares, in_view)

"""How many satellites are in view at the least, in the mean and at the most, over area and time."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compass.coverage.cap import cap_radius
from compass.coverage.certificate import fold_range
from compass.coverage.certified_share import CertifiedShare
from compass.coverage.symmetry import Span, shortest_span
from compass.frames import Figure
from compass.orbits import Constellation
from compass.orbits.motion import AnyMotion, as_motion
from compass.orbits.symmetry import one_period
from compass.sites import Mask

Ends = tuple[int, int]

#: Moments of an orbit over which caps are averaged: areas are smooth and repeat, so that the mean
#: of equal steps is theirs to rounding.
MOMENTS = 512

#: Revolutions times squared satellites that a proof of the extremes may take: a few seconds.
MOST_PAIRS = 300_000


@dataclass(frozen=True)
class InView:
    """Proven bounds of how many satellites are in view.

    Attributes
    ----------
    least, most
        At any place and time; that two rims touch for a moment does not count.
    mean
        Over area and time; twice the same where it is known exactly.
    """

    least: Ends
    mean: tuple[float, float]
    most: Ends

    @property
    def brackets(self) -> dict[str, tuple[float, float]]:
        """Bounds by name."""
        return {"count.min": self.least, "count.mean": self.mean, "count.max": self.most}

    def numbers(self) -> dict[str, Any]:
        """Numbers and the bounds beside them; extremes are those that some place has."""
        known = {"min": self.least[1], "mean": 0.5 * sum(self.mean), "max": self.most[0]}
        ends = self.brackets.items()
        return known | {f"{name.partition('.')[2]}_bracket": list(pair) for name, pair in ends}


def satellites_in_view(
    constellation: Constellation,
    folds: Mapping[int, CertifiedShare],
    found: Ends,
    *,
    figure: Figure,
    mask: Mask,
    beam: float | None = None,
    motion: AnyMotion = "two-body",
    since: float = 0.0,
    duration: float | None = None,
    height: float = 0.0,
) -> InView:
    """Bound how many satellites are in view, by proofs of folds and by areas of caps.

    Of ellipses that keep their places the extremes are those of `fold_range`. Of others the shares
    by fold that are all or nothing tell them, and what some place was found to have. The mean is
    that of the caps' areas on a sphere, else the sum of the shares by fold. Users above the ground
    of a sphere, and below all satellites, stand on one.

    Parameters
    ----------
    constellation, figure, mask, beam, motion, since, duration, height
        As in `compass.coverage.certified_question.Question`, of which `folds` are answers.
    folds
        Shares with so many in view or more, from one on as far as any were found.
    found
        Fewest and most that some place was found to have.
    """
    c, model = constellation, as_motion(motion)
    extremes, radius = None, figure.equatorial_radius + height
    over_sphere = figure.is_sphere and float(c.periapsis_radius.min()) > radius
    level = beam is None and (height == 0.0 or over_sphere)
    if level and model.model == "two-body":
        extremes = _by_proof(c, radius, figure.stretch, mask, _span(c, since, duration))
    least, most = extremes or _by_shares(folds, found, c.size)
    circles = c.is_circular and model.is_closed_form
    whole = model.model == "two-body" and duration is None and one_period(c)
    if level and mask.is_constant and figure.is_sphere and (circles or whole):
        mean = mean_in_view(c, radius, mask.highest)
        return InView(least, (mean, mean), most)
    return InView(least, _mean_of_shares(folds, most[1]), most)


def _span(c: Constellation, since: float, duration: float | None) -> Span:
    """The time asked for."""
    if duration is None:
        return shortest_span(c)
    return Span(since, since + duration, False, "over the duration asked for")


def _by_proof(
    c: Constellation, sphere_radius: float, stretch: float, mask: Mask, span: Span
) -> tuple[Ends, Ends] | None:
    """Bounds of the extremes on ellipses; None where that would take long.

    A mask by azimuth leaves at least what its highest does, all around, and at most what its
    lowest does.
    """
    turns = float(c.mean_motion.max()) * (span.stop - span.start) / (2.0 * np.pi)
    if max(turns, 1.0) * c.size**2 > MOST_PAIRS:
        return None
    masks = dict.fromkeys((mask.highest, mask.lowest))
    each = [
        fold_range(c, sphere_radius=sphere_radius, mask=m, span=span, stretch=stretch)
        for m in masks
    ]
    (least, most), (least_of_low, most_of_low) = each[0], each[-1]
    return (least[0], least_of_low[1]), (most[0], most_of_low[1])


def _by_shares(
    folds: Mapping[int, CertifiedShare], found: Ends, satellites: int
) -> tuple[Ends, Ends]:
    """Bounds of the extremes from shares of all and of nothing, and from what was found."""
    always = max((k for k, share in folds.items() if share.low == 1.0), default=0)
    never = min((k for k, share in folds.items() if share.high == 0.0), default=satellites + 1)
    return (always, max(found[0], always)), (min(found[1], never - 1), never - 1)


def mean_in_view(c: Constellation, sphere_radius: float, mask: float) -> float:
    """Caps' parts of the sphere, added up: how many of them cover a place, in the mean."""
    anomaly = np.arange(MOMENTS if not c.is_circular else 1) * (2.0 * np.pi / MOMENTS)
    nearer = 1.0 - c.eccentricity[:, np.newaxis] * np.cos(anomaly)
    radius = cap_radius(c.semi_major_axis[:, np.newaxis] * nearer, sphere_radius, mask)
    # of equal steps in eccentric anomaly each lasts as long as the satellite is far
    return float((0.5 * (1.0 - np.cos(radius)) * nearer).mean(axis=1).sum())


def _mean_of_shares(folds: Mapping[int, CertifiedShare], most: int) -> tuple[float, float]:
    """Bounds of the mean: the sum of the shares with one in view or more, with two, ..."""
    beyond = max(most - len(folds), 0) * folds[max(folds)].high if folds else float(most)
    return sum(one.low for one in folds.values()), sum(
        min(one.high, 1.0) for one in folds.values()
    ) + beyond

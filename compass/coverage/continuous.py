"""All that is asked about continuous coverage at once: the claim, its extremes, margins, losses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compass.coverage.certificate import Certificate, Outcome, fold_range, prove_fold
from compass.coverage.margin import (
    TOLERANCE,
    CoveringRadius,
    Loss,
    after_losses,
    covering_radius,
    highest_mask,
    lowest_altitude,
    lowest_orbit,
)
from compass.coverage.region import GLOBE, Region
from compass.coverage.share import FoldShares, mean_fold_shares
from compass.coverage.symmetry import Span, shortest_span, unlike_subsets
from compass.errors import ArgumentError
from compass.orbits import Constellation
from compass.orbits.symmetry import one_circle
from compass.sites import Mask

#: What is settled of continuous coverage, in order.
STEPS = ("the claim", "folds", "cap radius and shares", "lowest altitude", "highest mask")


@dataclass(frozen=True)
class ContinuousCoverage:
    """What is known of "at least `fold` satellites above the mask, everywhere in a region".

    Attributes
    ----------
    outcome
        Of the claim with the mask as it is.
    certificate
        How it was settled; of a mask that depends on azimuth, with `mask` all around.
    mask
        Radians: what the numbers below are for, of a mask by azimuth its highest.
    span
        The time looked at.
    least, greatest
        Bounds (not below, not above) of the extreme folds.
    worst
        Where and when the fold-th nearest satellite is farthest; None for a region, and on an
        ellipsoid, where caps differ.
    caps_alike
        Whether all caps are alike for ever, so that the radius of `worst` means something.
    highest_mask
        Radians, or None if no mask will do.
    lowest_altitude
        Metres over the equator, proven at this very value; None where there is none, and for
        orbits that are not circles of one radius.
    shares
        Shares of area and time by fold, or None.
    losses
        For 1, 2, ... lost satellites the sets of a kind, worst first.
    """

    outcome: Outcome
    certificate: Certificate
    mask: float
    span: Span
    least: tuple[int, int]
    greatest: tuple[int, int]
    worst: CoveringRadius | None
    caps_alike: bool
    highest_mask: float | None
    lowest_altitude: float | None
    shares: FoldShares | None
    losses: tuple[tuple[Loss, ...], ...]


def continuous_coverage(
    constellation: Constellation,
    fold: int,
    *,
    sphere_radius: float,
    mask: Mask,
    region: Region = GLOBE,
    duration: float | None = None,
    stretch: float = 1.0,
    losses: int = 0,
    progress: Callable[[Sequence[Any]], Any] = iter,
    begin: Callable[[str, float], None] = lambda step, revolutions: None,
    watch: Callable[[Sequence[Any]], Any] = iter,
) -> ContinuousCoverage:
    """Settle continuous coverage, and how far it is from failing or from holding.

    A mask that depends on azimuth is held between two that do not: proven with its highest all
    around, it is proven; refuted with its lowest, it is refuted; else it is undecided.

    Parameters
    ----------
    constellation, fold, sphere_radius, region, stretch
        As in `prove_fold`.
    mask
        Of users on the surface.
    duration
        Seconds from the epoch to look at; None for all time where symmetry allows it.
    losses
        Look at every loss of 1 up to so many satellites.
    progress
        Wraps the list of sets of lost satellites, as tqdm does.
    begin
        Told each of `STEPS` before it is settled, and over how many revolutions of the fastest
        satellite, which is what it costs.
    watch
        Wraps the list of revolutions of every proof, as tqdm does.

    Raises
    ------
    ArgumentError
        As `prove_fold`, `shortest_span` and `unlike_subsets`.
    """
    c, sphere = constellation, sphere_radius
    if losses < 0:
        raise ArgumentError(f"losses = {losses}: allowed 0 to {c.size}, the number of satellites")
    span = shortest_span(c, region, duration)
    if losses:
        unlike_subsets(c, losses, region, duration)  # refuse too many before any work
    turns = _revolutions(c, span)
    begin(STEPS[0], turns)
    outcome, certificate = _settle(c, fold, sphere, mask, region, span, stretch, watch)
    begin(STEPS[1], turns)
    # caps are alike on a sphere only
    high, globe, alike = mask.highest, region.is_globe, one_circle(c) and stretch == 1.0
    least, greatest = fold_range(
        c,
        sphere_radius=sphere,
        mask=high,
        region=region,
        span=span,
        stretch=stretch,
        progress=watch,
    )
    begin(STEPS[2], turns)
    worst = None
    if globe and stretch == 1.0:
        worst = covering_radius(c, fold, span=span, tolerance=0.5 * TOLERANCE, progress=watch)
    shares = (
        mean_fold_shares(c, sphere_radius=sphere, mask=high, span=span) if globe and alike else None
    )
    guess = None
    if worst is not None and alike and np.isfinite(worst.radius):
        guess = lowest_altitude(worst.radius, sphere, high)
    begin(STEPS[3], turns)
    altitude = lowest_orbit(
        c,
        fold,
        sphere_radius=sphere,
        mask=high,
        region=region,
        duration=duration,
        stretch=stretch,
        guess=guess,
        progress=watch,
    )
    lost = tuple(
        tuple(
            after_losses(
                c,
                number,
                fold,
                sphere_radius=sphere,
                mask=high,
                region=region,
                duration=duration,
                stretch=stretch,
                progress=progress,
            )
        )
        for number in range(1, losses + 1)
    )
    begin(STEPS[4], turns)
    margin = highest_mask(
        c,
        fold,
        sphere_radius=sphere,
        region=region,
        span=span,
        stretch=stretch,
        radius=None if worst is None else worst.radius,
        progress=watch,
    )
    return ContinuousCoverage(
        outcome=outcome,
        certificate=certificate,
        mask=high,
        span=span,
        least=least,
        greatest=greatest,
        worst=worst,
        caps_alike=alike,
        highest_mask=margin,
        lowest_altitude=altitude,
        shares=shares,
        losses=lost,
    )


def _revolutions(c: Constellation, span: Span) -> float:
    """How often the fastest satellite goes round in a span."""
    return float(c.mean_motion.max(initial=0.0)) * (span.stop - span.start) / (2.0 * np.pi)


def _settle(
    c: Constellation,
    fold: int,
    sphere: float,
    mask: Mask,
    region: Region,
    span: Span,
    stretch: float,
    watch: Callable[[Sequence[Any]], Any],
) -> tuple[Outcome, Certificate]:
    """Outcome and certificate of the claim, between the highest and the lowest of the mask."""

    def with_constant(elevation: float) -> Certificate:
        return prove_fold(
            c,
            fold,
            sphere_radius=sphere,
            mask=elevation,
            region=region,
            span=span,
            stretch=stretch,
            progress=watch,
        )

    highest = with_constant(mask.highest)
    if mask.is_constant or highest.outcome is Outcome.PROVEN:
        return highest.outcome, highest
    lowest = with_constant(mask.lowest)
    if lowest.outcome is Outcome.REFUTED:
        return lowest.outcome, lowest
    return Outcome.UNDECIDED, highest

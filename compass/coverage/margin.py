"""Margins of continuous coverage: smallest cap, highest mask, lowest orbit, satellites to spare."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.nearest import worst_radius
from compass.coverage.cap import mask_for_cap
from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, Region
from compass.coverage.symmetry import Span, shortest_span, unlike_subsets
from compass.orbits import Constellation
from compass.orbits.symmetry import one_circle

#: To what smallest cap radii and mask margins are found, radians.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class CoveringRadius:
    """Smallest common cap radius for continuous k-fold coverage of the whole sphere.

    Attributes
    ----------
    radius
        With caps of this radius coverage is continuous; radians, infinite without k satellites.
    at_least
        With less than this it is not: `time` and `place` are the counter-example.
    time
        Seconds after the epoch.
    place
        Unit vector in the inertial frame.
    """

    radius: float
    at_least: float
    time: float
    place: NDArray[np.float64]


def covering_radius(
    constellation: Constellation,
    fold: int,
    *,
    span: Span | None = None,
    tolerance: float = TOLERANCE,
    max_intervals: int = 1_000_000,
) -> CoveringRadius:
    """Bracket lambda_min: the greatest distance to the `fold`-th nearest satellite, any time.

    Refined in time by bisection, with bounds from the satellites' rates, not sampled: the
    bracket is proven (to rounding) and at most `tolerance` wide unless `max_intervals` is met.
    """
    span = span or shortest_span(constellation)
    motion = motion_of(constellation, span)
    least, most, time, place, _ = worst_radius(
        motion.orbits,
        motion.poles,
        motion.gm,
        motion.spin,
        fold,
        span.start,
        span.stop,
        0.9 * tolerance,
        np.inf,
        max_intervals,
    )
    return CoveringRadius(float(most) + span.mismatch, float(least), float(time), place)


def highest_mask(
    constellation: Constellation,
    fold: int,
    *,
    sphere_radius: float,
    region: Region = GLOBE,
    span: Span | None = None,
    tolerance: float = TOLERANCE,
) -> float | None:
    """Highest elevation mask with continuous `fold`-fold coverage, radians; it may be negative.

    Circular orbits of one radius and the whole sphere: from `covering_radius`. Otherwise by
    halving a range of masks, each half settled by `prove_fold`. The mask is on the safe side,
    by at most `tolerance`; None if no mask will do.
    """
    span = span or shortest_span(constellation, region)
    if constellation.size < fold:
        return None
    if region.is_globe and one_circle(constellation):
        radius = covering_radius(constellation, fold, span=span, tolerance=0.5 * tolerance).radius
        return float(mask_for_cap(radius, constellation.semi_major_axis[0], sphere_radius))

    def holds(mask: float) -> bool:
        outcome = prove_fold(
            constellation,
            fold,
            sphere_radius=sphere_radius,
            mask=mask,
            region=region,
            span=span,
            tolerance=0.1 * tolerance,
            max_intervals=200_000,
        ).outcome
        return outcome == "proven"

    low, high = -np.pi / 2 + 1e-9, np.pi / 2 - 1e-9
    if not holds(low):
        return None
    while high - low > 0.9 * tolerance:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return float(low)


def lowest_altitude(radius: float, sphere_radius: float, mask: float = 0.0) -> float | None:
    """Altitude at which caps reach a radius: ``r = R cos(e) / cos(lambda + e)``, metres.

    A pattern of equal circular orbits needs the same cap radius at any height. None if no
    height gives such caps (``lambda + e`` of a right angle or more).
    """
    reach = radius + mask
    if reach >= np.pi / 2:
        return None
    return float(sphere_radius * np.cos(mask) / np.cos(reach) - sphere_radius)


@dataclass(frozen=True)
class Loss:
    """What is left after a set of satellites fails.

    Attributes
    ----------
    satellites
        The names of one set.
    alike
        How many sets it stands for, itself among them.
    least
        Least fold for all time that is left, as bounds (not below, not above).
    radius
        Cap radius then needed for the fold wanted, radians; None for orbits or a region for
        which one common radius says nothing.
    """

    satellites: tuple[str, ...]
    alike: int
    least: tuple[int, int]
    radius: float | None

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        low, high = self.least
        return {
            "satellites": list(self.satellites),
            "alike": self.alike,
            "min_fold": low if low == high else None,
            "min_fold_bounds": [low, high],
            "cap_radius_min_deg": None if self.radius is None else float(np.degrees(self.radius)),
        }


def after_losses(
    constellation: Constellation,
    losses: int,
    fold: int,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    duration: float | None = None,
    tolerance: float = 1e-4,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> list[Loss]:
    """Exact least fold after every loss of `losses` satellites, the most harmful first.

    Sets that a turn carries into one another, or for all time a delay or reversal, are alike,
    and one of them is looked at. The order is by least fold, then by the cap radius needed.

    Parameters
    ----------
    constellation, sphere_radius, mask, region
        As in `prove_fold`.
    losses
        How many fail at once.
    fold
        Fold for which the needed cap radius is found.
    duration
        As in `shortest_span`.
    tolerance
        To what the cap radii are found, radians.
    progress
        Wraps the list of sets, as tqdm does.

    Raises
    ------
    ArgumentError
        As `unlike_subsets`.
    """
    alike = unlike_subsets(constellation, losses, region, duration)
    found = []
    for subset in progress(list(alike.sets)):
        left = constellation.without(subset)
        span = shortest_span(left, region, duration)
        span = replace(span, mismatch=span.mismatch + alike.mismatch)
        least, _ = fold_range(
            left, sphere_radius=sphere_radius, mask=mask, region=region, span=span, greatest=False
        )
        radius = None
        if region.is_globe and one_circle(left):
            radius = covering_radius(left, fold, span=span, tolerance=tolerance).radius
        names = tuple(constellation.satellite_names[s] for s in subset)
        found.append(Loss(names, alike.sets[subset], least, radius))
    return sorted(found, key=lambda loss: (loss.least, -(loss.radius or 0.0), loss.satellites))

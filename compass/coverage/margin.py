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
from compass.coverage.stretches import revolutions
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
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> CoveringRadius:
    """Bracket lambda_min: the greatest distance to the `fold`-th nearest satellite, any time.

    Refined in time by bisection, with bounds from the satellites' rates, not sampled: the
    bracket is proven (to rounding) and at most `tolerance` wide unless `max_intervals` is met.
    `progress` wraps the list of revolutions, as tqdm does.
    """
    span = span or shortest_span(constellation)
    orbits, frame = motion_of(constellation, span)
    least, most, time, place, nodes = -1.0, 0.0, span.start, np.zeros(3), 0
    for start, stop in progress(revolutions(constellation, span.start, span.stop)):
        reached, bound, when, where, looked = worst_radius(
            orbits,
            frame.spin,
            fold,
            start,
            stop,
            start,
            least,
            0.9 * tolerance,
            np.inf,
            max_intervals - nodes,
        )
        if reached > least:
            least, time, place = float(reached), float(when), where
        most, nodes = max(most, float(bound)), nodes + int(looked)
    radius = most + span.mismatch
    # half a turn covers the sphere, whatever stands beside the bound
    return CoveringRadius(min(radius, np.pi) if np.isfinite(radius) else radius, least, time, place)


def highest_mask(
    constellation: Constellation,
    fold: int,
    *,
    sphere_radius: float,
    region: Region = GLOBE,
    span: Span | None = None,
    stretch: float = 1.0,
    tolerance: float = TOLERANCE,
    radius: float | None = None,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> float | None:
    """Highest elevation mask with continuous `fold`-fold coverage, radians; it may be negative.

    Circular orbits of one radius and the whole of a sphere: from `covering_radius`. Otherwise by
    halving a range of masks, each half settled by `prove_fold`. The mask is on the safe side,
    by at most `tolerance`; None if no mask will do. A `radius` that `covering_radius` has found
    to half of that is not found again.
    """
    span = span or shortest_span(constellation, region)
    if constellation.size < fold:
        return None
    low, high = -np.pi / 2 + 1e-9, np.pi / 2 - 1e-9
    if region.is_globe and one_circle(constellation):
        if radius is None:
            radius = covering_radius(
                constellation, fold, span=span, tolerance=0.5 * tolerance, progress=progress
            ).radius
        mask = float(mask_for_cap(radius, constellation.semi_major_axis[0], sphere_radius))
        if stretch == 1.0:
            return mask
        low, high = mask - FLATTEST * (stretch - 1.0), mask + FLATTEST * (stretch - 1.0)

    def holds(mask: float) -> bool:
        return -np.pi / 2 < mask < np.pi / 2 and _holds(
            constellation,
            fold,
            sphere_radius=sphere_radius,
            mask=mask,
            region=region,
            span=span,
            stretch=stretch,
            tolerance=0.1 * tolerance,
            progress=progress,
        )

    if not holds(low):
        low, high = -np.pi / 2 + 1e-9, low
        if not holds(low):
            return None
    elif holds(high):
        low, high = high, np.pi / 2 - 1e-9
    return _last(holds, low, high, 0.9 * tolerance)


#: How far the highest mask of an ellipsoid may be from that of the sphere, in units of its
#: stretch, before all masks are searched. Vertical and place change by about one such unit each.
FLATTEST = 4.0


def lowest_altitude(radius: float, sphere_radius: float, mask: float = 0.0) -> float | None:
    """Altitude at which caps reach a radius: ``r = R cos(e) / cos(lambda + e)``, metres.

    A pattern of equal circular orbits needs the same cap radius at any height. None if no
    height gives such caps (``lambda + e`` of a right angle or more).
    """
    reach = radius + mask
    if reach >= np.pi / 2:
        return None
    return float(sphere_radius * np.cos(mask) / np.cos(reach) - sphere_radius)


def lowest_orbit(
    constellation: Constellation,
    fold: int,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    duration: float | None = None,
    stretch: float = 1.0,
    guess: float | None = None,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> float | None:
    """Altitude down to which circular orbits of one radius keep continuous coverage, metres.

    The same nodes and phases at the epoch, on other orbits. Lower satellites have smaller caps
    and show, in a given time, all that higher ones show and more, so there is a least altitude;
    it is found by halving, each half settled by `prove_fold` over its own span. What is returned
    is a whole multiple of 100 m (of 1 km above 100,000 km) over the equator, at which the claim
    is proven; None if there is none up to `FARTHEST`.

    Parameters
    ----------
    constellation, fold, sphere_radius, mask, region, stretch
        As in `prove_fold`.
    duration
        As in `shortest_span`.
    guess
        Where to begin, metres; the answer does not depend on it.
    progress
        As in `prove_fold`.
    """
    c = constellation
    if not one_circle(c) or c.size < fold or region.mars_fixed:
        return None
    axis = float(c.semi_major_axis[0])
    about = axis - sphere_radius if guess is None else guess
    unit = 100.0 if about < 1e8 else 1000.0

    def holds(steps: float) -> bool:
        lower = replace(c, semi_major_axis=np.full(c.size, sphere_radius + steps * unit))
        return _holds(
            lower,
            fold,
            sphere_radius=sphere_radius,
            mask=mask,
            region=region,
            span=shortest_span(lower, region, duration),
            stretch=stretch,
            progress=progress,
        )

    high, low = max(2.0, np.ceil(about / unit)), 1.0
    step = 1.0 if guess is not None else max(1.0, high // 8)
    if holds(high):
        # down from a guess that is near, in steps that double
        while high - step > 1.0 and holds(high - step):
            high, step = high - step, 2.0 * step
        low = max(1.0, high - step)
        if low == 1.0 and holds(low):
            return unit
    else:
        while not holds(high):
            low, high, step = high, high + step, 2.0 * step
            if high * unit > FARTHEST * sphere_radius:
                return None
    while high - low > 1.0:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return float(high * unit)


#: Height, in radii, beyond which no lowest orbit is looked for.
FARTHEST = 1000.0


def _holds(constellation: Constellation, fold: int, **claim: Any) -> bool:
    """Whether a claim is proven, within an effort that suits one of many."""
    certificate = prove_fold(constellation, fold, max_intervals=MAX_INTERVALS_OF_MANY, **claim)
    return certificate.outcome == "proven"


def _last(holds: Callable[[float], bool], low: float, high: float, tolerance: float) -> float:
    """Halve down to the last value that holds, to `tolerance`; `low` does, `high` does not."""
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return float(low)


#: Intervals to look at for one of many claims.
MAX_INTERVALS_OF_MANY = 200_000


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
    stretch: float = 1.0,
    tolerance: float = 1e-4,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> list[Loss]:
    """Exact least fold after every loss of `losses` satellites, the most harmful first.

    Sets that a turn carries into one another, or for all time a delay or reversal, are alike,
    and one of them is looked at. The order is by least fold, then by the cap radius needed.

    Parameters
    ----------
    constellation, sphere_radius, mask, region, stretch
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
    margins = []
    for subset in progress(list(alike.sets)):
        left = constellation.without(subset)
        span = shortest_span(left, region, duration)
        span = replace(span, mismatch=span.mismatch + alike.mismatch)
        least, _ = fold_range(
            left,
            sphere_radius=sphere_radius,
            mask=mask,
            region=region,
            span=span,
            stretch=stretch,
            greatest=False,
        )
        radius = None
        if stretch == 1.0 and region.is_globe and one_circle(left):
            radius = covering_radius(left, fold, span=span, tolerance=tolerance).radius
        names = tuple(constellation.satellite_names[s] for s in subset)
        margins.append(Loss(names, alike.sets[subset], least, radius))
    return sorted(margins, key=lambda loss: (loss.least, -(loss.radius or 0.0), loss.satellites))

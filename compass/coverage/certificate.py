"""Proof, not sample, of continuous coverage: every moment of a span and every point of a region."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.certificate import KEPT, PROVEN, REFUTED, UNDECIDED, Ground, settle
from compass.coverage.cap import cap_radius
from compass.coverage.fold import caps_of, fold_extremes
from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, Region
from compass.coverage.stretches import revolutions
from compass.coverage.symmetry import Span, shortest_span
from compass.coverage.witness import Witness, find_witness
from compass.errors import ArgumentError, whole_number
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation


class Outcome(StrEnum):
    """What came of a claim, each with a sentence that says what it means."""

    PROVEN = "proven"
    REFUTED = "refuted"
    UNDECIDED = "undecided"

    @property
    def sentence(self) -> str:
        """What it means."""
        return _SENTENCES[self]


_SENTENCES = {
    Outcome.PROVEN: "It holds at every place and moment looked at; nothing was sampled.",
    Outcome.REFUTED: "It fails at the place and moment of the witness, confirmed without caps.",
    Outcome.UNDECIDED: "Neither could be shown: it holds or fails by less than is resolved.",
}


#: Intervals in which no cap moves more than this, radians, are not split further.
TOLERANCE = 1e-9

#: Likewise in a first look at all of the time: where the claim is all but broken intervals are
#: split for long, and a moment that breaks it plainly may come after them.
GLANCE = 1e-5

#: Intervals to look at before giving up: a minute or so for 15 satellites.
MAX_INTERVALS = 1_000_000


@dataclass(frozen=True)
class Certificate:
    """What was settled about "at least `fold` satellites above the mask", and how.

    Attributes
    ----------
    outcome
        ``proven``, ``refuted`` or ``undecided``.
    fold
        As claimed.
    span
        The time looked at, and what it stands for.
    region
        Where.
    intervals
        Intervals looked at.
    tolerance
        Radians: to what motion of the caps intervals were split.
    witness
        The counter-example of a refuted claim.
    unsettled
        First intervals, seconds, of an undecided claim.
    """

    outcome: Outcome
    fold: int
    span: Span
    region: Region
    intervals: int
    tolerance: float
    witness: Witness | None = None
    unsettled: tuple[tuple[float, float], ...] = ()


def prove_fold(
    constellation: Constellation,
    fold: int,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    span: Span | None = None,
    stretch: float = 1.0,
    tolerance: float = TOLERANCE,
    max_intervals: int = MAX_INTERVALS,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> Certificate:
    """Prove or refute that `fold` satellites are above the mask everywhere, all the time.

    If at the middle of an interval the fold of caps shrunk by the furthest they can stray in
    half of it is `fold` or more, it is so in the whole interval; intervals are halved until all
    are settled or a counter-example turns up, which is then confirmed without caps.

    Parameters
    ----------
    constellation
        The orbits, in two-body motion.
    fold
        At least 1.
    sphere_radius, mask
        Metres and radians.
    region, span
        Where, and when; without `span` the one of `shortest_span`.
    stretch
        Ratio of the equatorial radius, `sphere_radius`, to the polar one: 1 for a sphere. On an
        ellipsoid elevations are over its normal; caps lie between bounds (`core.figure`) that are
        narrowed by halving bands of latitude, and the witness is confirmed on the ellipsoid.
    tolerance, max_intervals
        When to give up, see `Certificate`; margins below the tolerance stay undecided.
    progress
        Wraps the list of revolutions, as tqdm does.

    Raises
    ------
    ArgumentError
        An orbit meets the sphere, a mask outside (-pi/2, pi/2), or a fold below 1.
    """
    _check(constellation, fold, sphere_radius, mask)
    span = span or shortest_span(constellation, region)
    figure = (sphere_radius, stretch)
    nodes, unsettled = 0, list[tuple[float, float]]()
    for near in dict.fromkeys((max(GLANCE, tolerance), tolerance)):
        left = max_intervals - nodes
        outcome, looked, unsettled, time, point, _ = _settle(
            constellation, figure, mask, region, span, True, fold, near, left, progress
        )
        nodes += looked
        if outcome == PROVEN:
            return Certificate(Outcome.PROVEN, fold, span, region, nodes, tolerance)
        if outcome == REFUTED:
            point = point / [1.0, 1.0, stretch]
            point /= np.linalg.norm(point)
            if region.mars_fixed:
                point = mcmf_from_mci(point, -prime_meridian_angle(constellation.epoch, time))
            witness = find_witness(
                constellation, sphere_radius, mask, fold, time, point, region, stretch
            )
            if witness:
                return Certificate(Outcome.REFUTED, fold, span, region, nodes, tolerance, witness)
            unsettled = [(time, time)]
    kept = tuple(unsettled)
    return Certificate(Outcome.UNDECIDED, fold, span, region, nodes, tolerance, None, kept)


def fold_range(
    constellation: Constellation,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    span: Span | None = None,
    greatest: bool = True,
    stretch: float = 1.0,
    tolerance: float = 1e-7,
    max_intervals: int = 20_000,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Least and greatest fold over a region and all the time of a span, each as bounds.

    Parameters
    ----------
    constellation, sphere_radius, mask, region, span, stretch, tolerance, max_intervals, progress
        As in `prove_fold`, with its errors.
    greatest
        Whether to settle the greatest too; else its bounds are those of the first moment and
        the number of satellites.

    Returns
    -------
    least, greatest
        Pairs (not below, not above); equal where the extreme is settled. The greatest is that
        of cells: two rims that touch for a moment do not count.
    """
    _check(constellation, 1, sphere_radius, mask)
    span = span or shortest_span(constellation, region)
    directions, radius = caps_of(constellation, sphere_radius, mask, span.start)
    if region.mars_fixed:
        turn = prime_meridian_angle(constellation.epoch, span.start)
        directions = mcmf_from_mci(directions, turn)
    now = fold_extremes(directions, radius, region)
    bounds, n = [], constellation.size
    for low, k, reached in (
        (True, now.least, now.least_reached),
        (False, now.greatest, now.greatest_reached),
    ):
        step, figure = (-1 if low else 1), (sphere_radius, stretch)
        if stretch != 1.0:
            # the sphere's extreme is a first guess, and one that no place is known to have
            k, reached = (k + 1, n) if low else (k - 1, 0)
        if not (low or greatest):
            bounds.append((reached, n))
            continue
        outcome, unsure = -1, False
        while outcome != PROVEN:
            outcome, *_, fold = _settle(
                constellation,
                figure,
                mask,
                region,
                span,
                low,
                k,
                tolerance,
                max_intervals,
                progress,
            )
            if outcome == REFUTED:
                k = reached = int(fold)
            elif outcome != PROVEN:
                k, unsure = k + step, True
            elif stretch != 1.0 and not unsure and reached == (n if low else 0) != k:
                outcome, k = -1, k - step  # proven at the first guess: how far does it go?
        bounds.append((k, reached) if low else (reached, k))
    return bounds[0], bounds[1]


def _settle(
    constellation: Constellation,
    figure: tuple[float, float],
    mask: float,
    region: Region,
    span: Span,
    low: bool,
    k: int,
    tolerance: float,
    max_intervals: int,
    progress: Callable[[Sequence[Any]], Any],
) -> tuple[int, int, list[tuple[float, float]], float, NDArray[np.float64], int]:
    """Run the kernel on a claim; `figure` is the equatorial radius and the stretch.

    Returns
    -------
    outcome, nodes, unsettled, time, point, fold
        As of the kernel, of all revolutions together.
    """
    sphere_radius, stretch = figure
    orbits, frame = motion_of(constellation, span, region, about_pole=stretch != 1.0)
    frame = frame._replace(error=frame.error * stretch)
    ground, sides = Ground(sphere_radius, stretch, mask), region.stretched(stretch).sides
    nodes, unsettled = 0, list[tuple[float, float]]()
    for start, stop in progress(revolutions(constellation, span.start, span.stop)):
        outcome, looked, parts, open_, time, point, fold = settle(
            orbits,
            frame,
            ground,
            sides,
            low,
            k,
            start,
            stop,
            tolerance,
            max_intervals - nodes,
        )
        nodes += int(looked)
        unsettled += [(float(a), float(b)) for a, b in open_[: min(parts, KEPT)]]
        if outcome == REFUTED:
            return REFUTED, nodes, unsettled[:KEPT], float(time), point, int(fold)
    return UNDECIDED if unsettled else PROVEN, nodes, unsettled[:KEPT], 0.0, np.zeros(3), 0


def _check(constellation: Constellation, fold: int, sphere_radius: float, mask: float) -> None:
    whole_number("fold", fold, 1)
    if not -np.pi / 2 < mask < np.pi / 2:
        raise ArgumentError(f"mask_deg = {np.degrees(mask):g}: allowed above -90 up to below 90")
    cap_radius(constellation.periapsis_radius, sphere_radius, mask)

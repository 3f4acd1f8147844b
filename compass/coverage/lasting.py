"""How long coverage lasts on real paths: proven for so many days, or lost at a moment and a place.

Nothing but the paths counts: no symmetry, no label.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.lasting import (
    ABOUT_POLE,
    FREE,
    LOST,
    PROVEN,
    WITH_MARS,
    first_loss,
    least_margin,
    margins,
)
from compass.coverage.cap import cap_radius
from compass.coverage.certificate import Outcome
from compass.coverage.region import GLOBE, Region
from compass.coverage.witness import Witness, witness_among
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, mcmf_from_mci, prime_meridian_angle
from compass.orbits.motion import check_span
from compass.orbits.trajectory import Trajectory

#: The moment of a loss is found to this, s.
RESOLUTION = 1.0

#: Intervals in which no cap moves more than this, radians, or than its path's error, are not split.
TOLERANCE = 1e-9

#: Intervals to look at before giving up: minutes for 15 satellites.
MAX_INTERVALS = 4_000_000


@dataclass(frozen=True)
class Lasting:
    """What was settled about "at least `fold` satellites above the mask" along paths.

    Attributes
    ----------
    outcome
        Proven to the end of the span, refuted (lost), or undecided.
    fold, region
        The claim.
    start, stop
        Span looked at, seconds after the epoch.
    proven_until
        Up to when it is proven.
    lost_at
        When it is surely lost, by `RESOLUTION` after `proven_until` where nothing was left open
        between; None if it is not.
    witness
        Place and satellites at `lost_at`.
    unsettled
        First intervals left open, seconds.
    intervals
        Intervals looked at.
    source
        What the paths stand for.
    estimated
        How their error was estimated, if it is no bound.
    """

    outcome: Outcome
    fold: int
    region: Region
    start: float
    stop: float
    proven_until: float
    lost_at: float | None
    witness: Witness | None
    unsettled: tuple[tuple[float, float], ...]
    intervals: int
    source: str
    estimated: str

    @property
    def days_proven(self) -> float:
        """Days from the start for which the claim is proven."""
        return (self.proven_until - self.start) / SECONDS_PER_DAY

    @property
    def first_loss_days(self) -> float | None:
        """Days after the epoch at which it is lost; None if it is not."""
        return None if self.lost_at is None else self.lost_at / SECONDS_PER_DAY


def prove_span(
    path: Trajectory,
    fold: int,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    start: float | None = None,
    stop: float | None = None,
    max_intervals: int = MAX_INTERVALS,
) -> Lasting:
    """Prove that `fold` satellites are above the mask everywhere over a span, or find the loss.

    Bounds and their derivation: `compass.core.lasting`. A loss is confirmed without caps, from the
    triangles of centre, user and satellite, beyond what the paths' error can do.

    Parameters
    ----------
    path
        The paths.
    fold
        At least 1.
    sphere_radius, mask
        Metres and radians.
    region
        Where.
    start, stop
        Seconds after the epoch; the ends of the paths if left out.
    max_intervals
        When to give up.

    Raises
    ------
    ArgumentError
        A fold below 1, a mask outside (-pi/2, pi/2), a span outside the paths, or a path that
        meets the sphere.
    """
    begin, end = _span(path, start, stop)
    _check(path, fold, sphere_radius, mask, begin, end)
    arrays = _arrays(path, sphere_radius, mask, region)
    outcome, nodes, proven, lost, place, parts, unsettled = first_loss(
        *arrays, fold, begin, end, RESOLUTION, TOLERANCE, max_intervals
    )
    witness = None
    if outcome == LOST:
        witness = _confirm(path, fold, sphere_radius, mask, region, lost, place)
    result = {PROVEN: Outcome.PROVEN, LOST: Outcome.REFUTED}.get(outcome, Outcome.UNDECIDED)
    kept = [(float(a), float(b)) for a, b in unsettled[: min(parts, len(unsettled))]]
    if outcome == LOST and witness is None:
        result, lost, kept = Outcome.UNDECIDED, np.inf, [*kept, (float(proven), float(end))]
    return Lasting(
        result,
        fold,
        region,
        begin,
        end,
        float(proven),
        float(lost) if np.isfinite(lost) else None,
        witness,
        tuple(kept),
        int(nodes),
        path.source,
        path.estimated,
    )


def margins_at(
    path: Trajectory,
    fold: int,
    times: ArrayLike,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    tolerance: float = 1e-6,
) -> NDArray[np.float64]:
    """By how much all caps may shrink with the fold kept, radians, at moments; negative if lost.

    Exact to `tolerance`, on the safe side. With caps of one size it is the cap's radius less the
    covering radius of the moment.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    check_span(path, float(seconds.min()), float(seconds.max()))
    arrays = _arrays(path, sphere_radius, mask, region)
    return np.asarray(margins(*arrays, fold, seconds, tolerance))


def least_margins(
    path: Trajectory,
    fold: int,
    edges: ArrayLike,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    tolerance: float = 1e-4,
) -> NDArray[np.float64]:
    """Least margin between each moment and the next: proven bounds, radians, shape (t - 1, 2)."""
    seconds = np.asarray(edges, dtype=float)
    arrays = _arrays(path, sphere_radius, mask, region)
    found = [
        least_margin(*arrays, fold, a, b, tolerance, MAX_INTERVALS)[:2]
        for a, b in pairwise(seconds)
    ]
    return np.array(found).reshape(-1, 2)


def _span(path: Trajectory, start: float | None, stop: float | None) -> tuple[float, float]:
    begin = path.start if start is None else start
    end = path.stop if stop is None else stop
    if end <= begin:
        raise ArgumentError(
            f"days = {(end - begin) / SECONDS_PER_DAY:g}: must be more than 0; give a longer span"
        )
    check_span(path, begin, end)
    return max(begin, path.start), min(end, path.stop)


def _check(
    path: Trajectory, fold: int, sphere_radius: float, mask: float, start: float, stop: float
) -> None:
    if fold < 1:
        raise ArgumentError(f"fold = {fold}: must be a whole number from 1 on")
    if not -np.pi / 2 < mask < np.pi / 2:
        raise ArgumentError(f"mask_deg = {np.degrees(mask):g}: allowed above -90 up to below 90")
    times = 0.5 * (path.breaks[1:] + path.breaks[:-1])
    inside = times[(times >= start) & (times <= stop)]
    r = path.states(np.concatenate([[start], inside, [stop]]))[0]
    cap_radius(np.linalg.norm(r, axis=-1), sphere_radius, mask)


def _arrays(path: Trajectory, sphere_radius: float, mask: float, region: Region) -> tuple:
    """What all kernels take first."""
    frame = WITH_MARS if region.mars_fixed else FREE if region.is_globe else ABOUT_POLE
    turns = prime_meridian_angle(path.epoch, path.breaks)
    return (
        path.breaks,
        path.paths,
        path.errors,
        turns,
        frame,
        sphere_radius,
        mask,
        region.normals,
        region.floors,
    )


def _confirm(
    path: Trajectory,
    fold: int,
    sphere_radius: float,
    mask: float,
    region: Region,
    time: float,
    place: NDArray[np.float64],
) -> Witness | None:
    """Witness at a place that the kernel found, in the frame of the region; None if in doubt."""
    angle = float(prime_meridian_angle(path.epoch, time))
    start = mcmf_from_mci(place, -angle) if region.mars_fixed else place
    piece = int(np.clip(np.searchsorted(path.breaks, time) - 1, 0, len(path.errors) - 1))
    positions = path.states([time])[0][:, 0]
    # an error of e sideways lifts or lowers a satellite by e over its distance from the user, which
    # is that of the rim of its cap for one that stands near the mask
    rim = sphere_radius * np.cos(mask)
    near = np.sqrt((positions * positions).sum(axis=-1) - rim * rim) - sphere_radius * np.sin(mask)
    sure = 1e-12 + float((path.errors[piece] / near).max())
    names = path.satellite_names
    return witness_among(
        positions, names, angle, sphere_radius, mask, fold, time, start, region, sure
    )

"""How long coverage lasts on real paths: proven for so many days, or lost at a moment and a place.

Nothing but the paths counts: no symmetry, no label.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.fold import Sides
from compass.core.lasting import (
    ABOUT_POLE,
    FREE,
    KEPT,
    LOST,
    UNDECIDED,
    WITH_MARS,
    MovingCaps,
    first_loss,
    least_margin,
    margins,
)
from compass.coverage.cap import cap_radius
from compass.coverage.certificate import Outcome
from compass.coverage.region import GLOBE, Region
from compass.coverage.stretches import between_breaks, check_pairs
from compass.coverage.witness import Witness, witness_among
from compass.errors import ArgumentError, found_so_far, whole_number
from compass.frames import SECONDS_PER_DAY, mcmf_from_mci, prime_meridian_angle
from compass.orbits.motion import check_span
from compass.orbits.trajectory import Trajectory

#: The moment of a loss is found to this, s.
RESOLUTION = 1.0

#: Intervals in which no cap moves more than this, radians, or than its path's error, are not split.
TOLERANCE = 1e-9

#: Intervals to look at before giving up: minutes for 15 satellites.
MAX_INTERVALS = 4_000_000

#: How near bounds of an ellipsoid's margins come, radians.
VAGUE = 2e-4

#: Bands of latitude, sines, that are halved no further where an ellipsoid's caps are too vague.
NARROWEST = 0.02


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
    stretch
        Ratio of the equatorial radius of the users' figure to the polar one.
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
    stretch: float = 1.0

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
    stretch: float = 1.0,
    max_intervals: int = MAX_INTERVALS,
    progress: Callable[[Sequence[Any]], Any] = iter,
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
    stretch
        Ratio of the equatorial radius, `sphere_radius`, to the polar one: 1 for a sphere. On an
        ellipsoid elevations are over its normal; where bounds on its caps are too wide to decide,
        bands of latitude are halved.
    max_intervals
        When to give up.
    progress
        Wraps the list of days, as tqdm does.

    Raises
    ------
    ArgumentError
        A fold below 1, a mask outside (-pi/2, pi/2), a span outside the paths, a path that
        meets the sphere, or as `check_pairs`.
    """
    begin, end = _span(path, start, stop)
    _check(path, fold, sphere_radius, mask, begin, end)
    figure, nodes = (sphere_radius, stretch, mask), 0
    proven, lost, place = begin, np.inf, np.zeros(3)
    open_: list[tuple[float, float]] = []
    days = between_breaks(path.breaks, begin, end, SECONDS_PER_DAY)
    check_pairs(path.size, len(days))
    with found_so_far(lambda: f"proven up to day {proven / SECONDS_PER_DAY:.6g}"):
        for left, right in progress(days):
            looked, until, lost, place, parts = _bands(
                path, figure, region, fold, left, right, max_intervals - nodes
            )
            proven = proven if open_ else until
            open_ += parts
            nodes += looked
            if lost < np.inf:
                break
    kept = sorted(open_)[:KEPT]
    witness = None
    if lost < np.inf:
        witness = _confirm(path, fold, figure, region, lost, place)
        if witness is None:
            lost, kept = np.inf, [*kept, (proven, end)]
    result = Outcome.PROVEN if not kept else Outcome.UNDECIDED
    return Lasting(
        Outcome.REFUTED if witness else result,
        fold,
        region,
        begin,
        end,
        proven,
        float(lost) if np.isfinite(lost) else None,
        witness,
        tuple(kept),
        nodes,
        path.source,
        path.estimated,
        stretch,
    )


def _bands(
    path: Trajectory,
    figure: tuple[float, float, float],
    region: Region,
    fold: int,
    start: float,
    stop: float,
    max_intervals: int,
) -> tuple[int, float, float, NDArray[np.float64], list[tuple[float, float]]]:
    """Settle a stretch of time in bands of latitude, halved while their caps are too vague.

    Returns
    -------
    nodes, proven, lost, place, unsettled
        As of `first_loss`, of all bands together.
    """
    stretch, nodes, lost, place = figure[1], 0, np.inf, np.zeros(3)
    proven, unsettled = stop, list[tuple[float, float]]()
    bands = [(-1.0, 1.0)]
    while bands:
        south, north = bands.pop()
        outcome, looked, until, end, point, parts, open_ = first_loss(
            _caps(path, *figure, region, (south, north)),
            fold,
            start,
            min(stop, lost),
            RESOLUTION,
            TOLERANCE,
            max(max_intervals - nodes, 0),
        )
        nodes += int(looked)
        vague = outcome == UNDECIDED or (outcome == LOST and end - until > RESOLUTION)
        if stretch != 1.0 and vague and north - south > NARROWEST and nodes < max_intervals:
            waist = 0.5 * (south + north)
            bands += [(waist, north), (south, waist)]
            continue
        proven = min(proven, float(until))
        unsettled += [(float(a), float(b)) for a, b in open_[: min(parts, len(open_))]]
        if outcome == LOST:
            lost, place = float(end), point
    return nodes, proven, lost, place, unsettled


def margins_at(
    path: Trajectory,
    fold: int,
    times: ArrayLike,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    stretch: float = 1.0,
    tolerance: float = 1e-6,
) -> NDArray[np.float64]:
    """By how much all caps may shrink with the fold kept, radians, at moments; negative if lost.

    Exact to `tolerance`, on the safe side. With caps of one size it is the cap's radius less the
    covering radius of the moment. On an ellipsoid, `stretch` from a sphere, angles are those of
    the sphere that it becomes when stretched, and exact to `VAGUE`.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    check_span(path, float(seconds.min()), float(seconds.max()))
    least, most = np.full(seconds.size, np.pi), np.full(seconds.size, np.pi)
    bands = [((-1.0, 1.0), np.arange(seconds.size))]
    while bands:
        (south, north), which = bands.pop()
        caps = _caps(path, sphere_radius, stretch, mask, region, (south, north))
        low, high = margins(caps, fold, seconds[which], tolerance).T
        most[which] = np.minimum(most[which], high)
        # a band that is nowhere the tightest is good enough as it is
        vague = (high - low > VAGUE) & (low < most[which] - VAGUE) & (north - south > NARROWEST)
        done = which[~vague]
        least[done] = np.minimum(least[done], low[~vague])
        if vague.any():
            waist = 0.5 * (south + north)
            bands += [((waist, north), which[vague]), ((south, waist), which[vague])]
    return least


def least_margins(
    path: Trajectory,
    fold: int,
    edges: ArrayLike,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    stretch: float = 1.0,
    tolerance: float = 1e-4,
) -> NDArray[np.float64]:
    """Least margin between each moment and the next: proven bounds, radians, shape (t - 1, 2).

    On an ellipsoid as `margins_at`, and no nearer to each other than `VAGUE`.
    """
    seconds = np.asarray(edges, dtype=float)
    figure = (sphere_radius, stretch, mask)
    margins = [
        _least_margin(path, figure, region, fold, span, tolerance) for span in pairwise(seconds)
    ]
    return np.array(margins).reshape(-1, 2)


def _least_margin(
    path: Trajectory,
    figure: tuple[float, float, float],
    region: Region,
    fold: int,
    span: tuple[float, float],
    tolerance: float,
) -> tuple[float, float]:
    """Bounds of the least margin of a span, in bands of latitude where an ellipsoid needs them."""
    least, most, bands = np.pi, np.pi, [(-1.0, 1.0)]
    while bands:
        south, north = bands.pop()
        caps = _caps(path, *figure, region, (south, north))
        low, high, _ = least_margin(caps, fold, *span, tolerance, MAX_INTERVALS)
        most = min(most, high)
        near = max(2.0 * tolerance, VAGUE)
        vague = figure[1] != 1.0 and high - low > near and low < most - near
        if vague and north - south > NARROWEST:
            waist = 0.5 * (south + north)
            bands += [(waist, north), (south, waist)]
            continue
        least = min(least, low)
    return float(least), float(most)


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
    whole_number("fold", fold, 1)
    if not -np.pi / 2 < mask < np.pi / 2:
        raise ArgumentError(f"mask_deg = {np.degrees(mask):g}: allowed above -90 up to below 90")
    times = 0.5 * (path.breaks[1:] + path.breaks[:-1])
    inside = times[(times >= start) & (times <= stop)]
    r = path.states(np.concatenate([[start], inside, [stop]]))[0]
    cap_radius(np.linalg.norm(r, axis=-1), sphere_radius, mask)


def _caps(
    path: Trajectory,
    sphere_radius: float,
    stretch: float,
    mask: float,
    region: Region,
    band: tuple[float, float] = (-1.0, 1.0),
) -> MovingCaps:
    """Caps as kernels take them; `band` holds sines of latitude on the stretched sphere."""
    anyhow = region.is_globe and stretch == 1.0
    frame = WITH_MARS if region.mars_fixed else FREE if anyhow else ABOUT_POLE
    turns = prime_meridian_angle(path.epoch, path.breaks)
    (normals, floors), (south, north) = region.stretched(stretch).sides, band
    for sign, rim in ((1.0, south), (-1.0, -north)):
        if rim > -1.0:
            normals, floors = np.vstack([normals, [0.0, 0.0, sign]]), np.append(floors, rim)
    return MovingCaps(
        path.breaks,
        path.paths,
        path.errors,
        turns,
        frame,
        (float(sphere_radius), float(stretch), float(mask), float(south), float(north)),
        Sides(normals, floors),
    )


def _confirm(
    path: Trajectory,
    fold: int,
    figure: tuple[float, float, float],
    region: Region,
    time: float,
    place: NDArray[np.float64],
) -> Witness | None:
    """Witness at a place that the kernel found, in the frame of the region; None if in doubt."""
    sphere_radius, stretch, mask = figure
    place = place / [1.0, 1.0, stretch]
    place /= np.linalg.norm(place)
    angle = float(prime_meridian_angle(path.epoch, time))
    start = mcmf_from_mci(place, -angle) if region.mars_fixed else place
    piece = int(np.clip(np.searchsorted(path.breaks, time) - 1, 0, len(path.errors) - 1))
    positions = path.states([time])[0][:, 0]
    # an error of e sideways lifts or lowers a satellite by e over its distance from the user, which
    # is that of the rim of its cap for one that stands near the mask
    rim = sphere_radius * np.cos(mask)
    near = np.sqrt((positions * positions).sum(axis=-1) - rim * rim) - sphere_radius * np.sin(mask)
    sure = 1e-12 + stretch**2 * float((path.errors[piece] / near).max())
    names = path.satellite_names
    return witness_among(
        positions, names, angle, sphere_radius, mask, fold, time, start, region, sure, stretch
    )

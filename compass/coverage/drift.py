"""A constellation left alone: margin and room over time, the first loss, each satellite's way."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.cores import cores, shared
from compass.coverage.lasting import Lasting, least_margins, margins_at, prove_span
from compass.coverage.region import GLOBE, Region
from compass.coverage.room import Room, SlotBox, covering_slots, room_in_slots
from compass.errors import found_so_far
from compass.frames import SECONDS_PER_DAY
from compass.orbits import Constellation
from compass.orbits.trajectory import Trajectory

#: Moments at which margin and room are given, at most.
MOMENTS = 200

#: How close bounds of the least margin come, radians, before the first loss and after it.
KEPT, LOST = 1e-4, 5e-3


#: Part of the first day by which the time for the others is foretold.
PROBE = 0.1


@dataclass(frozen=True)
class Drift:
    """What became of a constellation that was left alone.

    Attributes
    ----------
    lasting
        The claim of coverage: how long it is proven, when it is lost.
    times
        Moments, seconds after the epoch, shape (t,).
    margin
        By how much all caps could shrink then, radians, exact to 1e-6, shape (t,).
    least
        Proven bounds of the least margin since the moment before, radians, shape (t, 2); of the
        first moment that over the day after it.
    room
        Room in the slots at the moments, and where satellites stand in them; None for orbits
        that form no slots.
    box
        How far a satellite may leave its slot; None likewise.
    """

    lasting: Lasting
    times: NDArray[np.float64]
    margin: NDArray[np.float64]
    least: NDArray[np.float64]
    room: Room | None
    box: SlotBox | None


def drift_of(
    constellation: Constellation,
    path: Trajectory,
    fold: int,
    *,
    days: float,
    start_day: float = 0.0,
    sphere_radius: float,
    mask: float = 0.0,
    region: Region = GLOBE,
    stretch: float = 1.0,
    step_days: float | None = None,
    lasting: Lasting | None = None,
    progress: Callable[[Sequence[Any]], Any] = iter,
    foretell: Callable[[float], None] = lambda seconds: None,
) -> Drift:
    """Follow coverage along paths for `days` from `start_day` on.

    Parameters
    ----------
    constellation
        The nominal one, whose elements are the slots.
    path
        What its satellites do.
    fold, sphere_radius, mask, region, stretch
        As in `prove_span`.
    days, start_day
        Span.
    step_days
        Between moments; whole days that give at most `MOMENTS` of them if left out.
    lasting
        How long it lasts, if that is known already.
    progress
        Wraps the list of stretches between moments, as tqdm does.
    foretell
        Is told beforehand about how many seconds the margins take, by what the first ones took.

    Raises
    ------
    ArgumentError
        As `prove_span`.
    """
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    ground: dict[str, Any] = {"sphere_radius": sphere_radius, "mask": mask, "stretch": stretch}
    place = {**ground, "region": region}
    if lasting is None:
        lasting = prove_span(path, fold, **place, start=start, stop=stop)
    step = step_days or max(1.0, float(np.ceil(days / MOMENTS)))
    slack = min(1.0, 0.5 * (stop - start))  # no moment just before the last
    times = np.append(np.arange(start, stop - slack, step * SECONDS_PER_DAY), stop)
    first = min(start + SECONDS_PER_DAY, stop)
    spans = [(start, first), *pairwise(times.tolist())]
    lost = stop if lasting.lost_at is None else lasting.lost_at

    def least_of(ends: tuple[float, float]) -> NDArray[np.float64]:
        near = KEPT if ends[0] <= lost else LOST
        return np.asarray(least_margins(path, fold, ends, **place, tolerance=near)[0])

    with found_so_far(lambda: _words(lasting)):
        least_of((start, start + 1.0))  # no compilation counts
        began = perf_counter()
        least_of((start, start + PROBE * (first - start)))
        each_day = (perf_counter() - began) / (PROBE * (first - start)) * SECONDS_PER_DAY
        foretell(each_day * (days + 1.0) / cores())
        # kernels release the interpreter, so that stretches are looked at on all cores at once
        least = [each for _, each in zip(progress(spans), shared(least_of, spans), strict=True)]
    room, box = None, None
    if (slots := covering_slots(constellation, fold, region)) is not None:
        room = room_in_slots(slots, path, times, **ground)
        box = slots.box(**ground)
    margin = margins_at(path, fold, times, **place)
    return Drift(lasting, times, margin, np.array(least), room, box)


def _words(lasting: Lasting) -> str:
    """How long it lasts, for whoever does not wait for the margins."""
    lost = lasting.first_loss_days
    until = "" if lost is None else f"; lost on day {lost:.6g}"
    return f"proven for {lasting.days_proven:.6g} days{until}"

"""Gaps of coverage over a span of time, cell by cell: how long, how many, how long the wait."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.gaps import finish_gaps, follow_gaps, new_state
from compass.core.runs import Row
from compass.cores import cores
from compass.coverage.grid import Grid
from compass.coverage.rows import Part, Rows, gathered
from compass.coverage.view import View, view
from compass.errors import whole_number
from compass.orbits import Constellation
from compass.orbits.motion import AnyMotion
from compass.sites import Mask

#: Epochs in the shortest pass through the zenith.
EPOCHS_A_PASS = 16
#: Epochs at least and at most.
FEWEST, MOST = 109, 50_000
#: Narrowest cap that epochs are chosen for, radians.
NARROWEST = 1e-3
#: Satellite positions that are held at once: some 60 bytes each.
PIECE = 400_000


@dataclass(frozen=True)
class Gaps:
    """Times with fewer satellites than wanted, sampled.

    Attributes
    ----------
    longest, mean, response
        Longest and mean gap, and the mean wait for the satellites wanted from a random moment
        of the span, seconds, shape (rows, columns); inf where they never come.
    step
        Seconds between epochs: every gap is known to one step, and what is shorter can be missed.
    ring
        Whether the end of the span goes on at its start.
    """

    longest: NDArray[np.float32]
    mean: NDArray[np.float32]
    response: NDArray[np.float32]
    step: float
    ring: bool


def shortest_pass(
    constellation: Constellation, users_radius: float, mask: float, beam: float | None = None
) -> float:
    """Time in which the quickest satellite crosses its own cap, seconds, on the safe side.

    ``2 lambda / (dnu/dt + omega)`` at periapsis, where the cap is smallest and the pace of the
    true anomaly, ``sqrt(GM p)/r^2``, greatest; Mars turns against it at most by omega. Users above
    a satellite see it beyond the limb, across ``2 acos(u cos e/r)``.
    """
    c = constellation
    if not c.size:
        return np.inf
    near = c.periapsis_radius
    pace = np.sqrt(c.gm * near * (1.0 + c.eccentricity)) / near**2
    caps = np.arccos(np.clip(users_radius * np.cos(mask) / near, 0.0, 1.0))
    caps -= np.where(near > users_radius, mask, 0.0)
    if beam is not None and beam < 0.5 * np.pi:
        edge = np.arcsin(np.clip(near * np.sin(beam) / users_radius, 0.0, 1.0)) - beam
        caps = np.where(edge > 0.0, np.minimum(caps, edge), caps)
    caps = np.maximum(caps, NARROWEST)
    return float((2.0 * caps / (pace + MARS_ROTATION_RATE.value)).min())


def gap_epochs(
    constellation: Constellation,
    users_radius: float,
    mask: Mask,
    span: float,
    beam: float | None = None,
) -> int:
    """Number of epochs, a prime, of which the shortest pass through the zenith has sixteen.

    A prime shares no factor with what repeats in the span. At most fifty thousand.
    """
    wanted = span * EPOCHS_A_PASS / shortest_pass(constellation, users_radius, mask.highest, beam)
    return next_prime(int(np.clip(np.ceil(wanted), FEWEST, MOST)))


def next_prime(number: int) -> int:
    """The smallest prime that is not below a number from 2 on."""
    while any(number % k == 0 for k in range(2, int(number**0.5) + 1)):
        number += 1
    return number


@dataclass(frozen=True)
class GapTrack:
    """What gaps are followed along: satellites over a span of time.

    Attributes
    ----------
    constellation, sphere_radius, mask, model, height, beam
        As in `compass.coverage.view.view`.
    span, start
        Seconds to look at, from so many after the epoch.
    ring
        Whether everything repeats after the span, so that a gap at its end goes on at its start.
        Else gaps begin and end there.
    fold
        Satellites wanted.
    epochs
        Equally spaced ones to look at; by default `gap_epochs`.

    Raises
    ------
    ArgumentError
        `fold` below 1.
    """

    constellation: Constellation
    sphere_radius: float
    span: float
    ring: bool
    fold: int = 4
    mask: Mask = field(default_factory=Mask)
    model: AnyMotion = "two-body"
    epochs: int | None = None
    start: float = 0.0
    height: float = 0.0
    beam: float | None = None

    def __post_init__(self) -> None:
        whole_number("fold", self.fold, 1)

    @cached_property
    def number(self) -> int:
        """How many epochs are looked at."""
        known = self.constellation, self.sphere_radius + self.height, self.mask, self.span
        return self.epochs or gap_epochs(*known, self.beam)

    @property
    def step(self) -> float:
        """Seconds between them."""
        return self.span / self.number


def coverage_gaps(
    track: GapTrack,
    grid: Grid,
    *,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
    by: Rows | None = None,
) -> Gaps:
    """Find how long fewer satellites than wanted are in view, in every cell.

    Parameters
    ----------
    track
        What to follow.
    grid
        Cells.
    workers
        Threads; the numbers do not depend on it.
    progress
        Called with the number of rows just finished, all of them once for every piece of time.
    by
        Who does the rows, if not threads of this machine.

    Raises
    ------
    ArgumentError
        A satellite that is not above the sphere.
    """
    if by is None:
        cells = gap_rows(track, grid, range(grid.rows), workers, progress).cells
    else:
        cells = gathered(by("gaps", partial(gap_rows, track, grid), grid), grid)
    return Gaps(cells["longest"], cells["mean"], cells["response"], track.step, track.ring)


def gap_rows(
    track: GapTrack,
    grid: Grid,
    rows: Sequence[int],
    workers: int | None = 1,
    progress: Callable[[int], None] = lambda rows: None,
) -> Part:
    """Longest and mean gap and mean wait in some rows, seconds: positions once for all of them."""
    states = [new_state(grid.columns) for _ in rows]
    piece = max(1, PIECE // max(track.constellation.size, 1))
    with ThreadPoolExecutor(cores(workers)) as pool:
        for first in range(0, track.number, piece):
            epochs = np.arange(first, min(first + piece, track.number))
            times = track.start + epochs * track.step
            seen = view(
                track.constellation,
                times,
                track.sphere_radius,
                track.mask,
                track.model,
                height=track.height,
                beam=track.beam,
            )
            users = seen.rows(grid)
            for _ in pool.map(partial(_follow, seen, track.fold), (users[i] for i in rows), states):
                progress(1)
    gaps = np.empty((3, len(states), grid.columns))
    for k, state in enumerate(states):
        finish_gaps(state, track.number, track.ring, gaps[:, k])
    seconds = (gaps * track.step).astype(np.float32)
    return Part(dict(zip(("longest", "mean", "response"), seconds, strict=True)))


def _follow(seen: View, fold: int, row: Row, state: NDArray[np.float64]) -> None:
    """Follow the gaps of a row over the epochs of a view."""
    follow_gaps(seen.r, seen.cos_cap, row, fold, state)

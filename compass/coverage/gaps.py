"""Gaps of coverage over a span of time, cell by cell: how long, how many, how long the wait."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.gaps import finish_gaps, follow_gaps, new_state
from compass.core.runs import Row
from compass.cores import cores
from compass.coverage.cap import cap_radius
from compass.coverage.grid import Grid
from compass.coverage.view import View, view
from compass.errors import whole_number
from compass.orbits import Constellation
from compass.orbits.motion import AnyMotion
from compass.sites import Mask

#: Epochs in the shortest pass through the zenith.
EPOCHS_A_PASS = 16
#: Epochs at least and at most.
FEWEST, MOST = 109, 50_000
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


def shortest_pass(constellation: Constellation, sphere_radius: float, mask: float) -> float:
    """Time in which the quickest satellite crosses its own cap, seconds, on the safe side.

    ``2 lambda / (dnu/dt + omega)`` at periapsis, where the cap is smallest and the pace of the
    true anomaly, ``sqrt(GM p)/r^2``, greatest; Mars turns against it at most by omega.
    """
    c = constellation
    if not c.size:
        return np.inf
    near = c.periapsis_radius
    pace = np.sqrt(c.gm * near * (1.0 + c.eccentricity)) / near**2
    caps = cap_radius(near, sphere_radius, mask)
    return float((2.0 * caps / (pace + MARS_ROTATION_RATE.value)).min())


def gap_epochs(constellation: Constellation, sphere_radius: float, mask: Mask, span: float) -> int:
    """Number of epochs, a prime, of which the shortest pass through the zenith has sixteen.

    A prime shares no factor with what repeats in the span. At most fifty thousand.
    """
    wanted = span * EPOCHS_A_PASS / shortest_pass(constellation, sphere_radius, mask.highest)
    return next_prime(int(np.clip(np.ceil(wanted), FEWEST, MOST)))


def next_prime(number: int) -> int:
    """The smallest prime that is not below a number from 2 on."""
    while any(number % k == 0 for k in range(2, int(number**0.5) + 1)):
        number += 1
    return number


def coverage_gaps(
    constellation: Constellation,
    grid: Grid,
    *,
    sphere_radius: float,
    span: float,
    ring: bool,
    fold: int = 4,
    mask: Mask | None = None,
    model: AnyMotion = "two-body",
    epochs: int | None = None,
    start: float = 0.0,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda rows: None,
) -> Gaps:
    """Find how long fewer than `fold` satellites are in view, in every cell.

    Parameters
    ----------
    constellation, sphere_radius, mask, model
        As in `compass.coverage.view.view`.
    grid
        Cells.
    span, start
        Seconds to look at, from so many after the epoch.
    ring
        Whether everything repeats after the span, so that a gap at its end goes on at its start.
        Else gaps begin and end there.
    fold
        Satellites wanted.
    epochs
        Equally spaced ones to look at; by default `gap_epochs`.
    workers
        Threads; the numbers do not depend on it.
    progress
        Called with the number of rows just finished, all of them once for every piece of time.

    Raises
    ------
    ArgumentError
        `fold` below 1, a satellite that is not above the sphere.
    """
    whole_number("fold", fold, 1)
    mask = mask or Mask()
    number = epochs or gap_epochs(constellation, sphere_radius, mask, span)
    step = span / number
    states = [new_state(grid.columns) for _ in range(grid.rows)]
    piece = max(1, PIECE // max(constellation.size, 1))
    with ThreadPoolExecutor(cores(workers)) as pool:
        for first in range(0, number, piece):
            times = start + np.arange(first, min(first + piece, number)) * step
            seen = view(constellation, times, sphere_radius, mask, model)
            for _ in pool.map(partial(_follow, seen, fold), seen.rows(grid), states):
                progress(1)
    gaps = np.empty((3, grid.rows, grid.columns))
    for i, state in enumerate(states):
        finish_gaps(state, number, ring, gaps[:, i])
    longest, mean, response = (gaps * step).astype(np.float32)
    return Gaps(longest, mean, response, step, ring)


def _follow(seen: View, fold: int, row: Row, state: NDArray[np.float64]) -> None:
    """Follow the gaps of a row over the epochs of a view."""
    follow_gaps(seen.r, seen.cos_cap, row, fold, state)

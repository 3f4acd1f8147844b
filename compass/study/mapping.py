"""From a design to its coverage map, with the provenance that the map carries."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

import compass
from compass.conventions import epoch_text
from compass.cores import cores
from compass.coverage.errors import error_map
from compass.coverage.gaps import coverage_gaps, shortest_pass
from compass.coverage.grid import Grid, make_grid
from compass.coverage.maps import coverage_map
from compass.coverage.protection import protection_map
from compass.coverage.view import View, view
from compass.design import PDOP_MAX, Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.memory import check_fits
from compass.orbits import RepeatPeriod, repeat_period
from compass.orbits.motion import Motion, MotionModel
from compass.signal.ranges import Weighting, range_errors
from compass.sites import Mask
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr

MAX_EPOCHS = 100_000
MAX_DURATION_H = 1e6

#: Days after the epoch, a century, up to which a map may begin: rounding of time stays small.
MAX_START_DAY = 36525.0

# Bytes, as measured: a satellite at an epoch (the same where orbits are integrated, all epochs at
# once), a cell, an epoch of a cell in the row at work.
POSITION_BYTES, INTEGRATED_BYTES, CELL_BYTES, ROW_BYTES = 40, 110, 180, 25
# And with errors besides, in the same order; their forms are made of all epochs at once.
ERROR_POSITION_BYTES, ERROR_CELL_BYTES, ERROR_ROW_BYTES = 700, 50, 20
# Seconds of one core, as measured (`tox -e bench` shows them): a cell at an epoch, and every
# satellite of it; a satellite of it where errors are asked for; gaps are a satellite of it too.
CELL_S, SATELLITE_S, ERROR_SATELLITE_S = 4e-8, 9e-10, 8e-9


@dataclass(frozen=True)
class MapOptions:
    """How to map; None takes what the design says.

    Attributes
    ----------
    step_deg, grid
        Cell size in degrees and kind of cells (``equal-angle`` or ``equal-area``).
    epochs
        Equally spaced epochs from time 0 on in the period. The default is prime: a number that
        shares a factor with a pattern's symmetry meets its moments of singular geometry again
        and again, and percentiles of the dilution suffer. Of the primes about a hundred it is
        one whose 104th value, the 95th percentile by nearest rank, has 95 % around it.
    mask_deg, fold
        Elevation mask and satellites wanted, instead of the design's.
    pdop_max
        Largest PDOP that counts as available.
    motion
        ``two-body``, ``j2`` or ``numerical``, instead of the design's.
    start_day
        Days after the epoch at which the period begins.
    duration_h
        Period to map, hours, instead of the ground tracks' repeat period.
    error_max_m
        Largest error of a fix that counts as within, metres, one sigma; of designs with a signal.
    weights
        How the fix weighs ranges: by their ``variance``, or all ``equal``.
    """

    step_deg: float = 1.0
    grid: str = "equal-angle"
    epochs: int = 109
    mask_deg: float | None = None
    fold: int | None = None
    pdop_max: float = PDOP_MAX
    motion: MotionModel | None = None
    start_day: float = 0.0
    duration_h: float | None = None
    error_max_m: float = 30.0
    weights: Weighting = "variance"


@dataclass(frozen=True)
class DesignMap:
    """A map, and what it was made from.

    Attributes
    ----------
    dataset
        See `compass.coverage.maps.coverage_map`.
    grid, view
        The cells; the constellation at the epochs.
    repeat
        The period over which the ground tracks repeat.
    """

    dataset: "xr.Dataset" = field(repr=False)
    grid: Grid
    view: View
    repeat: RepeatPeriod


@dataclass(frozen=True)
class Cost:
    """What a map will take of this machine: seconds, to a factor of two, and bytes."""

    seconds: float
    bytes: float


def make_map(
    design: Design,
    options: MapOptions | None = None,
    command: str = "",
    *,
    workers: int | None = None,
    foretell: Callable[[Cost], None] = lambda cost: None,
    progress: Callable[[int], None] = lambda rows: None,
) -> DesignMap:
    """Map a design over one repeat period of its ground tracks (or over a given duration).

    What it will take is told to `foretell` before it is begun.

    Raises
    ------
    ArgumentError
        An option outside what is allowed.
    """
    chosen = options or MapOptions()
    if not 1 <= chosen.epochs <= MAX_EPOCHS:
        raise ArgumentError(f"epochs = {chosen.epochs}: allowed 1 to {MAX_EPOCHS}")
    if chosen.duration_h is not None and not 0 < chosen.duration_h <= MAX_DURATION_H:
        raise ArgumentError(
            f"duration_h = {chosen.duration_h}: must be above 0, at most {MAX_DURATION_H:g} hours"
        )
    if not chosen.pdop_max >= 1:
        raise ArgumentError(
            f"pdop_max = {chosen.pdop_max:g}: a dilution of precision to ask for is 1 or more"
        )
    if chosen.weights not in ("variance", "equal"):
        raise ArgumentError(f"weights = {chosen.weights!r}: allowed variance, equal")
    if not chosen.error_max_m > 0:
        raise ArgumentError(f"error_max_m = {chosen.error_max_m:g}: must be positive")
    mask = design.mask if chosen.mask_deg is None else option_mask(chosen.mask_deg)
    repeat = repeat_period(design.constellation)
    duration = repeat.duration if chosen.duration_h is None else chosen.duration_h * 3600
    if not 0 <= chosen.start_day <= MAX_START_DAY:
        raise ArgumentError(
            f"start_day = {chosen.start_day:g}: allowed 0 to {MAX_START_DAY:g}, a century"
        )
    times = np.arange(chosen.epochs) * (duration / chosen.epochs)
    times += chosen.start_day * SECONDS_PER_DAY
    motion = design.motion.or_of(chosen.motion)
    figure = design.figure
    grid = make_grid(chosen.grid, chosen.step_deg, figure.polar_radius / figure.equatorial_radius)
    size, in_metres = design.constellation.size, design.signal is not None
    cost = map_cost(size, chosen.epochs, grid, workers, motion, in_metres)
    check_fits(
        cost.bytes,
        f"map: {counted(size, 'satellite')} at {counted(chosen.epochs, 'epoch')} on {grid.rows} by "
        f"{grid.columns} cells",
        "ask for fewer epochs or larger cells",
    )
    foretell(cost)
    sphere = figure.equatorial_radius
    fold = design.fold if chosen.fold is None else chosen.fold
    seen = view(design.constellation, times, sphere, mask, motion)
    gaps = coverage_gaps(
        design.constellation,
        grid,
        sphere_radius=sphere,
        span=duration,
        ring=chosen.duration_h is None and closes(motion, repeat),
        fold=fold,
        mask=mask,
        model=motion,
        start=float(times[0]),
        workers=workers,
    )
    dataset = coverage_map(
        seen,
        grid,
        fold=fold,
        gaps=gaps,
        pdop_threshold=chosen.pdop_max,
        workers=workers,
        progress=progress,
    )
    if design.signal is not None:
        ranges = range_errors(design, times, motion, chosen.weights)
        errors = error_map(
            seen, grid, ranges, limit=chosen.error_max_m, workers=workers, progress=progress
        )
        dataset = dataset.assign(errors.data_vars).assign_coords(errors.coords)
        dataset.attrs |= errors.attrs | {"error_weights": chosen.weights}
        if design.integrity is not None:
            levels = protection_map(
                seen, grid, ranges, design.integrity, workers=workers, progress=progress
            )
            dataset = dataset.assign(levels.data_vars).assign_coords(levels.coords)
    dataset.attrs |= provenance(design, command) | {
        "elevation_mask_deg": np.degrees(mask.elevation).tolist(),
        "motion_model": motion.model,
        "figure": figure.title,
        "start_day": chosen.start_day,
        "period_s": duration,
        "shortest_pass_s": shortest_pass(design.constellation, sphere, mask.highest),
        "repeat_miss_deg": float(np.degrees(repeat.closure)),
    }
    return DesignMap(dataset, grid, seen, repeat)


def map_cost(
    satellites: int,
    epochs: int,
    grid: Grid,
    workers: int | None,
    motion: Motion,
    errors: bool = False,
) -> Cost:
    """Work out what a map will take.

    Held are the positions of every satellite at every epoch (with what is made on the way to
    them, where that is not done in pieces), the figures of every cell, and the dilutions of a row
    that each thread sorts.
    """
    threads = cores(workers)
    cells = grid.rows * grid.columns
    needed = (
        (POSITION_BYTES if motion.is_closed_form else INTEGRATED_BYTES) * satellites * epochs
        + CELL_BYTES * cells
        + ROW_BYTES * threads * grid.columns * epochs
    )
    seconds = CELL_S + SATELLITE_S * satellites
    if errors:
        needed += (
            ERROR_POSITION_BYTES * satellites * epochs
            + ERROR_CELL_BYTES * cells
            + ERROR_ROW_BYTES * threads * grid.columns * epochs
        )
        seconds += ERROR_SATELLITE_S * satellites
    return Cost(seconds * cells * epochs / threads, needed)


def closes(motion: Motion, repeat: RepeatPeriod) -> bool:
    """Whether the repeat of the ground tracks is one, so that its end goes on at its start.

    It is in two-body motion, if these close to a tenth of a degree: less than a satellite moves
    over Mars from one epoch to the next.
    """
    return motion.model == "two-body" and repeat.closure <= np.radians(0.1)


def option_mask(mask_deg: float) -> Mask:
    """Return a constant mask from degrees given as an option.

    Raises
    ------
    ArgumentError
        Outside 0 up to below 90 degrees.
    """
    if not 0 <= mask_deg < 90:
        raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed 0 up to below 90 degrees")
    return Mask.constant(float(np.radians(mask_deg)))


def provenance(design: Design, command: str) -> dict[str, str]:
    """What a result was made from: global attributes of the convention, and the design itself."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return {
        "title": f"Coverage of Mars by {design.name}",
        "source": f"compass {compass.__version__}",
        "history": f"{now} {command}".strip(),
        "references": " ".join(design.source.split()),
        "epoch_tdb": epoch_text(design.constellation.epoch),
        "design_file": design.label,
        "design_text": design.text,
        "design_sha256": design.digest,
        "compass_version": compass.__version__,
        "command_line": command,
    }

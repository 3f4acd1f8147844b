"""From a design to its coverage map, with the provenance that the map carries."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import compass
from compass.allowed import check_all_allowed
from compass.conventions import epoch_text
from compass.coverage.drawn import Drawn, drawn
from compass.coverage.errors import error_map, error_rows
from compass.coverage.gaps import GapTrack, coverage_gaps, gap_rows, shortest_pass
from compass.coverage.grid import Grid, make_grid
from compass.coverage.maps import count_rows, coverage_map
from compass.coverage.protection import protection_map, protection_rows
from compass.coverage.region import GLOBE
from compass.coverage.rows import Part, Rows, by_threads
from compass.coverage.users import Users, check_limb, region_users
from compass.coverage.view import View, view
from compass.design import PDOP_MAX, Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.memory import check_fits
from compass.orbits import RepeatPeriod, repeat_period
from compass.orbits.motion import Motion, MotionModel
from compass.requirement import standing_words
from compass.signal.ranges import RangeErrors, Weighting, aloft_numbers, range_errors
from compass.sites import Mask
from compass.study.map_cost import Cost, map_cost
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr


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
        Elevation mask and satellites wanted, instead of the design's; a mask below 0 for users
        above the ground, who look down.
    altitude_km, beam_deg
        Height of the users above the ground, and half angle of the satellites' antennas about the
        way down, as of a `compass.requirement.Requirement`; all around if left out.
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
    altitude_km: float = 0.0
    beam_deg: float | None = None

    @property
    def users(self) -> str:
        """Whose map it is, in words: nothing of users on the ground, all around."""
        return standing_words(
            self.altitude_km * 1e3, None if self.beam_deg is None else np.radians(self.beam_deg)
        )

    def check(self) -> None:
        """Refuse what is outside what is allowed.

        Raises
        ------
        ArgumentError
            Naming the option, its value and the range.
        """
        check_all_allowed(
            epochs=self.epochs,
            duration_h=self.duration_h,
            pdop_max=self.pdop_max,
            error_max_m=self.error_max_m,
            start_day=self.start_day,
            altitude_km=self.altitude_km,
            beam_deg=self.beam_deg,
        )
        if self.weights not in ("variance", "equal"):
            raise ArgumentError(f"weights = {self.weights!r}: allowed variance, equal")


class MapRows:
    """What rows of a design's map are found from.

    It goes to another machine as the design and the options, and is made anew there.

    Parameters
    ----------
    design, options
        What is mapped, and how.
    """

    def __init__(self, design: Design, options: MapOptions) -> None:
        self.design, self.options = design, options

    def __reduce__(self) -> tuple[Any, ...]:
        return MapRows, (self.design, self.options)

    def __call__(self, kind: str, numbers: NDArray[np.int64]) -> Part:
        """Find a kind of figures in some rows: gaps, counts, errors or protection."""
        rows = numbers.tolist()
        if kind == "gaps":
            return gap_rows(self.track, self.grid, rows)
        seen, grid = self.view, self.grid
        if kind == "counts":
            return count_rows(seen, grid, self.options.pdop_max, rows)
        if kind == "errors":
            return error_rows(seen, grid, self.ranges, self.options.error_max_m, rows)
        assert self.design.integrity is not None
        return protection_rows(seen, grid, self.ranges, self.design.integrity, rows)

    @cached_property
    def mask(self) -> Mask:
        """Mask of all users."""
        given = self.options.mask_deg
        return self.design.mask if given is None else option_mask(given, self.options.altitude_km)

    @cached_property
    def users(self) -> Users:
        """Who is everywhere, so high above the ground, in such beams."""
        figure, options = self.design.figure, self.options
        everyone = region_users(GLOBE, figure, self.mask, height=options.altitude_km * 1e3)
        beam = None if options.beam_deg is None else float(np.radians(options.beam_deg))
        check_limb(everyone)
        return replace(everyone, beam=beam)

    @cached_property
    def motion(self) -> Motion:
        """How the satellites move."""
        return self.design.motion.or_of(self.options.motion)

    @cached_property
    def grid(self) -> Grid:
        """The cells, on the design's figure."""
        figure = self.design.figure
        polar = figure.polar_radius / figure.equatorial_radius
        return make_grid(self.options.grid, self.options.step_deg, polar)

    @cached_property
    def repeat(self) -> RepeatPeriod:
        """After which the ground tracks repeat."""
        return repeat_period(self.design.constellation)

    @property
    def duration(self) -> float:
        """Seconds that are mapped."""
        given = self.options.duration_h
        return self.repeat.duration if given is None else given * 3600

    @cached_property
    def times(self) -> NDArray[np.float64]:
        """Epochs, seconds after that of the orbits."""
        epochs = self.options.epochs
        start = self.options.start_day * SECONDS_PER_DAY
        return np.asarray(start + np.arange(epochs) * (self.duration / epochs), dtype=np.float64)

    @property
    def fold(self) -> int:
        """Satellites wanted."""
        return self.design.fold if self.options.fold is None else self.options.fold

    @cached_property
    def view(self) -> View:
        """The satellites at the epochs."""
        radius = self.design.figure.equatorial_radius
        c, users = self.design.constellation, self.users
        high, beam = users.height, users.beam
        return view(c, self.times, radius, users.mask, self.motion, height=high, beam=beam)

    @cached_property
    def ranges(self) -> RangeErrors:
        """Errors of the ranges at the epochs."""
        found = range_errors(self.design, self.times, self.motion, self.options.weights)
        if self.mask.lowest < 0.0:  # as of orbiters
            return replace(found, numbers=aloft_numbers(found.numbers))
        return found

    def drawn(self, *, losses: bool = False) -> Drawn | None:
        """Figures at random places and moments of what is mapped; None without satellites.

        With `losses` also of protection without each satellite in turn.
        """
        design, motion, start = self.design, self.motion, float(self.times[0])
        if not design.constellation.size:
            return None
        asked = replace(design, motion=motion)
        stop = start + self.duration
        if motion.table is not None:  # no table is asked beyond its end
            stop = min(stop, motion.table.stop)
        how: dict[str, Any] = {"users": self.users, "weights": self.options.weights}
        return drawn(asked, (start, stop), **how, losses=losses, budget=True)

    @cached_property
    def track(self) -> GapTrack:
        """What gaps are followed along."""
        return GapTrack(
            self.design.constellation,
            self.design.figure.equatorial_radius,
            self.duration,
            self.options.duration_h is None and closes(self.motion, self.repeat),
            self.fold,
            self.mask,
            self.motion,
            start=float(self.times[0]),
            height=self.users.height,
            beam=self.users.beam,
        )


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


def make_map(
    design: Design,
    options: MapOptions | None = None,
    command: str = "",
    *,
    workers: int | None = None,
    foretell: Callable[[Cost], None] = lambda cost: None,
    progress: Callable[[int], None] = lambda rows: None,
    by: Callable[[MapRows], Rows] | None = None,
) -> DesignMap:
    """Map a design over one repeat period of its ground tracks (or over a given duration).

    What it will take is told to `foretell` before it is begun; `by` says who does the rows, if
    not threads of this machine.

    Raises
    ------
    ArgumentError
        An option outside what is allowed.
    """
    chosen = options or MapOptions()
    chosen.check()
    rows = MapRows(design, chosen)
    grid, motion, figure = rows.grid, rows.motion, design.figure
    size = design.constellation.size
    cost = map_cost(
        size,
        chosen.epochs,
        grid,
        workers,
        motion,
        errors=design.signal is not None,
        levels=design.signal is not None and design.integrity is not None,
        slanted=rows.mask.lowest < 0.0 or rows.users.beam is not None,
        gap_epochs=rows.track.number,
    )
    check_fits(
        cost.bytes,
        f"map: {counted(size, 'satellite')} at {counted(chosen.epochs, 'epoch')} on {grid.rows} by "
        f"{grid.columns} cells",
        "ask for fewer epochs or larger cells",
    )
    foretell(cost)
    do = by(rows) if by else None
    gaps = coverage_gaps(rows.track, grid, workers=workers, progress=progress, by=do)
    do = do or by_threads(workers, progress)
    dataset = coverage_map(
        rows.view, grid, fold=rows.fold, gaps=gaps, pdop_threshold=chosen.pdop_max, by=do
    )
    if design.signal is not None:
        errors = error_map(rows.view, grid, rows.ranges, limit=chosen.error_max_m, by=do)
        dataset = dataset.assign(errors.data_vars).assign_coords(errors.coords)
        dataset.attrs |= errors.attrs | {"error_weights": chosen.weights}
        if design.integrity is not None:
            levels = protection_map(rows.view, grid, rows.ranges, design.integrity, by=do)
            dataset = dataset.assign(levels.data_vars).assign_coords(levels.coords)
    users_radius = figure.equatorial_radius + rows.users.height
    quickest = shortest_pass(design.constellation, users_radius, rows.mask.highest, rows.users.beam)
    dataset.attrs |= provenance(design, command, chosen.users) | {
        "elevation_mask_deg": np.degrees(rows.mask.elevation).tolist(),
        "user_altitude_km": chosen.altitude_km,
        **({} if chosen.beam_deg is None else {"beam_deg": chosen.beam_deg}),
        "motion_model": motion.model,
        "figure": figure.title,
        "start_day": chosen.start_day,
        "period_s": rows.duration,
        "shortest_pass_s": quickest,
        "repeat_miss_deg": float(np.degrees(rows.repeat.closure)),
    }
    return DesignMap(dataset, grid, rows.view, rows.repeat)


def closes(motion: Motion, repeat: RepeatPeriod) -> bool:
    """Whether the repeat of the ground tracks is one, so that its end goes on at its start.

    It is in two-body motion, if these close to a tenth of a degree: less than a satellite moves
    over Mars from one epoch to the next.
    """
    return motion.model == "two-body" and repeat.closure <= np.radians(0.1)


def option_mask(mask_deg: float, altitude_km: float = 0.0) -> Mask:
    """Return a constant mask from degrees given as an option.

    Raises
    ------
    ArgumentError
        Outside 0 up to below 90 degrees; above the ground from above -90 degrees on.
    """
    if not (-90 if altitude_km else 0) <= mask_deg < 90:
        aloft = "above -90 up" if altitude_km else "0 up"
        higher = "" if altitude_km else "; below 0 is of users above the ground, at an altitude_km"
        raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed {aloft} to below 90 degrees{higher}")
    return Mask.constant(float(np.radians(mask_deg)))


def provenance(design: Design, command: str, users: str = "") -> dict[str, str]:
    """What a result was made from: global attributes of the convention, and the design itself."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return {
        "title": f"Coverage of Mars by {design.name}{users}",
        "source": f"compass {compass.__version__}",
        "history": f"{now} {command}".strip(),
        "references": " ".join(design.source.split()),
        "epoch_tdb": epoch_text(design.constellation.epoch),
        "design_file": " + ".join((design.label, *design.others)),
        "design_text": design.text,
        "design_sha256": design.digest,
        "compass_version": compass.__version__,
        "command_line": command,
    }

"""A design left alone on real orbits: how long it lasts, and which radius keeps itself."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.drift_files import drift_dataset
from compass.api.given import given_design, given_mask
from compass.api.lasting import LastingResult
from compass.api.progress import bar
from compass.api.promises import box_dict, followed, promise_blocks, promise_dict
from compass.api.results import Result
from compass.coverage.certificate import Outcome
from compass.coverage.drift import Drift, drift_of
from compass.coverage.lasting import prove_span
from compass.coverage.promises import Promise, promises_of
from compass.coverage.region import GLOBE, Region, read_region
from compass.coverage.room import has_slots
from compass.design import Design
from compass.document import Page, Sampled, Sentence, Table, Value
from compass.document.blocks import Block, facts
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.approach import Approach, closest_approaches
from compass.orbits.forces import ForceModel
from compass.orbits.motion import Motion
from compass.orbits.trajectory import COARSE
from compass.orbits.trimming import Trim, beat_of, can_trim, trim, with_axes
from compass.quantities import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from compass.orbits.constellation import Constellation

#: Rows of the table over time that the text shows.
SHOWN = 12


@dataclass(frozen=True)
class RadiusLasts:
    """How long a pattern lasts at another radius, left alone after one trim.

    Attributes
    ----------
    radius_km
        Of the nominal orbits.
    days_proven
        For which its fold is proven.
    first_loss_days
        When it is lost; None if it is not in the span.
    margin_deg
        Least exact margin at the moments looked at, degrees.
    beat_days
        Half the synodic period with Mars: long near the resonance.
    trimmed
        Whether a trim was possible.
    """

    radius_km: float
    days_proven: float
    first_loss_days: float | None
    margin_deg: float
    beat_days: float
    trimmed: bool

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return vars(self).copy()


@dataclass(frozen=True, repr=False)
class DriftResult(Result):
    """A design left alone.

    Attributes
    ----------
    design
        What was followed.
    mask_deg, motion
        Elevation mask; under what motion.
    drift
        Margins, room and the first loss, SI.
    trim
        The trimmed elements, if asked for.
    radii
        How long the pattern lasts at other radii, if asked for.
    promises
        What becomes of each requirement of the design.
    approaches
        The closest approach of any satellite to each moon.
    avoid_km
        Distance that is to be kept from their centres, if any.
    """

    design: Design = field(repr=False)
    mask_deg: float
    motion: str
    drift: Drift
    trim: Trim | None = None
    radii: tuple[RadiusLasts, ...] = ()
    promises: tuple[Promise, ...] = ()
    approaches: tuple[Approach, ...] = ()
    avoid_km: float | None = None

    @property
    def holds(self) -> bool:
        """Whether what is wanted is proven for the whole span, and the moons are kept away from.

        Wanted is what the design requires, as far as it can be followed; without that the fold.
        """
        wanted = followed(self.promises) or [self.drift.lasting]
        return all(one.outcome is Outcome.PROVEN for one in wanted) and self.avoids

    @property
    def avoids(self) -> bool:
        """Whether no satellite comes nearer to a moon than is to be kept."""
        least = min((a.distance for a in self.approaches), default=np.inf)
        return self.avoid_km is None or least >= self.avoid_km * 1e3

    @property
    def lasting(self) -> LastingResult:
        """The claim alone."""
        return LastingResult(self.design, self.mask_deg, self.motion, self.drift.lasting)

    @property
    def days_proven(self) -> float:
        """Days for which the fold is proven."""
        return self.drift.lasting.days_proven

    @property
    def first_loss_days(self) -> float | None:
        """Days after the epoch at which it is lost; None if it is not."""
        return self.drift.lasting.first_loss_days

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON; lists over the days."""
        found = self.drift
        return plain(
            {
                **self.lasting.to_dict(),
                "trimmed": self.trim is not None,
                "span_days": self.lasting.days,
                "days": found.times / SECONDS_PER_DAY,
                "margin_deg": np.degrees(found.least[:, 0]),
                "margin_at_moment_deg": np.degrees(found.margin),
                "room_deg": None if found.room is None else np.degrees(found.room.room),
                "per_satellite": self._satellites(),
                "slot_box": box_dict(self.drift.box),
                "requirements": [promise_dict(each) for each in self.promises],
                "trim": self._trim(),
                "radii": [radius.as_dict() for radius in self.radii],
                "moons": [
                    {
                        "moon": a.moon,
                        "satellite": a.satellite,
                        "day": a.time / SECONDS_PER_DAY,
                        "distance_km": a.distance / 1e3,
                    }
                    for a in self.approaches
                ],
                "avoid_km": self.avoid_km,
                "avoids": self.avoids,
            }
        )

    def _satellites(self) -> list[dict[str, Any]] | None:
        """Where each satellite stands in its slot at the end of the span."""
        room = self.drift.room
        if room is None:
            return None
        return [
            {
                "name": name,
                "in_track_deg": degrees(room.along[-1, s]),
                "cross_track_deg": degrees(room.across[-1, s]),
                "radial_km": room.radial[-1, s] / 1e3,
            }
            for s, name in enumerate(self.design.constellation.satellite_names)
        ]

    def _trim(self) -> dict[str, Any] | None:
        t = self.trim
        if t is None:
            return None
        return {
            "semi_major_axis_km": t.constellation.semi_major_axis / 1e3,
            "shift_km": t.shift / 1e3,
            "horizon_days": t.horizon / SECONDS_PER_DAY,
            "rate_spread_deg_day": degrees(t.spread) * SECONDS_PER_DAY,
            "rate_spread_before_deg_day": degrees(t.spread_before) * SECONDS_PER_DAY,
            "excursion_deg": degrees(t.excursion),
            "excursion_before_deg": degrees(t.excursion_before),
            "tolerance": self.tolerances(),
        }

    def tolerances(self) -> dict[str, float] | None:
        """How well each element must be injected, one at a time, for the room left at the end.

        An axis off by da drifts by ``3/2 n da / a`` a second along the track; an eccentricity e
        swings a satellite by 2 e along it; inclination, node and argument of latitude move it by
        themselves. The least room of the span may be used up by any one of them; None where there
        is none.
        """
        room, c = self.drift.room, self.design.constellation
        left = 0.0 if room is None else float(room.room.min())
        if left <= 0.0:
            return None
        span = self.drift.lasting.stop - self.drift.lasting.start
        rate = 1.5 * float(c.mean_motion[0] / c.semi_major_axis[0])
        return {
            "semi_major_axis_km": left / rate / span / 1e3,
            "eccentricity": left / 2.0,
            "inclination_deg": degrees(left),
            "raan_deg": degrees(left),
            "argument_of_latitude_deg": degrees(left),
        }

    def document(self) -> Page:
        """How long it lasts, then margin and room over time, satellites, trim, other radii."""
        blocks: list[Block] = [
            *promise_blocks(self.promises),
            *self.lasting.blocks(),
            self._advice(),
            *self._over_time(),
            *self._per_satellite(),
            *self._trimmed(),
            *self._moons(),
            *self._other_radii(),
        ]
        return Page(self.design.name, tuple(blocks))

    def _advice(self) -> Sentence:
        c = self.design.constellation
        beat = beat_of(c) / SECONDS_PER_DAY if c.size else np.inf
        if beat > 100.0:
            return Sentence(
                "the orbits keep pace with Mars's rotation: the field pushes each satellite the "
                "same way every day, so that no trim helps; some hundred kilometres lower or "
                "higher the push averages out"
            )
        how = "trimmed once" if self.trim else "not trimmed; --trim makes mean rates agree"
        return Sentence(f"the push of Mars's field swings to and fro every {beat:.3g} days; {how}")

    def _over_time(self) -> list[Block]:
        found = self.drift
        pick = np.unique(np.linspace(0, found.times.size - 1, SHOWN).astype(int))
        margin, room = quantity("cap_margin_deg"), quantity("room_deg")
        rows = tuple(
            (
                f"{found.times[k] / SECONDS_PER_DAY:.6g}",
                Value(margin, degrees(found.least[k, 0])),
                Value(margin, degrees(found.margin[k])),
                "" if found.room is None else Value(room, degrees(found.room.room[k])),
            )
            for k in pick
        )
        header = ("day", f"least {margin.heading}", "at the moment", room.heading)
        step = (found.times[1] - found.times[0]) / SECONDS_PER_DAY
        note = (
            f"least margin: by how much all caps could shrink in the {step:g} day(s) before, a "
            "proven bound (of the first row, in the day after); room in the slots is smaller and "
            "only sufficient"
        )
        return [Table("Margin and room over time", header, rows), Sentence(note)]

    def _per_satellite(self) -> list[Block]:
        rows = self._satellites()
        if not rows:
            return []
        names = ("in_track_deg", "cross_track_deg", "radial_km")
        table = tuple(
            (row["name"], *(Value(quantity(name), row[name]) for name in names)) for row in rows
        )
        header = ("satellite", *(quantity(name).heading for name in names))
        blocks: list[Block] = [Table("In its slot at the end of the span", header, table)]
        if box := box_dict(self.drift.box):
            blocks.append(
                facts(
                    "Slot box: how far one satellite may leave its slot",
                    [
                        Value(quantity("slot_sideways_deg"), box["sideways_deg"]),
                        Value(quantity("slot_radial_km"), box["radial_km"]),
                    ],
                )
            )
        return blocks

    def _trimmed(self) -> list[Block]:
        t, found = self.trim, self._trim()
        if t is None or found is None:
            return []
        axis, shift = quantity("semi_major_axis_km"), quantity("axis_shift_km")
        names = self.design.constellation.satellite_names
        rows = tuple(
            (
                name,
                Value(axis, float(t.constellation.semi_major_axis[s] / 1e3)),
                Value(shift, float(t.shift[s] / 1e3)),
            )
            for s, name in enumerate(names)
        )
        blocks: list[Block] = [
            Table("Osculating axes to inject", ("satellite", axis.heading, shift.heading), rows),
            Sentence(
                f"mean rates agree to {found['rate_spread_deg_day']:.2g} deg a day over "
                f"{found['horizon_days']:.4g} days ({found['rate_spread_before_deg_day']:.2g} "
                "before); the furthest satellite runs "
                f"{found['excursion_deg']:.3g} deg from the mean "
                f"({found['excursion_before_deg']:.4g} before)"
            ),
        ]
        if tolerance := self.tolerances():
            blocks.append(
                Table(
                    "How well one element must be injected for the whole span, others exact",
                    ("element", "tolerance"),
                    tuple((name, f"{value:.3g}") for name, value in tolerance.items()),
                )
            )
        return blocks

    def _moons(self) -> list[Block]:
        """Who comes nearest to a moon, when and how near."""
        if not self.approaches:
            return []
        said = "; ".join(
            f"{a.moon.capitalize()} {Value(quantity('distance_km'), a.distance / 1e3)} km "
            f"({a.satellite}, day {a.time / SECONDS_PER_DAY:.2f})"
            for a in self.approaches
        )
        wanted = ""
        if self.avoid_km is not None:
            kept = "kept" if self.avoids else "not kept"
            wanted = f"; {self.avoid_km:g} km from their centres is {kept}"
        return [Sentence(f"closest approach of any satellite to the moons: {said}{wanted}")]

    @property
    def dataset(self) -> "xr.Dataset":
        """Margin, room and places in the slots over time, as CF lays it out."""
        return drift_dataset(self)

    def _other_radii(self) -> list[Block]:
        if not self.radii:
            return []
        proven, margin = quantity("days_proven"), quantity("cap_margin_deg")
        rows = tuple(
            (
                f"{r.radius_km:g}",
                Value(proven, r.days_proven),
                "never" if r.first_loss_days is None else f"{r.first_loss_days:.4f}",
                Value(margin, r.margin_deg, Sampled(how="at moments of the span")),
                f"{r.beat_days:.4g}" + ("" if r.trimmed else ", resonant: no trim"),
            )
            for r in self.radii
        )
        header = ("radius, km", proven.heading, "lost on day", margin.heading, "beat, days")
        return [Table("Left alone at other radii, trimmed where it can be", header, rows)]

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw margin and room over time.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, MARS, axes_or_new

        drawn, found = axes_or_new(axes), self.drift
        days = found.times / SECONDS_PER_DAY
        drawn.plot(days, np.degrees(found.least[:, 0]), color=MARS, label="least margin, proven")
        if found.room is not None:
            room = np.degrees(found.room.room)
            drawn.plot(days, room, color=CYCLE[0], label="room in the slots")
        drawn.axhline(0.0, color="0.5", linewidth=0.8)
        drawn.set_ylim(bottom=max(-10.0, float(np.degrees(found.least[:, 0].min())) - 1.0))
        drawn.set(xlabel="days after the epoch", ylabel="degrees", title=self.design.name)
        drawn.legend()
        return drawn


def drift(
    design: Design | str | Path,
    *,
    days: float = 687.0,
    start_day: float = 0.0,
    step_days: float | None = None,
    fold: int | None = None,
    mask_deg: float | None = None,
    region: str | None = None,
    trimmed: bool = False,
    radius_km: Sequence[float] = (),
    avoid_km: float | None = None,
    progress: bool = False,
) -> DriftResult:
    """Follow a design that is left alone: margin and room over time, and the first loss, proven.

    A design of two-body motion is followed under the default forces: GMM-3 to degree 8, Sun,
    Phobos, Deimos and radiation on 0.026 m^2/kg with shadow.

    Parameters
    ----------
    design
        A design, or the path of its file.
    days, start_day
        Span, days, and its begin after the epoch.
    step_days
        Between the moments at which margin and room are given.
    fold, mask_deg
        Satellites in view at once and elevation mask, degrees; else the design's.
    region
        Where: ``lat:MIN:MAX`` or ``polygon:LAT,LON;LAT,LON;...``, degrees; else everywhere. The
        design's requirements are followed besides.
    trimmed
        Whether to trim the initial axes first.
    radius_km
        Radii at which to look how long the pattern lasts, trimmed where it can be.
    avoid_km
        Distance to keep from the centres of Phobos and Deimos.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.drift("designs/compass-15-5-1.toml", days=2)
    >>> found.days_proven
    2.0
    """
    if not 0 < days <= 36525:
        raise ArgumentError(f"days = {days:g}: allowed above 0 to 36525, a century")
    if not 0 <= start_day < np.inf:
        raise ArgumentError(f"start_day = {start_day:g}: must be 0 or more days")
    if avoid_km is not None and not 0 < avoid_km < np.inf:
        raise ArgumentError(f"avoid_km = {avoid_km:g}: must be more than 0 km")
    if step_days is not None and not 0 < step_days <= days:
        raise ArgumentError(f"step_days = {step_days:g}: allowed above 0 to days, {days:g}")
    read = given_design(design)
    wanted = read.fold if fold is None else fold
    mask = given_mask(mask_deg, read).highest
    where = GLOBE if region is None else read_region(region)
    motion = real_motion(read)
    stop = (start_day + days) * SECONDS_PER_DAY
    sphere = read.figure.equatorial_radius
    c, done = read.constellation, None
    if trimmed:
        done = trim(c, forces_of(motion), stop, progress=lambda x: bar(progress, "trim", x))
        c = done.constellation
    path = motion.trajectory(
        c, start_day * SECONDS_PER_DAY, stop, progress=lambda x: bar(progress, "orbits", x)
    )
    found = drift_of(
        read.constellation,
        path,
        wanted,
        days=days,
        start_day=start_day,
        sphere_radius=sphere,
        mask=mask,
        region=where,
        step_days=step_days,
        progress=lambda x: bar(progress, "margins", x),
    )
    radii = at_radii(
        read,
        radius_km,
        days=start_day + days,
        fold=wanted,
        mask=mask,
        region=where,
        progress=progress,
    )
    kept = promises_of(read, path, found.times, lambda x: bar(progress, "requirements", x))
    near = closest_approaches(path, start_day * SECONDS_PER_DAY, stop)
    return DriftResult(read, degrees(mask), motion.title, found, done, radii, kept, near, avoid_km)


def real_motion(design: Design) -> Motion:
    """Return the design's motion, or that under the default forces where it says two-body."""
    return Motion("numerical") if design.motion.model == "two-body" else design.motion


def forces_of(motion: Motion) -> ForceModel:
    """Return a motion's forces.

    Raises
    ------
    ArgumentError
        It has none.
    """
    if motion.forces is None:
        raise ArgumentError(
            f'trim: {motion.title} has no forces to trim for; give [motion] model = "numerical"'
        )
    return motion.forces


def at_radii(
    design: Design,
    radius_km: Sequence[float],
    *,
    days: float,
    fold: int,
    mask: float,
    region: Region = GLOBE,
    progress: bool = False,
) -> tuple[RadiusLasts, ...]:
    """How long a design's pattern lasts at other radii, km, from the epoch on; `mask` in radians.

    Raises
    ------
    ArgumentError
        Orbits that form no slots, or a motion without forces.
    """
    motion = real_motion(design)
    place = {
        "sphere_radius": design.figure.equatorial_radius,
        "mask": mask,
        "region": region,
    }

    def look(radius: float) -> RadiusLasts:
        stop = days * SECONDS_PER_DAY
        return _at_radius(design.constellation, radius, motion, fold, stop, place)

    # kernels release the interpreter, so that two radii are followed at once on two cores
    with ThreadPoolExecutor(min(os.cpu_count() or 1, max(len(radius_km), 1))) as pool:
        found = bar(progress and len(radius_km) > 0, "radii", pool.map(look, radius_km))
        return tuple(found)


def _at_radius(
    c: "Constellation",
    radius_km: float,
    motion: Motion,
    fold: int,
    stop: float,
    place: dict[str, Any],
) -> RadiusLasts:
    """How long the same pattern lasts on another radius."""
    if not has_slots(c):
        raise ArgumentError(
            "radius_km: a sweep needs a design of circular orbits of one radius and inclination"
        )
    moved = with_axes(c, np.full(c.size, radius_km * 1e3))
    beat, trimmed = beat_of(moved) / SECONDS_PER_DAY, can_trim(moved)
    chosen = trim(moved, forces_of(motion), stop).constellation if trimmed else moved
    path = motion.trajectory(chosen, 0.0, stop, tolerance=COARSE)
    lasts = prove_span(path, fold, **place, stop=stop)
    found = drift_margin(path, fold, lasts.proven_until, place)
    return RadiusLasts(
        radius_km, lasts.days_proven, lasts.first_loss_days, degrees(found), beat, trimmed
    )


def drift_margin(path: Any, fold: int, until: float, place: dict[str, Any]) -> float:
    """Least margin at a hundred moments up to a time, radians."""
    from compass.coverage.lasting import margins_at

    times = np.linspace(0.0, max(until, 1.0), 100)
    return float(margins_at(path, fold, times, **place).min())


def read_radii(text: str) -> list[float]:
    """Radii of ``FIRST..LAST:STEP`` or of a list with commas, km.

    Raises
    ------
    ArgumentError
        Neither, or more than 1000.
    """
    try:
        if ".." in text:
            ends, _, step = text.partition(":")
            first, last = (float(part) for part in ends.split(".."))
            count = int(np.floor((last - first) / float(step) + 1e-9)) + 1
            found = [first + k * float(step) for k in range(min(count, 1001))]
        else:
            found = [float(part) for part in text.split(",")]
    except (ValueError, ZeroDivisionError, OverflowError):
        found = []
    if not 0 < len(found) <= 1000 or not all(0 < radius < 1e7 for radius in found):
        raise ArgumentError(
            f"radius_km = {text!r}: write FIRST..LAST:STEP or A,B,C in km, at most 1000 radii"
        )
    return found

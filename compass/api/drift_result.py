"""What a design does that is left alone, as text, numbers, picture and files."""

from dataclasses import dataclass, field
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.drift_files import drift_dataset, elements_text, injected_design
from compass.api.lasting import LastingResult
from compass.api.promises import box_dict, outcome_of, promise_blocks, promise_dict
from compass.api.radii import RESONANT, RadiusLasts, real_motion
from compass.api.results import Result
from compass.conventions import dated
from compass.coverage.certificate import Outcome
from compass.coverage.drift import Drift
from compass.coverage.promises import Promise
from compass.coverage.room import has_slots
from compass.design import Design
from compass.document import Page, Sampled, Sentence, Table, Value
from compass.document.blocks import Block, facts
from compass.document.plain import plain
from compass.frames import SECONDS_PER_DAY
from compass.orbits.approach import Approach
from compass.orbits.forces import ForceModel
from compass.orbits.trimming import Trim, beat_of
from compass.quantities import quantity
from compass.saving import replacing, save_netcdf
from compass.study.mapping import provenance
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


#: Rows of the table over time that the text shows.
SHOWN = 12

#: What is told of a fold that is wanted always, and of no other.
_OF_A_FOLD = ("lost_between_s", "witness", "unsettled_s", "intervals")


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
    ground
        What the users followed stand on, where that is not the design's figure.
    asked
        Whether the satellites in view that margins are of are wanted always; else requirements
        are for shares of the time, or of geometry, alone, and they decide.
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
    ground: str = ""
    asked: bool = True

    @property
    def holds(self) -> bool:
        """Whether what is wanted is proven for the whole span, and the moons are kept away from.

        Wanted is what the design requires, and what cannot be followed is not proven; without
        requirements the fold.
        """
        outcome = outcome_of(self.promises) if self.promises else self.lasting.outcome
        return outcome is Outcome.PROVEN and self.avoids

    @property
    def avoids(self) -> bool:
        """Whether no satellite comes nearer to a moon than is to be kept."""
        least = min((a.distance for a in self.approaches), default=np.inf)
        return self.avoid_km is None or least >= self.avoid_km * 1e3

    @property
    def lasting(self) -> LastingResult:
        """The claim alone."""
        return LastingResult(
            self.design,
            self.drift.lasting.fold,
            self.mask_deg,
            self.motion,
            self.drift.lasting,
            self.ground,
        )

    @property
    def outcome(self) -> Outcome:
        """Of the fold; where none is wanted always, of the requirements."""
        return self.lasting.outcome if self.asked else outcome_of(self.promises)

    @property
    def days_proven(self) -> float:
        """Days for which that is proven."""
        if self.asked:
            return self.drift.lasting.days_proven
        return min((each.decides.days_proven for each in self.promises), default=0.0)

    @property
    def first_loss_days(self) -> float | None:
        """Days after the epoch at which it is lost; None if it is not."""
        if self.asked:
            return self.drift.lasting.first_loss_days
        losses = (each.first_loss_days for each in self.promises)
        return min((day for day in losses if day is not None), default=None)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON; lists over the days."""
        drift = self.drift
        nothing = {} if self.asked else dict.fromkeys(_OF_A_FOLD)
        return plain(
            {
                **self.lasting.to_dict(),
                "outcome": self.outcome,
                "days_proven": self.days_proven,
                "first_loss_days": self.first_loss_days,
                **nothing,
                "trimmed": self.trim is not None,
                "span_days": self.lasting.days,
                "days": drift.times / SECONDS_PER_DAY,
                "margin_deg": np.degrees(drift.least[:, 0]),
                "margin_at_moment_deg": np.degrees(drift.margin),
                "room_deg": None if drift.room is None else np.degrees(drift.room.room),
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
            *(self.lasting.blocks() if self.asked else ()),
            self._advice(),
            *self._over_time(),
            *self._per_satellite(),
            *self._trimmed(),
            *self._moons(),
            *self._other_radii(),
        ]
        return Page(self.design.name, tuple(blocks))

    def _advice(self) -> Sentence:
        forces = real_motion(self.design).forces or ForceModel()
        told = beat_of(self.design.constellation, forces.field)
        beat = told.period / SECONDS_PER_DAY
        if beat > RESONANT:
            often = "every day"
            if told.ratio != "1:1":
                often = f"every {counted(told.revolutions, 'revolution')}"
            return Sentence(
                f"the orbits keep pace with Mars's rotation, {told.ratio}: the field pushes each "
                f"satellite the same way {often}, so that no trim helps; some hundred kilometres "
                "lower or higher the push averages out"
            )
        if not beat:
            return Sentence("no term of Mars's field swings the satellites along their tracks")
        how = "trimmed once" if self.trim else "not trimmed; --trim makes mean rates agree"
        return Sentence(f"the push of Mars's field swings to and fro every {beat:.3g} days; {how}")

    def _over_time(self) -> list[Block]:
        drift = self.drift
        pick = np.unique(np.linspace(0, drift.times.size - 1, SHOWN).astype(int))
        margin, room = quantity("cap_margin_deg"), quantity("room_deg")
        known = drift.room
        rows = tuple(
            (
                f"{drift.times[k] / SECONDS_PER_DAY:.6g}",
                Value(margin, degrees(drift.least[k, 0])),
                Value(margin, degrees(drift.margin[k])),
                *(() if known is None else (Value(room, degrees(known.room[k])),)),
            )
            for k in pick
        )
        last = () if known is None else (room.heading,)
        header = ("day", f"least {margin.heading}", "at the moment", *last)
        step = (drift.times[1] - drift.times[0]) / SECONDS_PER_DAY
        ground = self._figure()
        whose = ""
        if not self.asked:
            fold, place = counted(drift.lasting.fold, "satellite"), drift.lasting.region.name
            whose = (
                "no requirement wants satellites always whose caps tell, so that margin and room "
                "are of the "
                f"design's own {fold} above {self.mask_deg:g} deg, {place}; "
            )
        note = (
            f"{whose}least margin: by how much all caps could shrink in the {counted(step, 'day')} "
            f"before, a proven bound (of the first row, in the day after); {self._slots()}"
            + (f"; {ground}" if ground else "")
        )
        return [Table("Margin and room over time", header, rows), Sentence(note)]

    def _slots(self) -> str:
        """What room is, or why there is none."""
        if self.drift.room is not None:
            return "room in the slots is smaller and only sufficient"
        if has_slots(self.design.constellation):
            return "no caps about the slots cover the place, so that there is no room in them"
        return (
            "orbits that are oval, or of several radii or inclinations, form no slots that turn as "
            "one: there is no room in them to tell"
        )

    def _figure(self) -> str:
        """How angles are meant and how good they are on an ellipsoid; empty on a sphere."""
        if self.design.figure.is_sphere or self.ground:
            return ""
        return (
            "margins are of the ellipsoid, stretched to its equatorial sphere, good to 0.01 deg; "
            "room and box are of the largest caps in which all of it sees a satellite, to 0.03 deg"
        )

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
        return dated(drift_dataset(self))

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
                f"{r.beat_days:.4g}"
                + (f", {r.resonance} resonance" if r.resonance else "")
                + ("" if r.trimmed else ": no trim"),
            )
            for r in self.radii
        )
        header = ("radius, km", proven.heading, "lost on day", margin.heading, "beat, days")
        title = "Left alone at other radii, trimmed where it can be"
        return [Table(title, header, rows)]

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw margin and room over time.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, MARS, axes_or_new

        drawn, drift = axes_or_new(axes), self.drift
        days = drift.times / SECONDS_PER_DAY
        drawn.plot(days, np.degrees(drift.least[:, 0]), color=MARS, label="least margin, proven")
        if drift.room is not None:
            room = np.degrees(drift.room.room)
            drawn.plot(days, room, color=CYCLE[0], label="room in the slots")
        drawn.axhline(0.0, color="0.5", linewidth=0.8)
        drawn.set_ylim(bottom=max(-10.0, float(np.degrees(drift.least[:, 0].min())) - 1.0))
        drawn.set(xlabel="days after the epoch", ylabel="degrees", title=self.design.name)
        drawn.legend()
        return drawn

    def write(self, path: str | Path, *, command: str = "compass.drift") -> None:
        """Write the dataset as netCDF.

        Raises
        ------
        OutputError
            It cannot be written.
        """
        made = provenance(self.design, command)
        known = {name: words for name, words in made.items() if words}
        save_netcdf(Path(path), self.dataset.assign_attrs(known))

    def write_elements(self, path: str | Path) -> None:
        """Write the trimmed elements as a design file of pattern ``elements``, with its tolerances.

        Raises
        ------
        ArgumentError
            There was no trim.
        OutputError
            The file cannot be written.
        """
        written = elements_text(self)
        with replacing(Path(path)) as temporary:
            temporary.write_text(written, encoding="utf-8")

    def write_orbits(self, folder: str | Path) -> None:
        """Write the trimmed orbits, integrated from the epoch to the end of the span, as OEM.

        A file a satellite, with states as near as any export, or as near as it may have in all.

        Raises
        ------
        ArgumentError
            There was no trim.
        OutputError
            The folder is in use or cannot be made.
        """
        from compass.api.export import export
        from compass.handover.instants import MOST_STATES, default_step

        trimmed, stop = injected_design(self), self.drift.lasting.stop
        c = trimmed.constellation
        least = np.ceil(stop / (MOST_STATES // c.size - 1))
        step = min(max(default_step(c), float(least)), stop)
        export(trimmed, format="oem", output=folder, duration_h=stop / 3600.0, step_s=step)

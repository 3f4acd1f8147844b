"""Station-keeping of a design: what it costs to hold every satellite in its slot."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import degrees, exp, radians
from pathlib import Path
from typing import Any

import numpy as np

from compass.api.drift import RadiusLasts, at_radii, forces_of, real_motion
from compass.api.given import given_design, given_mask
from compass.api.progress import bar
from compass.api.results import Result
from compass.coverage.margin import covering_radius
from compass.coverage.room import has_slots, slot_box
from compass.design import Design, Upkeep
from compass.document import Page, Sampled, Sentence, Table, Value, Verdict
from compass.document.blocks import facts
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.keeping import Keeping, keep_slots
from compass.quantities import quantity

#: A year here, s, and standard gravity, m/s^2.
YEAR, STANDARD_GRAVITY = 365.25 * SECONDS_PER_DAY, 9.80665


@dataclass(frozen=True, repr=False)
class KeepResult(Result):
    """What it took to keep a design's satellites in their slots.

    Attributes
    ----------
    design
        What was kept.
    motion
        Under what.
    keeping
        The simulation, SI.
    margin_deg
        What a satellite may leave its slot by, sideways; the box is part of it.
    upkeep
        What the satellites keep themselves with.
    radii
        How long the pattern lasts untouched at other radii, if asked for.
    """

    design: Design = field(repr=False)
    motion: str
    keeping: Keeping
    margin_deg: float
    upkeep: Upkeep
    radii: tuple[RadiusLasts, ...] = ()

    @property
    def years(self) -> float:
        """Time simulated."""
        return self.keeping.duration / YEAR

    @property
    def delta_v_m_s_year(self) -> list[float]:
        """Of each satellite, m/s an Earth year."""
        return [float(spent) / self.years for spent in self._spent()]

    def _spent(self) -> Any:
        """All impulses of each satellite, m/s."""
        return self.keeping.delta_v + self.keeping.delta_v_across

    @property
    def holds(self) -> bool:
        """Whether box, oval swing and tilt stayed within what the margin allows."""
        return bool(degrees(self._used().max()) <= self.margin_deg)

    def _used(self) -> Any:
        """Angle from the slot at worst: along the track and across it at once, radians."""
        return np.hypot(self.keeping.worst, self.keeping.tilt)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        found = self.keeping
        costs = self.delta_v_m_s_year
        return plain(
            {
                "design": self.design.name,
                "motion": self.motion,
                "years": self.years,
                "box_deg": degrees(found.half_width),
                "margin_deg": self.margin_deg,
                "holds": self.holds,
                "delta_v_keeping_m_s_year": max(costs),
                "delta_v_mean_m_s_year": float(np.mean(costs)),
                "delta_v_sum_m_s_year": float(np.sum(costs)),
                "specific_impulse_s": self.upkeep.specific_impulse,
                "dry_mass_kg": self.upkeep.dry_mass,
                "smallest_burn_m_s": self.upkeep.smallest_burn,
                "execution_error": self.upkeep.execution_error,
                "navigation_error_m": self.upkeep.navigation_error,
                "untouched": [r.as_dict() for r in self.radii],
                "per_satellite": [
                    {
                        "name": name,
                        "delta_v_m_s_year": costs[s],
                        "push_m_s_year": float(found.push[s]) * YEAR,
                        "across_m_s_year": float(found.delta_v_across[s]) / self.years,
                        "burns": int(found.burns[s]),
                        "burns_across": int(found.burns_across[s]),
                        "days_between_burns": self._between(s),
                        "worst_in_track_deg": degrees(found.worst[s]),
                        "worst_cross_track_deg": degrees(found.tilt[s]),
                        "propellant_kg": self._propellant(s),
                    }
                    for s, name in enumerate(self.design.constellation.satellite_names)
                ],
            }
        )

    def _between(self, s: int) -> float | None:
        burns = int(self.keeping.burns[s] + self.keeping.burns_across[s])
        return self.keeping.duration / SECONDS_PER_DAY / burns if burns else None

    def _propellant(self, s: int) -> float:
        """Of the rocket equation, kg."""
        exhaust = STANDARD_GRAVITY * self.upkeep.specific_impulse
        return self.upkeep.dry_mass * (exp(float(self._spent()[s]) / exhaust) - 1.0)

    def document(self) -> Page:
        """The cost in a sentence, then satellite by satellite."""
        found, out = self.keeping, self.to_dict()
        cost = quantity("delta_v_keeping_m_s_year")
        low, high = (Value(cost, f(self.delta_v_m_s_year)) for f in (min, max))
        mean = Value(cost, out["delta_v_mean_m_s_year"])
        claim = (
            f"{low} to {high} m/s an Earth year a satellite, mean {mean}, to stay within "
            f"{degrees(found.half_width):.3g} deg of its slot along the track"
        )
        names = ("delta_v_keeping_m_s_year", "propellant_kg", "days_between_burns")
        rows = tuple(
            (
                row["name"],
                Value(cost, row["delta_v_m_s_year"]),
                row["burns"],
                row["burns_across"],
                "" if row["days_between_burns"] is None else f"{row['days_between_burns']:.4g}",
                f"{row['worst_in_track_deg']:.3g}",
                f"{row['worst_cross_track_deg']:.3g}",
                Value(quantity("propellant_kg"), row["propellant_kg"]),
            )
            for row in out["per_satellite"]
        )
        header = (
            "satellite", cost.heading, "burns along", "across", "days between",
            "worst in track, deg", "worst cross track, deg", quantity(names[1]).heading,
        )  # fmt: skip
        how = (
            f"simulated over {self.years:.4g} years, one look a revolution, {self.motion}; "
            f"specific impulse {self.upkeep.specific_impulse:g} s, "
            f"{self.upkeep.dry_mass:g} kg dry, "
            f"burns from {self.upkeep.smallest_burn:g} m/s on, good to "
            f"{100 * self.upkeep.execution_error:g} %, places known to "
            f"{self.upkeep.navigation_error:g} m (all 1 sigma): the table [keeping] says otherwise"
        )
        evidence = Sampled(how="one simulation")
        return Page(
            self.design.name,
            (
                Verdict("" if self.holds else "leaves its slots", claim, self.holds),
                facts(
                    "Keeping",
                    [
                        Value(cost, out["delta_v_keeping_m_s_year"], evidence),
                        Value(quantity("slot_sideways_deg"), self.margin_deg),
                    ],
                ),
                Table("Satellite by satellite", header, rows),
                Sentence(how),
                *self._untouched(),
            ),
        )

    def _untouched(self) -> list[Table]:
        """The same pattern at other radii, which nobody keeps."""
        rows = tuple(
            (f"{r.radius_km:g}", Value(quantity("days_proven"), r.days_proven), "0")
            for r in self.radii
        )
        header = ("radius, km", quantity("days_proven").heading, "delta-v, m/s/year")
        return [Table("Untouched instead, trimmed once", header, rows)] if rows else []


def keep(
    design: Design | str | Path,
    *,
    years: float | None = None,
    box_deg: float | None = None,
    fold: int | None = None,
    mask_deg: float | None = None,
    radius_km: Sequence[float] = (),
    specific_impulse_s: float | None = None,
    dry_mass_kg: float | None = None,
    smallest_burn_m_s: float | None = None,
    execution_error: float | None = None,
    navigation_error_m: float | None = None,
    seed: int = 0,
    progress: bool = False,
) -> KeepResult:
    """Simulate impulsive station-keeping of every satellite in its slot along the track.

    Parameters
    ----------
    design
        A design of circular orbits of one radius and inclination, or the path of its file; one
        of two-body motion is kept under the default forces.
    years
        Time to simulate, Earth years of 365.25 days; else the design's, as all that follows.
    box_deg
        Half width of the box along the track, degrees; else half of what the margin allows.
    fold, mask_deg
        Satellites in view at once and elevation mask, degrees; else the design's.
    radius_km
        Radii at which to look how long the pattern lasts untouched, for as long.
    specific_impulse_s, dry_mass_kg
        For the propellant.
    smallest_burn_m_s, execution_error, navigation_error_m
        Of the burns: the least, the relative error, the error of the place along the track.
    seed
        Of the errors.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.keep("designs/compass-15-5-1.toml", years=0.1)
    >>> found.holds, len(found.delta_v_m_s_year)
    (True, 15)
    """
    read = given_design(design)
    upkeep = _upkeep(
        read.upkeep,
        years=years,
        specific_impulse_s=specific_impulse_s,
        dry_mass_kg=dry_mass_kg,
        smallest_burn_m_s=smallest_burn_m_s,
        execution_error=execution_error,
        navigation_error_m=navigation_error_m,
    )
    c, motion = read.constellation, real_motion(read)
    if not has_slots(c):
        raise ArgumentError(
            "keep: slots need circular orbits of one radius and inclination; this design has others"
        )
    wanted = read.fold if fold is None else fold
    covering = covering_radius(c, wanted, tolerance=1e-5).radius
    mask = given_mask(mask_deg, read).highest
    axis = float(c.semi_major_axis[0])
    margin = slot_box(axis, covering, read.figure.equatorial_radius, mask).sideways
    width = 0.5 * margin if box_deg is None else radians(box_deg)
    found = keep_slots(
        c,
        forces_of(motion),
        upkeep.duration,
        width,
        across=0.5 * width,
        smallest_burn=upkeep.smallest_burn,
        execution_error=upkeep.execution_error,
        navigation_error=upkeep.navigation_error,
        seed=seed,
        progress=lambda parts: bar(progress, "keeping", parts),
    )
    days = upkeep.duration / SECONDS_PER_DAY
    radii = at_radii(read, radius_km, days=days, fold=wanted, mask=mask, progress=progress)
    return KeepResult(read, motion.title, found, degrees(margin), upkeep, radii)


#: Options: field of `Upkeep`, factor to SI, least and most.
_LIMITS = {
    "years": ("duration", YEAR, 0.1, 100.0),
    "specific_impulse_s": ("specific_impulse", 1.0, 1e-3, 1e6),
    "dry_mass_kg": ("dry_mass", 1.0, 1e-3, 1e6),
    "smallest_burn_m_s": ("smallest_burn", 1.0, 0.0, 100.0),
    "execution_error": ("execution_error", 1.0, 0.0, 0.5),
    "navigation_error_m": ("navigation_error", 1.0, 0.0, 1e6),
}


def _upkeep(given: Upkeep, **options: float | None) -> Upkeep:
    """Return what a design says, but for the options that are given."""
    changed = {}
    for name, value in options.items():
        field_name, factor, least, most = _LIMITS[name]
        if value is None:
            continue
        if not least <= value <= most:
            raise ArgumentError(f"{name} = {value:g}: allowed {least:g} to {most:g}")
        changed[field_name] = value * factor
    return replace(given, **changed)

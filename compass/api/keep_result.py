"""What keeping satellites in their slots takes, as text, numbers and picture."""

from dataclasses import dataclass, field
from math import degrees, exp
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.radii import RadiusLasts
from compass.api.results import Result
from compass.coverage.room import has_slots
from compass.design import Design, Upkeep
from compass.document import Page, Sampled, Sentence, Table, Value, Verdict
from compass.document.blocks import facts
from compass.document.plain import plain
from compass.frames import SECONDS_PER_DAY
from compass.orbits.keeping import Keeping
from compass.quantities import quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: A year here, s, and standard gravity, m/s^2.
YEAR = 365.25 * SECONDS_PER_DAY
STANDARD_GRAVITY = 9.80665


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
        What a satellite may leave its slot by, sideways; the box is part of it. Twice the box of
        orbits that form no slots.
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
        keeping = self.keeping
        costs = self.delta_v_m_s_year
        return plain(
            {
                "design": self.design.name,
                "motion": self.motion,
                "years": self.years,
                "box_deg": degrees(keeping.half_width),
                "margin_deg": self.margin_deg,
                "holds": self.holds,
                "evidence": self.evidence,
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
                        "push_m_s_year": float(keeping.push[s]) * YEAR,
                        "across_m_s_year": float(keeping.delta_v_across[s]) / self.years,
                        "burns": int(keeping.burns[s]),
                        "burns_across": int(keeping.burns_across[s]),
                        "days_between_burns": self._between(s),
                        "worst_in_track_deg": degrees(keeping.worst[s]),
                        "worst_cross_track_deg": degrees(keeping.tilt[s]),
                        "propellant_kg": self._propellant(s),
                    }
                    for s, name in enumerate(self.design.constellation.satellite_names)
                ],
            }
        )

    @property
    def evidence(self) -> str:
        """How well what it takes is known."""
        return (
            f"one simulation over {self.years:.4g} years, one look a revolution, {self.motion}; "
            "how another draw of the burns' errors would differ is not known"
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
        keeping, out = self.keeping, self.to_dict()
        cost = quantity("delta_v_keeping_m_s_year")
        low, high = (Value(cost, f(self.delta_v_m_s_year)) for f in (min, max))
        mean = Value(cost, out["delta_v_mean_m_s_year"])
        claim = (
            f"{low} to {high} m/s an Earth year a satellite, mean {mean}; turned back "
            f"{degrees(keeping.half_width):.3g} deg along the track from its slot, "
            f"{degrees(self._used().max()):.3g} deg off at worst, {self.margin_deg:.3g} allowed"
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
            f"{self.evidence}; "
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
                        Value(cost, out["delta_v_keeping_m_s_year"], evidence, "largest"),
                        Value(quantity("slot_sideways_deg"), self.margin_deg, whose="allowed"),
                    ],
                ),
                Table("Satellite by satellite", header, rows),
                Sentence(how),
                *self._kinds(),
                *self._untouched(),
            ),
        )

    def _kinds(self) -> list[Sentence]:
        """What is kept where there are no slots that turn as one."""
        if has_slots(self.design.constellation):
            return []
        return [
            Sentence(
                "each kind of orbit is kept in its phases and planes, not its periapses, and not "
                "against other kinds; allowed is twice the box asked for, which proves no "
                "coverage; impulses are given where satellites then are, not where they cost least"
            )
        ]

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw what keeping each satellite in its slot costs.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.bars import draw_bars

        names, title = self.design.constellation.satellite_names, "keeping every satellite's slot"
        cost = quantity("delta_v_keeping_m_s_year")
        return draw_bars(axes, names, self.delta_v_m_s_year, cost, f"{self.design.name}: {title}")

    def _untouched(self) -> list[Table]:
        """The same pattern at other radii, which nobody keeps."""
        rows = tuple(
            (f"{r.radius_km:g}", Value(quantity("days_proven"), r.days_proven), "0")
            for r in self.radii
        )
        header = ("radius, km", quantity("days_proven").heading, "delta-v, m/s/year")
        return [Table("Untouched instead, trimmed once", header, rows)] if rows else []

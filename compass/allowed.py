"""What each number of a public function may be: least, most and a remark, by its name.

`compass.arguments.checked` refuses what lies outside before a function begins; what is reached in
other ways asks `check_allowed`. Where a function means something else by a name, the range stands
behind ``function.name``. What depends on other arguments is left to the functions.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from compass.errors import ArgumentError

#: Longest span and latest start, days: a century, as the frames hold.
LONGEST_DAYS = 36525.0
#: Most entries of a campaign: they are kept in memory, 0.1 MB each.
MOST_SAMPLES = 1 << 13


@dataclass(frozen=True)
class Range:
    """Numbers from `least` to `most`; without `least` itself if `above`, without `most` if `below`.

    Attributes
    ----------
    remark
        The unit, and what `most` is.
    """

    least: float
    most: float
    remark: str = ""
    above: bool = False
    below: bool = False

    def has(self, value: float) -> bool:
        """Whether a number is in the range; one that is none is not."""
        low = self.least < value if self.above else self.least <= value
        return bool(low and (value < self.most if self.below else value <= self.most))

    def __str__(self) -> str:
        low = "above " if self.above else ""
        high = "up to below" if self.below else "to"
        remark = f" {self.remark}" if self.remark else ""
        return f"{low}{_digits(self.least)} {high} {_digits(self.most)}{remark}"


def _digits(number: float) -> str:
    """Whole numbers in full as long as they can be read, others as short as they are."""
    return str(int(number)) if number == int(number) and abs(number) <= 1e6 else f"{number:g}"


def _positive(most: float, remark: str = "") -> Range:
    return Range(0.0, most, remark, above=True)


_CENTURY = "days, a century"
_ANGLE = Range(-1e6, 1e6, "degrees")
_SIGMA_M = Range(0.0, 1e9, "metres")
_DILUTION = Range(1.0, 1e6)

#: Ranges by the names of arguments.
RANGES = {
    # times
    "budget_s": _positive(1e7, "seconds"),
    "days": _positive(LONGEST_DAYS, _CENTURY),
    "duration_h": _positive(1e6, "hours"),
    "duration_sols": _positive(1000.0, "sols"),
    "epoch": Range(-1e11, 1e11, "seconds after J2000"),
    "ephemeris.times": Range(-1e11, 1e11, "seconds after the epoch"),
    "export.duration_h": _positive(87_600.0, "hours, ten years"),
    "export.step_s": Range(1e-3, 1e6, "seconds"),
    "hours": _positive(1e5, "hours"),
    "longest_wait_days": Range(1e-3, LONGEST_DAYS, _CENTURY),
    "series.days": _positive(1000.0, "days"),
    "start_day": Range(0.0, LONGEST_DAYS, _CENTURY),
    "step_days": _positive(LONGEST_DAYS, _CENTURY),
    "step_s": _positive(1e6, "seconds"),
    "update_h": Range(0.0, 1e4, "hours"),
    "years": Range(0.1, 100.0, "years"),
    # places and angles
    "Requirement.of.altitude_km": Range(0.0, 1e6, "kilometres"),
    "Requirement.of.mask_deg": Range(-90.0, 90.0, "degrees", above=True, below=True),
    "above_m": Range(0.0, 1e5, "metres over the ground"),
    "argument_of_periapsis_deg": _ANGLE,
    "avoid_km": _positive(1e6, "kilometres"),
    "beam_deg": Range(0.0, 180.0, "degrees", above=True, below=True),
    "box_deg": Range(0.0, 90.0, "degrees", above=True, below=True),
    "drift.radius_km": _positive(1e6, "kilometres"),
    "keep.radius_km": _positive(1e6, "kilometres"),
    "launch_altitude_km": Range(100.0, 1e6, "kilometres"),
    "least_approach_deg": Range(0.0, 180.0, "degrees", below=True),
    "longitude_deg": _ANGLE,
    "map.altitude_km": Range(0.0, 1e6, "kilometres"),
    "map.mask_deg": Range(-90.0, 90.0, "degrees", above=True, below=True),
    "mask_deg": Range(0.0, 90.0, "degrees", below=True),
    "mean_anomaly_deg": _ANGLE,
    "phase_deg": _ANGLE,
    "raan_deg": _ANGLE,
    "series.beam_deg": Range(0.0, 90.0, "degrees", above=True),
    "step_deg": Range(0.05, 90.0, "degrees"),
    "true_anomaly_deg": _ANGLE,
    # errors, one sigma, and how much of them
    "clock_drift_m_s": Range(0.0, 3e8, "metres a second"),
    "clock_m": _SIGMA_M,
    "density_sigma": Range(0.0, 10.0),
    "doppler_m_s": _positive(1e6, "metres a second"),
    "error_max_m": _positive(1e9, "metres"),
    "execution_error": Range(0.0, 0.5),
    "goal_m": _positive(1e9, "metres"),
    "height_m": _positive(1e9, "metres"),
    "lift_sigma": Range(0.0, 10.0),
    "navigation_error_m": Range(0.0, 1e6, "metres"),
    "orbit_m": _SIGMA_M,
    "pdop_max": _DILUTION,
    "range_bias_m": _SIGMA_M,
    "satellite_clock_m": _SIGMA_M,
    "share": _positive(1.0),
    "width": Range(0.0, 1.0, above=True, below=True),
    **{f"{name}_at_most": _DILUTION for name in ("gdop", "pdop", "hdop", "vdop", "tdop")},
    **{
        f"error_{name}_m_at_most": _positive(1e9, "metres")
        for name in ("horizontal", "vertical", "position", "time")
    },
    # spacecraft
    "dry_mass_kg": Range(1e-3, 1e6, "kilograms"),
    "gm": _positive(1e21, "m^3/s^2"),
    "smallest_burn_m_s": Range(0.0, 100.0, "metres a second"),
    "specific_impulse_s": Range(1e-3, 1e6, "seconds"),
    # numbers of things
    "azimuths": Range(4, 36_000),
    "beyond": Range(0, 10_000),
    "epochs": Range(1, 100_000),
    "finalists": Range(0, 10_000),
    "fold": Range(1, 10_000),
    "losses": Range(0, 10_000),
    "max_satellites": Range(1, 64),  # sizes that a search can take on in reasonable time
    "runs": Range(1, 100_000),
    "samples": Range(1, MOST_SAMPLES),
    "satellites_a_launch": Range(1, 10_000),
    "seed": Range(0, 1_000_000_000),
    "series.epochs": Range(2, 1_000_000),
    "warm.workers": Range(1, 256),
    "workers": Range(1, 1024),
}


def check_allowed(name: str, value: float, where: str = "") -> None:
    """Refuse a number outside its range, if its name has one; `where` names the function.

    Raises
    ------
    ArgumentError
        Naming the argument, its value and the range.
    """
    allowed = RANGES.get(f"{where}.{name}", RANGES.get(name))
    if allowed is not None and not allowed.has(value):
        raise ArgumentError(f"{name} = {_shown(value)}: allowed {allowed}")


def check_all_allowed(where: str = "", **numbers: float | Iterable[float] | None) -> None:
    """Refuse the first of some arguments that is outside its range; None is left out.

    Raises
    ------
    ArgumentError
        As `check_allowed`.
    """
    for name, value in numbers.items():
        for number in value if isinstance(value, Iterable) else (value,):
            if number is not None:
                check_allowed(name, number, where)


def _shown(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:g}"

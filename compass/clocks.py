"""Clocks: how far one runs away from the time it was last set to, from its Allan deviation."""

from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from math import log, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import SPEED_OF_LIGHT
from compass.errors import ArgumentError

SECONDS_PER_DAY = 86400.0


@dataclass(frozen=True)
class Clock:
    """A clock by its Allan variance ``white^2/tau + flicker^2 + walk^2 tau``, drift named apart.

    Attributes
    ----------
    name
        What to call it.
    white
        Allan deviation of white frequency noise at 1 s, s^(1/2).
    flicker
        Floor of the Allan deviation.
    walk
        Allan deviation of a random walk of the frequency at 1 s, s^(-1/2).
    drift_per_day
        Relative change of the frequency in a day that nobody takes out: no noise, but it counts
        as one sigma of an error.
    frequency_sigma
        How well the frequency is known when the data are made, relative, one sigma.
    source
        Where the numbers are from.
    """

    name: str = "given"
    white: float = 0.0
    flicker: float = 0.0
    walk: float = 0.0
    drift_per_day: float = 0.0
    frequency_sigma: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        """Refuse a negative number, and a clock that never errs."""
        numbers = {name: getattr(self, name) for name in PARAMETERS}
        for name, value in numbers.items():
            if not 0.0 <= value < 1.0:
                raise ArgumentError(f"{name} = {value:g}: allowed 0 up to below 1")
        if not any(numbers.values()):
            raise ArgumentError(
                f"clock {self.name!r}: has no parameters; give one of {', '.join(PARAMETERS)}, "
                f"or a name: {', '.join(CLOCK_NAMES)}"
            )

    @property
    def title(self) -> str:
        """Its name as people write it, and the numbers that are not those of that name."""
        parts = self.name.split("-")
        name = "-".join(p.upper() if p in ("uso", "csac", "rafs", "dsac") else p for p in parts)
        usual = next((clock for clock in CLOCKS if clock.name == self.name), None)
        own = {
            key: getattr(self, key)
            for key in PARAMETERS
            if getattr(self, key) != (getattr(usual, key) if usual else 0.0)
        }
        told = ", ".join(f"{key} {value:.3g}" for key, value in own.items())
        return f"{name} ({told})" if told else name

    def deviation(self, tau: ArrayLike) -> NDArray[np.float64]:
        """Allan deviation at averaging times of tau seconds."""
        t = np.asarray(tau, dtype=float)
        return np.sqrt(self.white**2 / t + self.flicker**2 + self.walk**2 * t)

    def variance(self, age: ArrayLike) -> NDArray[np.float64]:
        """Square of the range error of a prediction of some age, m^2, one sigma.

        ``c^2 (white^2 a + flicker^2 a^2/ln 2 + walk^2 a^3 + (s a)^2 + (D a^2/2)^2)`` at age a in
        seconds, with the frequency's own error s and its drift D.

        References
        ----------
        Riley 2008, Handbook of Frequency Stability Analysis, NIST SP 1065, section 5.14: the error
        of predicted time is tau sigma_y for white noise and a random walk of the frequency, and
        tau sigma_y / sqrt(ln 2) for flicker.
        """
        a = np.asarray(age, dtype=float)
        return sum((c * a**power for power, c in self._powers), np.zeros_like(a))

    def mean_variance(self, longest: float) -> float:
        """Mean of `variance` over ages from 0 to `longest` seconds, m^2."""
        return sum(c * longest**power / (power + 1) for power, c in self._powers)

    @property
    def _powers(self) -> tuple[tuple[int, float], ...]:
        """Powers of the age and their coefficients in the variance, m^2."""
        c2, drift = SPEED_OF_LIGHT.value**2, self.drift_per_day / SECONDS_PER_DAY
        return (
            (1, c2 * self.white**2),
            (2, c2 * (self.flicker**2 / log(2.0) + self.frequency_sigma**2)),
            (3, c2 * self.walk**2),
            (4, c2 * drift**2 / 4.0),
        )


PARAMETERS = ("white", "flicker", "walk", "drift_per_day", "frequency_sigma")
CLOCK_NAMES = ("uso", "csac", "mini-rafs", "rafs", "passive-maser", "dsac")

#: The clocks that have names. None has a drift or a frequency error: what a constellation leaves of
#: those depends on how it is run, and is the user's to say.
CLOCKS = (
    Clock(
        "uso",
        flicker=1e-13,
        source="ultra-stable quartz: below 1e-13 over 1 to 100 s in flight on GRAIL, NASA Tech "
        "Briefs, February 2013, ntrs.nasa.gov 20130009795; its drift (some 1e-10 a day before it "
        "is estimated) is to be added",
    ),
    Clock(
        "csac",
        white=3e-10,
        source="chip-scale caesium: 3e-10 at 1 s as its makers state; 2.4e-10 at 1 s in Kitching "
        "et al. 2005, European Frequency and Time Forum",
    ),
    Clock(
        "mini-rafs",
        white=1e-11,
        source="miniature rubidium: 1e-11 at 1 s as a class (Schmittberger and Scherer 2020, "
        "arXiv 2004.09987, compares such); single units are stated with 5e-12 to 5e-10",
    ),
    Clock(
        "rafs",
        white=1.9e-12,
        source="rubidium standard of navigation satellites: 1.9e-12 at 1 s as a class",
    ),
    Clock(
        "passive-maser",
        flicker=1.15e-14,
        source="passive hydrogen maser: 1.15e-14 at a day as a class; the engineering model of "
        "Galileo's has 7e-15 at best and 1.2e-14 at 50,000 s, with its drift (Berthoud et al. "
        "2003, Frequency Control Symposium)",
    ),
    Clock(
        "dsac",
        white=2e-15 * sqrt(SECONDS_PER_DAY),
        source="mercury ions: 2e-15 at a day on the ground, Ely et al. 2018, doi "
        "10.1109/TUFFC.2018.2808269",
    ),
)


def clock_named(name: str, **changes: Any) -> Clock:
    """Return the clock of a name, some of its numbers replaced.

    Raises
    ------
    ArgumentError
        There is none of that name; the message has the names.
    """
    for clock in CLOCKS:
        if clock.name == name:
            return replace(clock, **changes) if changes else clock
    near = get_close_matches(name, CLOCK_NAMES, n=1)
    guess = f"did you mean {near[0]}? " if near else ""
    raise ArgumentError(
        f"clock = {name!r}: not known; {guess}allowed: {', '.join(CLOCK_NAMES)}, or a table with "
        f"{', '.join(PARAMETERS)}"
    )


assert tuple(clock.name for clock in CLOCKS) == CLOCK_NAMES
assert {*PARAMETERS, "name", "source"} == {field.name for field in fields(Clock)}

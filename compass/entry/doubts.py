"""What judged landers do not know of clocks and orbits: usual sigmas, or a design's own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compass.allowed import check_all_allowed
from compass.entry.unknowns import Unknowns
from compass.ranging import Signal
from compass.signal.budget import mean_age_covariance


@dataclass(frozen=True)
class Doubts:
    """One sigma of everything, as a user says it.

    Attributes
    ----------
    clock_m, clock_drift_m_s
        Of the receiver's clock when the entry begins; both 0 for one that agrees with the
        satellites', or ranges both ways. By default a clock set to 0.1 ms from Earth, and a
        quartz oscillator good to 1e-9.
    orbit_m
        Radial, along and cross error of broadcast orbits.
    satellite_clock_m
        Of broadcast clocks.
    range_bias_m
        Of a bias of the ranges to each satellite.
    """

    clock_m: float = 3e4
    clock_drift_m_s: float = 0.3
    orbit_m: tuple[float, float, float] = (2.0, 8.0, 5.0)
    satellite_clock_m: float = 3.0
    range_bias_m: float = 1.0

    def __post_init__(self) -> None:
        check_all_allowed(orbit_m=self.orbit_m, satellite_clock_m=self.satellite_clock_m)
        self.of(None, 0)

    def of(self, signal: Signal | None, satellites: int) -> Unknowns:
        """What is not known with so many satellites: of them what their [signal] says, if any."""
        clock, drift, bias = self.clock_m, self.clock_drift_m_s, self.range_bias_m
        if signal is None:
            given = np.diag(np.square([*self.orbit_m, self.satellite_clock_m]))
            return Unknowns((clock, drift), given, bias)
        if clock:  # one that agrees with the satellites' shares what their time is off by
            clock = float(np.hypot(clock, signal.common_time))
        given = mean_age_covariance(signal, satellites)
        return Unknowns((clock, drift), given, bias, signal.common_orientation)

    def sentence(self, own: Sequence[str]) -> str:
        """Say what is counted; `own`: designs whose satellites have their own errors."""
        clock = (
            f"the receiver's clock, known to {self.clock_m:g} m and {self.clock_drift_m_s:g} m/s "
            "at first and estimated"
            if self.clock_m
            else "a receiver's clock that agrees with the satellites'"
        )
        radial, along, cross = self.orbit_m
        said = (
            f"Counted, one sigma: {clock}; satellites' orbits to {radial:g}, {along:g}, {cross:g} "
            f"m (radial, along, cross) and clocks to {self.satellite_clock_m:g} m, and a bias of "
            f"the ranges to each of {self.range_bias_m:g} m, considered"
        )
        if own:
            said += (
                f"; orbits, clocks and what they have wrong alike of {', '.join(own)} by its own "
                "table [signal]"
            )
        return said + "."


#: Satellites known exactly, and clocks that agree.
NO_DOUBTS = Doubts(0.0, 0.0, (0.0, 0.0, 0.0), 0.0, 0.0)

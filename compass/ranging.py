"""What goes into the error of one range: clock, orbit, what all share, receiver, ionosphere."""

from dataclasses import dataclass, field
from math import pi
from typing import Literal

import numpy as np

from compass.clocks import Clock
from compass.errors import ArgumentError

Age = Literal["mean", "worst"]

#: Three numbers along the radial, along-track and cross-track directions of a satellite.
RadialAlongCross = tuple[float, float, float]
#: Covariance of radial, along, cross and clock of one satellite, m^2.
Matrix = tuple[tuple[float, ...], ...]

#: One sigma times this holds 95 % of the errors: exactly of a height or time, and at least of a
#: horizontal or three-dimensional one, whatever the shape of its ellipse. A weighted sum of squares
#: of normal numbers, weights adding up to 1, stays below 3.84 least often with all weight on one
#: (Szekely and Bakirov 2003, Probability Theory and Related Fields 126:184).
FACTOR_95 = 1.959963984540054

MAS = pi / 180.0 / 3600.0 / 1000.0


@dataclass(frozen=True)
class Receiver:
    """Noise of one range measured by a user, one sigma.

    ``noise + zenith / sin(elevation)``; or of a code loop on the link's C/N0, Kaplan and Hegarty
    2006, Understanding GPS, 2nd ed., equation 5.16, which adds to it.

    Attributes
    ----------
    noise, zenith
        Metres.
    chip
        Length of a chip of the code, m; 0 without a loop.
    bandwidth
        Of the loop, Hz, one-sided.
    spacing
        Early to late, in chips.
    integration
        Before the detector, s.
    """

    noise: float = 0.0
    zenith: float = 0.0
    chip: float = 0.0
    bandwidth: float = 1.0
    spacing: float = 1.0
    integration: float = 0.02

    def __post_init__(self) -> None:
        """Refuse what no receiver can be."""
        for name in ("noise", "zenith", "chip"):
            _check(f"receiver.{name}_m", getattr(self, name))
        if not (self.bandwidth > 0 and 0 < self.spacing < 2 and self.integration > 0):
            raise ArgumentError(
                f"receiver: loop_hz = {self.bandwidth:g}, spacing = {self.spacing:g}, "
                f"integration_s = {self.integration:g}: must be above 0, the spacing below 2 chips"
            )

    def loop(self, density: float) -> tuple[float, float]:
        """Coefficients a, b of the loop's variance ``a d^2 + b d^4``, m^2, at distance d in m.

        `density` is C/N0 times the square of the distance, Hz m^2: free space spreads it so.
        """
        if not self.chip:
            return 0.0, 0.0
        a = self.chip**2 * self.bandwidth * self.spacing / (2.0 * density)
        return a, a * 2.0 / (self.integration * (2.0 - self.spacing) * density)


@dataclass(frozen=True)
class Signal:
    """The table ``[signal]`` of a design: the errors of the ranges that its users measure.

    Attributes
    ----------
    frequency
        Carrier, Hz.
    clock
        The satellites' clocks, or None where `clock_sigma` says all.
    clock_sigma
        How well they are set when the data are made, m; it does not grow.
    update
        Seconds between two sets of broadcast data.
    age
        ``mean``: ages are spread evenly over `update`, and variances are the mean over them;
        ``worst``: the oldest data.
    ephemeris
        Radial, along and cross sigma of the orbits when the data are made, m.
    ephemeris_rate
        Growth of those with age, m/s: ``sigma = ephemeris + rate age``.
    covariance
        Of radial, along, cross and clock when the data are made, m^2, in place of `ephemeris` and
        `clock_sigma`: one matrix for all satellites, or one each. A clock counts positive where
        it makes ranges longer.
    determined
        Whether covariance and growth are those that tracking implies. Without a covariance they
        are still to be worked out: nothing can be said of ranges before.
    common_time
        Error of the constellation's time that all satellites share, m.
    common_orientation
        Error of the frame's orientation that all satellites share, rad about each axis.
    receiver
        The user's.
    ionosphere
        Vertical electron content below the Sun, TECU (1e16 per m^2).
    dual
        Whether two frequencies take the ionosphere out.
    """

    frequency: float = 2.2e9
    clock: Clock | None = None
    clock_sigma: float = 0.0
    update: float = 0.0
    age: Age = "mean"
    ephemeris: RadialAlongCross = (0.0, 0.0, 0.0)
    ephemeris_rate: RadialAlongCross = (0.0, 0.0, 0.0)
    covariance: tuple[Matrix, ...] = ()
    determined: bool = False
    common_time: float = 0.0
    common_orientation: float = 0.0
    receiver: Receiver = field(default_factory=Receiver)
    ionosphere: float = 0.0
    dual: bool = False

    def __post_init__(self) -> None:
        """Refuse negative sigmas, and covariances that are none."""
        if not 0.0 < self.frequency < np.inf:
            raise ArgumentError(f"frequency = {self.frequency:g} Hz: must be above 0")
        if self.age not in ("mean", "worst"):
            raise ArgumentError(f"age = {self.age!r}: allowed mean, worst")
        _check("clock_m", self.clock_sigma)
        _check("update_h", self.update)
        for name in ("ephemeris", "ephemeris_rate"):
            for value in getattr(self, name):
                _check(name, value)
        _check("common_m.time", self.common_time)
        _check("common_m.orientation", self.common_orientation)
        _check("ionosphere_tec", self.ionosphere)
        if self.covariance and (any(self.ephemeris) or self.clock_sigma):
            raise ArgumentError(
                "covariance_m2: says what ephemeris_m and clock_m say too; keep one of them"
            )
        for k, matrix in enumerate(self.covariance, start=1):
            check_covariance(matrix, f"covariance_m2[{k}]")

    def of_satellites(self, count: int) -> np.ndarray:
        """Covariance of radial, along, cross and clock at upload, m^2, shape (count, 4, 4).

        Raises
        ------
        ArgumentError
            Covariances for another number of satellites, or those that are to be determined.
        """
        if self.determined and not self.covariance:
            raise ArgumentError(
                'signal.ephemeris_m = "determined": is still to be worked out; write a design with '
                "its numbers by compass determine DESIGN -o NEW, and give NEW"
            )
        if not self.covariance:
            sigma = np.array([*self.ephemeris, self.clock_sigma], dtype=float)
            return np.broadcast_to(np.diag(sigma**2), (count, 4, 4)).copy()
        given = np.array(self.covariance, dtype=float)
        if len(given) not in (1, count):
            raise ArgumentError(
                f"covariance_m2: {len(given)} matrices for {count} satellites; give one for all, "
                "or one each"
            )
        return np.broadcast_to(given, (count, 4, 4)).copy()


def check_covariance(matrix: Matrix, name: str) -> None:
    """Raise `ArgumentError` unless a matrix is a covariance of four numbers."""
    array = np.array(matrix, dtype=float)
    if array.shape != (4, 4) or not np.all(np.isfinite(array)):
        raise ArgumentError(
            f"{name}: must be 4 by 4 finite numbers: radial, along, cross, clock; m^2"
        )
    scale = np.sqrt(np.maximum(np.diag(array), 0.0))
    slack = 1e-9 * np.outer(scale, scale)
    lowest = np.linalg.eigvalsh(0.5 * (array + array.T)).min()
    if np.any(np.abs(array - array.T) > slack) or lowest < -1e-9 * array.trace():
        raise ArgumentError(
            f"{name}: is no covariance; it must be symmetric, no eigenvalue below 0"
        )


def _check(name: str, value: float) -> None:
    if not 0.0 <= value < np.inf:
        raise ArgumentError(f"{name} = {value:g}: must be 0 or more")

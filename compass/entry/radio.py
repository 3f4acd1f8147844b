"""Radio through the plasma around an entry vehicle: attenuation, brownout, blackout, arrivals."""

from collections.abc import Callable
from dataclasses import dataclass
from math import e as euler
from math import exp, log, log10, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import Constant
from compass.errors import ArgumentError

_CODATA = "CODATA 2018, https://physics.nist.gov/cuu/Constants"
ELECTRON_CHARGE = Constant(1.602176634e-19, "C", 0.0, _CODATA)
ELECTRON_MASS = Constant(9.1093837015e-31, "kg", 2.8e-40, _CODATA)
VACUUM_PERMITTIVITY = Constant(8.8541878128e-12, "F/m", 1.3e-21, _CODATA)
LIGHT_SPEED = Constant(299792458.0, "m/s", 0.0, _CODATA)

_LOU2017 = "Lou et al. 2017, doi 10.1155/2017/4378640"
UHF = Constant(401e6, "Hz", 0.0, f"{_LOU2017}, section 3.1: the relay link of Mars landers")
BROWNOUT_DENSITY = Constant(
    3.08e14, "1/m^3", 5e11, f"{_LOU2017}, section 3.2: 3.08e8 per cm^3, where UHF begins to fade"
)
BLACKOUT_ARRIVAL = Constant(1e-8, "1", 0.0, f"{_LOU2017}, section 5: arrivals inside blackout")

#: Reference density (kg/m^3) and speed (m/s) of the fitted electron densities.
REFERENCE_DENSITY, REFERENCE_SPEED = 1e-4, 5000.0
PER_CM3 = 1e6

Array = NDArray[np.float64]
#: Electrons per m^3 from atmospheric density (kg/m^3) and speed (m/s).
ElectronModel = Callable[[Array, Array], ArrayLike]


def plasma_frequency(electron_density: ArrayLike) -> Array:
    """``f_p = sqrt(q^2 n / (eps0 m_e)) / (2 pi)``, Hz, of electrons per m^3."""
    n = np.asarray(electron_density, dtype=float)
    q, m, eps0 = ELECTRON_CHARGE.value, ELECTRON_MASS.value, VACUUM_PERMITTIVITY.value
    return np.sqrt(q * q * n / (eps0 * m)) / (2 * pi)


def critical_density(frequency: float = UHF.value) -> float:
    """Electrons per m^3 at which the plasma frequency is `frequency` (Hz): blackout above it.

    ``n_c = eps0 m_e (2 pi f)^2 / q^2``
    """
    q, m, eps0 = ELECTRON_CHARGE.value, ELECTRON_MASS.value, VACUUM_PERMITTIVITY.value
    return eps0 * m * (2 * pi * frequency) ** 2 / (q * q)


def published_critical_density(frequency: float = UHF.value) -> float:
    """``(f / 8980)^2``, as Lou et al. 2017 compute it: per **cm^3**, though printed per m^3."""
    return (frequency / 8980.0) ** 2


def attenuation(electron_density: ArrayLike, frequency: float = UHF.value) -> Array:
    """Attenuation in a plasma, dB per metre; zero up to the critical density.

    ``(40 pi log10(e) / wavelength) sqrt((f_p^2 - f^2) / f^2)``

    Parameters
    ----------
    electron_density
        Electrons per m^3, any shape.
    frequency
        Of the link, Hz.
    """
    wavelength = LIGHT_SPEED.value / frequency
    excess = (plasma_frequency(electron_density) / frequency) ** 2 - 1.0
    return 40 * pi * log10(euler) / wavelength * np.sqrt(np.maximum(excess, 0.0))


@dataclass(frozen=True)
class Surrogate:
    """Electron density as a fitted power law, ``n = exp(c0) (rho/1e-4)^a (V/5000)^b`` per cm^3.

    A fit to the crossing times and peaks that Lou et al. 2017 print along their own trajectory,
    not a model of the chemistry: their program is not public. Far from that trajectory use
    a table or a function of your own.
    """

    c0: float
    a: float
    b: float

    def __call__(self, density: ArrayLike, speed: ArrayLike) -> Array:
        """Electrons per m^3 at atmospheric densities (kg/m^3) and speeds (m/s)."""
        rho, v = np.asarray(density, dtype=float), np.asarray(speed, dtype=float)
        power = (rho / REFERENCE_DENSITY) ** self.a * (v / REFERENCE_SPEED) ** self.b
        return PER_CM3 * exp(self.c0) * power


STAGNATION = Surrogate(27.0282958317, 0.9639648310, 9.2323030664)
WAKE = Surrogate(22.5284523533, 0.9698219421, 7.6641503307)


@dataclass(frozen=True)
class ElectronTable:
    """Electron density tabulated over altitude, log-linear between its rows, constant beyond.

    Attributes
    ----------
    altitude
        Metres, increasing.
    electron_density
        Electrons per m^3, positive.
    """

    altitude: tuple[float, ...]
    electron_density: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.altitude) != len(self.electron_density) or len(self.altitude) < 2:
            raise ArgumentError(
                f"electron table: {len(self.altitude)} altitudes and {len(self.electron_density)} "
                "densities; give as many of each, at least two"
            )
        steps = np.diff(self.altitude)
        if not np.all(steps > 0):
            row = int(np.argmax(~(steps > 0))) + 1
            raise ArgumentError(
                f"electron table: altitude {self.altitude[row]:g} m after "
                f"{self.altitude[row - 1]:g} m: altitudes must increase from row to row; sort them"
            )
        for value in self.electron_density:
            if not 0 < value < float("inf"):
                raise ArgumentError(
                    f"electron table: density {value} per m^3: must be positive and finite"
                )

    def at(self, altitude: ArrayLike) -> Array:
        """Electrons per m^3 at altitudes in metres."""
        z = np.asarray(altitude, dtype=float)
        logs = np.interp(z, self.altitude, np.log(self.electron_density))
        return np.exp(logs)


def electron_density(
    model: ElectronModel | ElectronTable, altitude: ArrayLike, density: ArrayLike, speed: ArrayLike
) -> Array:
    """Electrons per m^3 along a trajectory, by any model.

    Parameters
    ----------
    model
        A function of atmospheric density (kg/m^3) and speed (m/s), or a table over altitude.
    altitude, density, speed
        Along the trajectory: m, kg/m^3, m/s; the same shape.

    Raises
    ------
    ArgumentError
        The model gives something that is not a density.
    """
    rho, v = np.asarray(density, dtype=float), np.asarray(speed, dtype=float)
    electrons = model.at(altitude) if isinstance(model, ElectronTable) else model(rho, v)
    n = np.broadcast_to(np.asarray(electrons, dtype=float), rho.shape)
    wrong = ~(np.isfinite(n) & (n >= 0))
    if np.any(wrong):
        raise ArgumentError(
            f"electron density = {n[wrong].flat[0]} per m^3: the model must give finite values, "
            "0 or more"
        )
    return n


def arrival_probability(
    electron_density: ArrayLike,
    brownout: float = BROWNOUT_DENSITY.value,
    blackout: float | None = None,
    in_blackout: float = BLACKOUT_ARRIVAL.value,
) -> Array:
    """Probability that a range measurement gets through the plasma.

    1 up to the brownout density n_b, ``beta0^(u^2)`` with ``u = (n - n_b)/(n_c - n_b)`` in
    brownout, ``beta0`` from the blackout density n_c on: the survival function of a Rayleigh
    distribution of scale ``(n_c - n_b)/sqrt(-2 ln beta0)``. (The distribution function, as Lou et
    al. 2017 print it, would rise with the density.)

    Parameters
    ----------
    electron_density
        Electrons per m^3, any shape.
    brownout, blackout
        n_b and n_c, per m^3; n_c is the critical density of UHF if left out.
    in_blackout
        beta0.

    Raises
    ------
    ArgumentError
        Densities out of order, or a probability outside (0, 1].
    """
    ceiling = critical_density() if blackout is None else blackout
    if not 0 < brownout < ceiling:
        raise ArgumentError(
            f"brownout density {brownout:g}, blackout density {ceiling:g} per m^3: the first must "
            "be positive and below the second"
        )
    if not 0 < in_blackout <= 1:
        raise ArgumentError(
            f"arrival probability in blackout = {in_blackout}: allowed above 0 to 1"
        )
    u = (np.asarray(electron_density, dtype=float) - brownout) / (ceiling - brownout)
    return np.exp(log(in_blackout) * np.clip(u, 0.0, 1.0) ** 2)


def check_probabilities(probability: ArrayLike) -> Array:
    """Return arrival probabilities as an array, each checked to lie in [0, 1]."""
    beta = np.asarray(probability, dtype=float)
    wrong = ~((beta >= 0) & (beta <= 1))
    if np.any(wrong):
        raise ArgumentError(f"arrival probability = {beta[wrong].flat[0]}: allowed 0 to 1")
    return beta


def crossing_times(times: ArrayLike, values: ArrayLike, level: float) -> Array:
    """Find the times (s) at which positive `values` cross a level, log-linear between samples."""
    t, logs = np.asarray(times, dtype=float), np.log(np.asarray(values, dtype=float) / level)
    (at,) = np.nonzero((logs[:-1] < 0) != (logs[1:] < 0))
    share = logs[at] / (logs[at] - logs[at + 1])
    return t[at] + share * (t[at + 1] - t[at])

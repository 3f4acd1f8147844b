"""The budget of one range: what clock, orbit, receiver and ionosphere each add to its error."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.design import Design
from compass.errors import ArgumentError
from compass.links import Radio
from compass.ranging import Signal
from compass.signal.ionosphere import obliquity, zenith_delay
from compass.signal.weights import off_nadir
from compass.words import listed

#: The terms of a budget, in order.
TERMS = ("clock", "orbit", "receiver", "ionosphere")


@dataclass(frozen=True)
class Budget:
    """Range errors at some elevations, m, one sigma, each of shape (elevation,)."""

    elevation: NDArray[np.float64]
    clock: NDArray[np.float64]
    orbit: NDArray[np.float64]
    receiver: NDArray[np.float64]
    ionosphere: NDArray[np.float64]

    @property
    def total(self) -> NDArray[np.float64]:
        """Root of the sum of squares, m; of correlated clock and orbit as if they were not."""
        return np.sqrt(sum(getattr(self, term) ** 2 for term in TERMS))


def mean_age_covariance(signal: Signal, satellites: int) -> NDArray[np.float64]:
    """Covariance of radial, along, cross and clock, m^2, shape (n, 4, 4), as `Signal.age` says.

    With ``sigma = ephemeris + rate age`` the mean over ages up to U is ``e^2 + e q U + q^2 U^2/3``;
    what is given between components does not grow.
    """
    if signal.age == "worst":
        return aged_covariance(signal, satellites, signal.update)
    of_each = signal.of_satellites(satellites)
    u, rate = signal.update, np.array(signal.ephemeris_rate)
    at_first = np.sqrt(np.maximum(np.diagonal(of_each, axis1=1, axis2=2)[:, :3], 0.0))
    growth = at_first * rate * u + rate**2 * u * u / 3.0
    of_each[:, (0, 1, 2), (0, 1, 2)] += growth
    if signal.clock is not None:
        of_each[:, 3, 3] += signal.clock.mean_variance(u)
    return of_each


def aged_covariance(signal: Signal, satellites: int, age: float) -> NDArray[np.float64]:
    """Covariance of radial, along, cross and clock of data `age` seconds old, m^2, (n, 4, 4)."""
    of_each = signal.of_satellites(satellites)
    rate = np.array(signal.ephemeris_rate)
    at_first = np.sqrt(np.maximum(np.diagonal(of_each, axis1=1, axis2=2)[:, :3], 0.0))
    of_each[:, (0, 1, 2), (0, 1, 2)] += 2.0 * at_first * rate * age + (rate * age) ** 2
    if signal.clock is not None:
        of_each[:, 3, 3] += float(signal.clock.variance(age))
    return of_each


def basis(design: Design) -> str:
    """What the errors of a design's ranges stand on, in words: its clocks, its tracking."""
    signal = design.signal
    assert signal is not None
    if signal.clock is not None:
        clocks = f"{signal.clock.title} clocks"
    else:
        clocks = "clocks that are as good as their last setting"
    ages = f", data up to {signal.update / 3600:.3g} h old" if signal.update else ""
    if signal.determined and design.tracking is not None:
        whom = listed(design.tracking.titles)
        return f"{clocks}{ages}, orbits and clocks as tracking by {whom} leaves them"
    given = signal.of_satellites(design.constellation.size).mean(axis=0).diagonal() ** 0.5
    told = ", ".join(f"{sigma:.3g}" for sigma in given)
    return f"{clocks}{ages}, {told} m (radial, along, cross, clock) at upload"


def range_radio(design: Design) -> Radio | None:
    """Link whose C/N0 the receiver's code loop works on; None without a loop.

    Raises
    ------
    ArgumentError
        There is a loop and no link between satellites and stations.
    """
    if design.signal is None or not design.signal.receiver.chip:
        return None
    for radio in design.radios:
        if radio.serves("station", "satellite"):
            return radio
    raise ArgumentError(
        "signal.receiver.chip_m: noise from C/N0 needs the link it is of; add a [[link]] between "
        '["satellite", "station"], or give noise_m'
    )


def receiver_numbers(design: Design) -> tuple[float, float, float, float]:
    """Numbers n, z, a, b of a receiver's noise ``sqrt((n + z/sin el)^2 + a d^2 + b d^4)``, metres.

    Raises
    ------
    ArgumentError
        As `range_radio`.
    """
    assert design.signal is not None
    receiver, radio = design.signal.receiver, range_radio(design)
    density = 1.0
    if radio is not None:
        from compass.contacts.radio import carrier_to_noise  # brings kernels with it

        density = float(10.0 ** (carrier_to_noise(radio, 1.0) / 10.0))
    return (receiver.noise, receiver.zenith, *receiver.loop(density))


def range_budget(
    design: Design, elevation: ArrayLike, *, age: float | None = None, satellite: int = 0
) -> Budget:
    """Errors of a user's range to one satellite by elevation, m, the Sun overhead.

    The user stands on the sphere of the equatorial radius; of along and cross the mean over the
    azimuths from which he may see the satellite.

    Parameters
    ----------
    design
        With a signal.
    elevation
        Radians, shape (e,).
    age
        Of the data, s; the mean over ages, or the oldest, as the design says, if left out.
    satellite
        Which; at its lowest.

    Raises
    ------
    ArgumentError
        As `range_radio`.
    """
    signal, c = design.signal, design.constellation
    assert signal is not None
    radius, r = design.figure.equatorial_radius, float(c.periapsis_radius[satellite])
    e = np.atleast_1d(np.asarray(elevation, dtype=float))
    p = (
        mean_age_covariance(signal, c.size) if age is None else aged_covariance(signal, c.size, age)
    )[satellite]
    eta = np.array([off_nadir(r, radius, one) for one in e])
    orbit = np.cos(eta) ** 2 * p[0, 0] + 0.5 * np.sin(eta) ** 2 * (p[1, 1] + p[2, 2])
    noise, zenith, a, b = receiver_numbers(design)
    d2 = r * r + radius**2 - 2.0 * r * radius * np.cos(np.pi / 2 - e - eta)
    with np.errstate(divide="ignore"):
        slanted = zenith / np.sin(e) if zenith else np.zeros_like(e)
    heard = (noise + slanted) ** 2 + a * d2 + b * d2 * d2
    delay = 0.0 if signal.dual else zenith_delay(signal.ionosphere, signal.frequency)
    return Budget(
        e,
        np.full(e.size, np.sqrt(p[3, 3])),
        np.sqrt(orbit),
        np.sqrt(heard),
        delay * obliquity(e, radius),
    )

"""Guidance to a target, the bank that it flies, and how far entries are from the planned one."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.entry.model import EntryModel
from compass.entry.start import Trigger
from compass.errors import ArgumentError
from compass.frames import direction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Guidance:
    """A predictor-corrector on the size of the bank; see `compass.core.entry.guide`.

    Attributes
    ----------
    latitude, longitude
        Of the target, radians: where deployment is to be.
    least, most
        Limits of the bank's size, radians.
    rate
        Of the bank, rad/s.
    felt
        Drag from which on distance is controlled, m/s^2.
    before
        Bank until then, radians.
    band
        Heading off the target at which the bank changes its side, radians.
    align
        Speed below which only the heading is turned to the target, m/s.
    cycle
        Seconds between decisions.
    """

    latitude: float
    longitude: float
    least: float = np.radians(20.0)
    most: float = np.radians(110.0)
    rate: float = np.radians(20.0)
    felt: float = 0.2 * 9.80665
    before: float = np.radians(60.0)
    band: float = np.radians(3.4)
    align: float = 1000.0
    cycle: float = 2.0

    def __post_init__(self) -> None:
        if not 0 <= self.least < self.most <= np.pi:
            raise ArgumentError(
                f"guidance: bank from {np.degrees(self.least):g} to {np.degrees(self.most):g} deg: "
                "must rise from 0 or more to 180 at most"
            )
        for name in ("rate", "band", "cycle"):
            if not 0 < getattr(self, name) < float("inf"):
                raise ArgumentError(f"guidance: {name} = {getattr(self, name):g}: must be above 0")

    def numbers(self) -> Array:
        """Numbers as the kernels take them, see `compass.core.entry.guide.TARGET`."""
        rest = (self.least, self.most, self.rate, self.felt, self.before, self.band, self.align)
        return np.array([*direction(self.latitude, self.longitude), *rest, self.cycle])


@dataclass(frozen=True)
class Dispersion:
    """How far entries are from the planned one, one sigma.

    Attributes
    ----------
    entries
        How many are flown.
    position, velocity
        Of each Cartesian axis at time 0, m and m/s.
    density, lift
        Of the logarithm of the density, and of L/D.
    """

    entries: int = 200
    position: float = 0.0
    velocity: float = 0.0
    density: float = 0.0
    lift: float = 0.0

    def draws(self, seed: int) -> Array:
        """Offsets of position, velocity, logarithm of the density and L/D, (m, 8)."""
        sigmas = np.repeat([self.position, self.velocity, self.density, self.lift], [3, 3, 1, 1])
        return np.asarray(sigmas * np.random.default_rng(seed).standard_normal((self.entries, 8)))


def guided(
    truth: EntryModel,
    known: EntryModel,
    state: ArrayLike,
    guidance: Guidance,
    trigger: Trigger | None,
    seconds: float,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times (s) and angles (rad) of the bank that guidance flies in the true world.

    Parameters
    ----------
    truth, known
        The world as it is, and as the guidance knows it.
    state
        ``[r, lon, lat, V, gamma, psi]`` at time 0.
    trigger
        Deployment, which ends it; the ground if left out. Afterwards the last bank is held.
    seconds
        When it ends at the latest.
    """
    from compass.core.entry.guide import Until, guided_flight
    from compass.entry.carried import nothing_carried
    from compass.entry.covariance import LONGEST_STEP
    from compass.entry.trajectory import watched_level
    from compass.entry.views import cartesian_of

    watch, level = watched_level(truth, trigger or GROUND)
    p, banks = truth.flight_parameters(), np.empty((int(2 * seconds) + 4, 2))
    until = Until(float(seconds), LONGEST_STEP, watch, level, truth.planet_radius)
    carried, firsts, draws = nothing_carried(1)
    _, rows = guided_flight(
        cartesian_of(np.asarray(state, dtype=float)[:6]), 0.0, truth.vehicle.lift_to_drag, p,
        known.flight_parameters(), guidance.numbers(), until, carried, firsts[0], draws[0], banks,
        np.empty(6), np.empty(7),
    )  # fmt: skip
    kept = banks[:rows]
    changed = np.append(True, np.diff(kept[:, 1]) != 0)
    return tuple(kept[changed, 0].tolist()), tuple(kept[changed, 1].tolist())


def with_bank(model: EntryModel, bank: tuple[tuple[float, ...], tuple[float, ...]]) -> EntryModel:
    """Return the model whose vehicle flies a schedule of times and angles."""
    times, angles = bank
    return replace(model, vehicle=replace(model.vehicle, bank_times=times, bank_angles=angles))


#: Where a flight without deployment ends.
GROUND = Trigger("ground", "altitude", 0.0)

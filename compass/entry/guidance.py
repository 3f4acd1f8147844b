"""Guidance to a target, the bank that it flies, and how far entries are from the planned one."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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


def guided_banks(
    truth: EntryModel,
    known: EntryModel,
    starts: Array,
    worlds: Array,
    guidance: Guidance,
    targets: Array,
    trigger: Trigger | None,
    seconds: float,
    *,
    threads: int | None = None,
) -> tuple[Array, Array, Array]:
    """Banks that guidance flies in many entries, where they come, and what is beyond reach.

    Guidance knows its state as it is, and of the world what it feels of drag.

    Parameters
    ----------
    truth, known
        The world as it is but for `worlds`, and as the guidance knows it.
    starts, worlds
        States at time 0, (m, 6), Mars-fixed, and what is added to the logarithm of the density and
        to L/D of each, (m, 2).
    guidance, targets
        How they are guided, and unit vectors to where, (m, 3).
    trigger
        Deployment, which ends it; the ground if left out. Afterwards the last bank is held.
    seconds
        When it ends at the latest.
    threads
        Threads; one a processor if left out. The banks do not depend on them.

    Returns
    -------
    banks, ends, beyond
        Times (s) and angles (rad), (m, k, 2), of which the last row holds from its time on, and
        rows at infinite times fill what is left; states at deployment, (m, 6); and how far targets
        are beyond reach, m, (m,), as `compass.entry.dispersed.Dispersed` has it.
    """
    from compass.entry.carried import nothing_carried
    from compass.entry.dispersed import flown_to

    numbers = np.tile(guidance.numbers(), (len(starts), 1))
    numbers[:, :3] = targets
    flown = flown_to(
        truth, known, starts, worlds, numbers, trigger, seconds, nothing_carried(len(starts)),
        rows=int(2 * seconds) + 4, threads=threads,
    )  # fmt: skip
    kept = flown.banks[:, : flown.rows.max()].copy()
    kept[np.arange(kept.shape[1]) >= flown.rows[:, None]] = [np.inf, 0.0]
    return kept, flown.ends, flown.told[:, 7] * truth.planet_radius


def with_bank(model: EntryModel, bank: Array) -> EntryModel:
    """Return the model whose vehicle flies a bank, (k, 2): one of `guided_banks`."""
    times, angles = bank[np.isfinite(bank[:, 0])].T.tolist()
    vehicle = replace(model.vehicle, bank_times=tuple(times), bank_angles=tuple(angles))
    return replace(model, vehicle=vehicle)


#: Where a flight without deployment ends.
GROUND = Trigger("ground", "altitude", 0.0)

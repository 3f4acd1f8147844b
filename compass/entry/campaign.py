"""A campaign: one lander's entry flown to many sites, along many azimuths, at many moments."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.allowed import check_all_allowed
from compass.core.entry.dop853 import watched
from compass.core.entry.many import Ending, Flights, Worlds, fly_many
from compass.entry.arrivals import Arrivals, draw_arrivals
from compass.entry.covariance import LONGEST_STEP
from compass.entry.ground import Ground
from compass.entry.guidance import Dispersion, Guidance, guided_banks
from compass.entry.model import EntryModel
from compass.entry.radio import (
    WAKE,
    ElectronModel,
    ElectronTable,
    arrival_probability,
    electron_density,
)
from compass.entry.start import Trigger
from compass.entry.trajectory import watched_level
from compass.entry.views import along_cross_down, cartesian_of
from compass.errors import ArgumentError
from compass.frames import direction, latitude_longitude
from compass.words import place_words

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Campaign:
    """Many entries, flown; a constellation is judged by what it tells on them.

    Attributes
    ----------
    model
        The world.
    arrivals
        The m entries that were flown.
    times
        Seconds after entry, shape (t,), evenly spaced from 0.
    paths, gains, stops, banks
        As in `compass.core.entry.many.fly_many`; `stops` are the epochs of deployment.
    spreads
        Square roots S of each entry's prior covariance of position, velocity, density and lift,
        (m, 8, d): d is 6, and one more for each of density and L/D that is uncertain.
    worlds
        What the logarithm of the density and L/D are more than those of the model, (m, 2).
    targets, misses, beyond
        Of guided entries: unit vectors to where, (m, 3), how far from there over the ground each
        deploys, m, (m,), and how far beyond reach that is (see
        `compass.entry.dispersed.Dispersed`), m, (m,); without rows if they are not guided.
    arrival_probability
        Of a radio signal through the plasma, (m, t).
    deployment
        What ends an entry, in words.
    again
        Flies the same lander from other arrivals, or to other goals.
    ground
        Where the entries come down; None anywhere.
    goals
        Where each is to come down; None anywhere.
    """

    model: EntryModel
    arrivals: Arrivals
    times: Array
    paths: Array
    gains: Array
    stops: NDArray[np.int64]
    banks: Array
    spreads: Array
    worlds: Array
    targets: Array
    misses: Array
    beyond: Array
    arrival_probability: Array
    deployment: str
    again: Callable[[Arrivals], "Campaign"] = field(repr=False)
    ground: Ground | None = None
    goals: Arrivals | None = None

    def __post_init__(self) -> None:
        for part in (*vars(self).values(), *vars(self.arrivals).values()):
            if isinstance(part, np.ndarray):
                part.setflags(write=False)  # it is kept, and shared by all who ask for it

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.stops.size)

    @property
    def longest(self) -> int:
        """Epochs of the longest entry, its deployment's with them."""
        return int(self.stops.max(initial=0)) + 1

    @property
    def unknown_names(self) -> list[str]:
        """What is not known beside the first state, one a component of u behind its six."""
        density, lift = np.abs(self.spreads[0, 6:, 6:]).sum(axis=1)
        return [name for name, size in (("density", density), ("L/D", lift)) if size > 0]

    def first(self, count: int) -> "Campaign":
        """Return the first `count` entries alone."""
        part = slice(0, count)
        arrays: dict[str, Any] = {
            name: values[part]
            for name, values in vars(self).items()
            if isinstance(values, np.ndarray) and name != "times"
        }
        goals = None if self.goals is None else self.goals.part(part)
        return replace(self, arrivals=self.arrivals.part(part), goals=goals, **arrays)

    @property
    def asked(self) -> Arrivals:
        """What was asked for: goals, or without these arrivals."""
        return self.arrivals if self.goals is None else self.goals

    def at(self, phase: Array) -> "Campaign":
        """Return the same flights at other moments."""
        goals = None if self.goals is None else replace(self.goals, phase=phase)
        return replace(self, arrivals=replace(self.arrivals, phase=phase), goals=goals)

    def drawn(self, seed: int) -> "Campaign":
        """Fly as many entries of another seed."""
        draw = draw_arrivals if self.ground is None else self.ground.draw
        return self.again(draw(self.size, seed))

    @property
    def paths_to_stops(self) -> Array:
        """Position and velocity, (m, t, 6), past deployment those there."""
        return _held(self.paths, self.stops)

    def turns(self, state: ArrayLike) -> Array:
        """Rotations (m, 3, 3) that move an entry from state ``[r, lon, lat, ...]`` to each."""
        return _turns(state, self.paths[:, 0])

    @property
    def deployment_place(self) -> tuple[Array, Array]:
        """Latitude and east longitude in (-pi, pi] at deployment, radians, shape (m,)."""
        return latitude_longitude(self.paths[np.arange(self.size), self.stops, :3])


def fly_campaign(
    model: EntryModel,
    state: ArrayLike,
    covariance0: ArrayLike,
    times: ArrayLike,
    arrivals: Arrivals,
    *,
    trigger: Trigger | None = None,
    electrons: ElectronModel | ElectronTable | None = WAKE,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    dispersion: Dispersion | None = None,
    guidance: Guidance | None = None,
    seed: int = 0,
) -> Campaign:
    """Move an entry to every site and azimuth of `arrivals`, and fly it there.

    Each is integrated by itself, by the steps of the filters (see `compass.core.entry.flow`): on a
    rotating planet no two are alike. The prior covariance is that of the scenario in the
    vehicle's own axes (along track, across, down), and moves with it, over a pole as anywhere.

    Parameters
    ----------
    model
        The world.
    state
        ``[r, lon, lat, V, gamma, psi]`` of the entry; radius, speed and flight-path angle are
        kept everywhere.
    covariance0
        Of the first position and velocity, (6, 6), SI, Mars-fixed.
    times
        Seconds, evenly spaced from 0, shape (t,).
    arrivals
        Sites, azimuths and moments.
    trigger
        Deployment: the first epoch at or below its level; the last of `times` if left out.
    electrons
        Plasma around the vehicle; None for none. By default that in the wake, which signals from
        above cross to the back of the vehicle.
    density_sigma, lift_sigma
        Relative uncertainty of the air's density (a sigma of ``ln rho0``) and of L/D, constant
        through an entry and estimated with the state; 0 for known.
    dispersion, seed
        How far each entry is from the one that is moved, in the vehicle's axes, and the seed of
        what is drawn; all alike if left out.
    guidance
        Of the bank of every entry, to a target that is moved as the entry is; it knows the true
        state. The bank of the vehicle if left out.

    Raises
    ------
    ArgumentError
        Times not evenly spaced from 0, an entry that comes to the ground before deployment or
        to no deployment at all, or a negative sigma.
    """
    check_sigmas(density_sigma, lift_sigma)
    given, seconds = np.asarray(state, dtype=float)[:6], np.asarray(times, dtype=float)
    if seconds.size < 2 or seconds[0] != 0 or not np.allclose(np.diff(seconds), seconds[1]):
        raise ArgumentError("times: must be evenly spaced from 0, at least two")
    size = arrivals.phase.size
    planned = starts = moved_starts(given, arrivals)
    parameters = np.diag([density_sigma, lift_sigma * model.vehicle.lift_to_drag])
    uncertain = parameters.any(axis=0)
    spreads = np.zeros((size, 8, 6 + int(uncertain.sum())))
    spreads[:, :6, :6] = _moved_spreads(
        cartesian_of(given), np.asarray(covariance0, dtype=float), starts
    )
    spreads[:, 6:, 6:] = parameters[:, uncertain]
    watch, level = (-1, 0.0) if trigger is None else watched_level(model, trigger)
    deployment = _deployment(trigger, float(seconds[-1]))
    worlds = np.zeros((size, 2))
    if dispersion is not None:
        drawn = replace(dispersion, entries=size).draws(seed)
        turned = np.swapaxes(vehicle_axes(starts), -1, -2)
        starts, worlds = starts + (turned @ drawn[:, :6, None])[..., 0], drawn[:, 6:].copy()
    p = model.flight_parameters()
    if guidance is None:
        banks = np.repeat(model.vehicle.bank_schedule()[None], size, axis=0)
        targets, misses, beyond = np.empty((0, 3)), np.empty(0), np.empty(0)
    else:
        targets, end = moved_targets(given, guidance, planned), float(seconds[-1])
        banks, ends, beyond = guided_banks(
            model, model, starts, worlds, guidance, targets, trigger, end
        )
        misses = _apart(ends[:, :3], targets)
    paths = np.zeros((size, seconds.size, 6))
    gains = np.zeros((*paths.shape, spreads.shape[2]))
    stops = np.empty(size, dtype=np.int64)
    fly_many(
        starts,
        Worlds(worlds, spreads, banks),
        p,
        seconds,
        LONGEST_STEP,
        Ending(watch, level, model.planet_radius),
        Flights(paths, gains, stops),
    )
    _check_flights(arrivals, paths, stops, seconds, watch, level, p, deployment)
    flown = int(stops.max()) + 1
    paths = paths[:, :flown]
    if electrons is None:
        probability = np.ones(paths.shape[:2])
    else:
        whole = _held(paths, stops)
        radius = np.linalg.norm(whole[..., :3], axis=2)
        density = model.atmosphere.density(radius.ravel()).reshape(radius.shape)
        speed = np.linalg.norm(whole[..., 3:], axis=2)
        n = electron_density(electrons, radius - model.planet_radius, density, speed)
        probability = arrival_probability(n)
    return Campaign(
        model,
        arrivals,
        seconds[:flown],
        paths,
        gains[:, :flown],
        stops,
        banks,
        spreads,
        worlds,
        targets,
        misses,
        beyond,
        probability,
        deployment,
        partial(
            fly_campaign,
            model,
            state,
            covariance0,
            times,
            trigger=trigger,
            electrons=electrons,
            density_sigma=density_sigma,
            lift_sigma=lift_sigma,
            dispersion=dispersion,
            guidance=guidance,
            seed=seed,
        ),
    )


def _apart(at: Array, targets: Array) -> Array:
    """How far places (m, 3) are from unit vectors to targets, over the ground, m, (m,)."""
    radius = np.linalg.norm(at, axis=1)
    chord = np.linalg.norm(at / radius[:, None] - targets, axis=1)
    return np.asarray(2.0 * radius * np.arcsin(0.5 * chord))


def moved_starts(state: ArrayLike, arrivals: Arrivals) -> Array:
    """State ``[r, lon, lat, V, gamma, psi]`` moved to arrivals: position and velocity, (m, 6)."""
    starts = np.tile(np.asarray(state, dtype=float)[:6], (arrivals.phase.size, 1))
    starts[:, 1], starts[:, 2] = arrivals.longitude, arrivals.latitude
    starts[:, 5] = arrivals.azimuth
    return cartesian_of(starts)


def moved_targets(state: ArrayLike, guidance: Guidance, starts: Array) -> Array:
    """Unit vectors (m, 3) to a target that lies about each start as it does about a state."""
    target = direction(guidance.latitude, guidance.longitude)
    return np.asarray(_turns(state, starts) @ target)


def _turns(state: ArrayLike, starts: Array) -> Array:
    """Rotations (m, 3, 3) that move an entry from state ``[r, lon, lat, ...]`` to each start."""
    own = along_cross_down(cartesian_of(np.asarray(state, dtype=float)[:6]))
    return np.asarray(np.swapaxes(along_cross_down(starts), 1, 2) @ own)


def check_sigmas(density_sigma: float, lift_sigma: float) -> None:
    """Refuse relative uncertainties of the air's density and of L/D that are none.

    Raises
    ------
    ArgumentError
        One is negative, or more than a linear model can bear.
    """
    check_all_allowed(density_sigma=density_sigma, lift_sigma=lift_sigma)


def _held(paths: Array, stops: NDArray[np.int64]) -> Array:
    """Paths (m, t, 6) whose empty rows past the stops are filled with the states there."""
    past = np.arange(paths.shape[1]) > stops[:, None]
    last = paths[np.arange(stops.size), stops][:, None]
    return np.where(past[..., None], last, paths)


def vehicle_axes(path: ArrayLike) -> Array:
    """Rotation (..., 6, 6) of position and velocity errors to along track, across and down."""
    axes = along_cross_down(path)
    both = np.zeros((*axes.shape[:-2], 6, 6))
    both[..., :3, :3] = both[..., 3:, 3:] = axes
    return both


def _moved_spreads(first: Array, covariance: Array, starts: Array) -> Array:
    """Square roots of the prior at every start, the same in the vehicle's axes everywhere."""
    own = vehicle_axes(first)
    there = own @ covariance @ own.T
    scale = np.sqrt(np.diag(there))
    root = scale[:, None] * np.linalg.cholesky(there / np.outer(scale, scale))
    return np.asarray(np.swapaxes(vehicle_axes(starts), -1, -2) @ root, dtype=np.float64)


def _deployment(trigger: Trigger | None, end: float) -> str:
    """Deployment in words."""
    if trigger is None:
        return f"{end:g} s after entry"
    if trigger.quantity == "altitude":
        return f"{trigger.name}: altitude {trigger.level / 1e3:g} km"
    if trigger.quantity == "speed":
        return f"{trigger.name}: speed {trigger.level:g} m/s"
    return f"{trigger.name}: Mach {trigger.level:g}"


def _check_flights(
    arrivals: Arrivals,
    paths: Array,
    stops: NDArray[np.int64],
    times: Array,
    watch: int,
    level: float,
    p: Array,
    deployment: str,
) -> None:
    """Refuse flights that do not come to deployment."""
    late = np.zeros(stops.size, dtype=bool)
    if watch >= 0 and isfinite(level):
        last = paths[np.arange(stops.size), stops]
        late = np.array([not watched(state, watch, p) <= level for state in last])
    failed = (stops < 0) | late
    if not failed.any():
        return
    k = int(np.argmax(failed))
    lat, lon, azimuth = (
        float(np.degrees(part[k]))
        for part in (arrivals.latitude, arrivals.longitude, arrivals.azimuth)
    )
    what = (
        f"comes to the ground (or to a standstill) at {times[-1 - stops[k]]:g} s, before"
        if stops[k] < 0
        else f"has not come by {times[-1]:g} s to"
    )
    raise ArgumentError(
        f"entry at {place_words(lat, lon, '.2f')}, azimuth {azimuth:.2f} deg: "
        f"{what} deployment ({deployment}); choose a deployment that every entry reaches, or "
        "change entry.duration_s"
    )

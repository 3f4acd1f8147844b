"""A campaign: one lander's entry flown to many sites, along many azimuths, at many moments."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry_geometry import cartesian_jacobian
from compass.core.judging import fly_many
from compass.entry.arrivals import Arrivals
from compass.entry.model import EntryModel
from compass.entry.radio import (
    WAKE,
    ElectronModel,
    ElectronTable,
    arrival_probability,
    electron_density,
)
from compass.entry.trajectory import Trigger
from compass.errors import ArgumentError
from compass.frames import east_north_up, latitude_longitude

Array = NDArray[np.float64]

#: Entries whose ground track comes nearer to a pole than this (radians) are left out: longitude
#: and azimuth are singular there. They are 1e-3 of all (8 of 8192 of designs/landing.toml).
POLAR_GAP = np.radians(1.0)

#: Largest relative uncertainty of density and of L/D, as of the density's bias in a scenario.
MOST_SIGMA = 10.0


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
    states, paths, gains, stops
        As in `compass.core.judging.fly_many`; `stops` are the epochs of deployment.
    spreads
        Square roots S of each entry's prior covariance of the eight states, (m, 8, d): d is 6, and
        one more for each of density and L/D that is uncertain.
    arrival_probability
        Of a radio signal through the plasma, (m, t).
    deployment
        What ends an entry, in words.
    left_out
        How many arrivals were left out because they come too close to a pole.
    again
        Flies the same lander from other arrivals.
    """

    model: EntryModel
    arrivals: Arrivals
    times: Array
    states: Array
    paths: Array
    gains: Array
    stops: NDArray[np.int64]
    spreads: Array
    arrival_probability: Array
    deployment: str
    left_out: int
    again: Callable[[Arrivals], "Campaign"] = field(repr=False)

    def __post_init__(self) -> None:
        for part in (*vars(self).values(), *vars(self.arrivals).values()):
            if isinstance(part, np.ndarray):
                part.setflags(write=False)  # it is kept, and shared by all who ask for it

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.stops.size)

    def first(self, count: int) -> "Campaign":
        """Return the first `count` entries alone."""
        part = slice(0, count)
        return replace(
            self,
            arrivals=Arrivals(*(values[part] for values in vars(self.arrivals).values())),
            states=self.states[part],
            paths=self.paths[part],
            gains=self.gains[part],
            stops=self.stops[part],
            spreads=self.spreads[part],
            arrival_probability=self.arrival_probability[part],
        )

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
) -> Campaign:
    """Move an entry to every site and azimuth of `arrivals`, and fly it there.

    Each is integrated by itself, one Runge-Kutta step a time step as the filters do: on a
    rotating planet no two are alike. The prior covariance is that of the scenario in the
    vehicle's own axes (up, along track, across), and moves with it.

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

    Raises
    ------
    ArgumentError
        Times not evenly spaced from 0, an entry that comes to the ground before deployment or
        to no deployment at all, no entry left, or a negative sigma.
    """
    check_sigmas(density_sigma, lift_sigma)
    given, seconds = np.asarray(state, dtype=float)[:6], np.asarray(times, dtype=float)
    if seconds.size < 2 or seconds[0] != 0 or not np.allclose(np.diff(seconds), seconds[1]):
        raise ArgumentError("times: must be evenly spaced from 0, at least two")
    size = arrivals.phase.size
    starts = np.tile(model.full_state(given), (size, 1))
    starts[:, 1], starts[:, 2] = arrivals.longitude, arrivals.latitude
    starts[:, 5] = arrivals.azimuth
    parameters = np.diag([density_sigma, lift_sigma * model.vehicle.lift_to_drag])
    uncertain = parameters.any(axis=0)
    spreads = np.zeros((size, 8, 6 + int(uncertain.sum())))
    spreads[:, :6, :6] = _moved_spreads(given, np.asarray(covariance0, dtype=float), starts)
    spreads[:, 6:, 6:] = parameters[:, uncertain]
    watch, level, deployment = _deployment(model, trigger, float(seconds[-1]))
    states = np.full((size, seconds.size, 8), np.nan)
    paths = np.zeros((size, seconds.size, 6))
    gains = np.zeros((*paths.shape, spreads.shape[2]))
    stops = np.empty(size, dtype=np.int64)
    fly_many(
        starts,
        spreads,
        model.parameters(),
        model.vehicle.bank(seconds),
        float(seconds[1]),
        watch,
        level,
        model.planet_radius,
        states,
        paths,
        gains,
        stops,
    )
    kept = ~_polar(states[..., 2])
    if not kept.any():
        raise ArgumentError("arrivals: every one comes within 1 degree of a pole; move them")
    _check_flights(starts[kept], states[kept], stops[kept], seconds, watch, level, deployment)
    chosen = Arrivals(*(part[kept] for part in vars(arrivals).values()))
    flown = int(stops[kept].max()) + 1
    states = states[kept, :flown]
    if electrons is None:
        probability = np.ones(states.shape[:2])
    else:
        ratio = model.atmosphere.density(states[..., 0].ravel()).reshape(states.shape[:2])
        n = electron_density(
            electrons,
            np.nan_to_num(states[..., 0] - model.planet_radius),
            np.nan_to_num(ratio),
            np.nan_to_num(states[..., 3]),
        )
        probability = arrival_probability(n)
    return Campaign(
        model,
        chosen,
        seconds[:flown],
        states,
        paths[kept, :flown],
        gains[kept, :flown],
        stops[kept],
        spreads[kept],
        probability,
        deployment,
        int(size - kept.sum()),
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
        ),
    )


def check_sigmas(density_sigma: float, lift_sigma: float) -> None:
    """Refuse relative uncertainties of the air's density and of L/D that are none.

    Raises
    ------
    ArgumentError
        One is negative, or more than a linear model can bear.
    """
    for name, sigma in (("density_sigma", density_sigma), ("lift_sigma", lift_sigma)):
        if not 0 <= sigma <= MOST_SIGMA:
            raise ArgumentError(f"{name} = {sigma:g}: allowed 0 to {MOST_SIGMA:g}")


def _polar(latitude: Array) -> NDArray[np.bool_]:
    """Which flights, (m, t), come within `POLAR_GAP` of a pole."""
    return np.asarray((np.abs(latitude) > np.pi / 2 - POLAR_GAP).any(axis=1))


def vehicle_axes(states: ArrayLike) -> Array:
    """Rotation (..., 6, 6) of position and velocity errors to up, along track and across."""
    x = np.asarray(states, dtype=float)
    east, north, up = np.moveaxis(east_north_up(x[..., 2], x[..., 1]), -2, 0)
    psi = x[..., 5, None]
    along = np.cos(psi) * north + np.sin(psi) * east
    axes = np.stack([up, along, np.cross(up, along)], axis=-2)
    both = np.zeros((*axes.shape[:-2], 6, 6))
    both[..., :3, :3] = both[..., 3:, 3:] = axes
    return both


def _moved_spreads(state: Array, covariance: Array, starts: Array) -> Array:
    """Square roots of the prior at every start, the same in the vehicle's axes everywhere."""
    jacobians = np.empty((len(starts), 6, 6))
    for k, start in enumerate(starts):
        cartesian_jacobian(start, jacobians[k])
    own = vehicle_axes(state)
    there = own @ covariance @ own.T
    scale = np.sqrt(np.diag(there))
    root = scale[:, None] * np.linalg.cholesky(there / np.outer(scale, scale))
    return np.linalg.solve(jacobians, np.swapaxes(vehicle_axes(starts), -1, -2) @ root)


def _deployment(model: EntryModel, trigger: Trigger | None, end: float) -> tuple[int, float, str]:
    """Index and level of the state to watch, and deployment in words."""
    if trigger is None:
        return -1, 0.0, f"{end:g} s after entry"
    if trigger.quantity == "altitude":
        level = model.planet_radius + trigger.level
        return 0, level, f"{trigger.name}: altitude {trigger.level / 1e3:g} km"
    if trigger.quantity == "speed":
        return 3, trigger.level, f"{trigger.name}: speed {trigger.level:g} m/s"
    level = trigger.level * model.atmosphere.speed_of_sound
    return 3, level, f"{trigger.name}: Mach {trigger.level:g}"


def _check_flights(
    starts: Array,
    states: Array,
    stops: NDArray[np.int64],
    times: Array,
    watch: int,
    level: float,
    deployment: str,
) -> None:
    """Refuse flights that do not come to deployment."""
    late = np.zeros(stops.size, dtype=bool)
    if watch >= 0 and isfinite(level):
        late = ~(states[np.arange(stops.size), stops, watch] <= level)
    failed = (stops < 0) | late
    if not failed.any():
        return
    k = int(np.argmax(failed))
    lat, lon, azimuth = np.degrees(starts[k, [2, 1, 5]])
    what = (
        f"comes to the ground (or to a standstill) at {times[-1 - stops[k]]:g} s, before"
        if stops[k] < 0
        else f"has not come by {times[-1]:g} s to"
    )
    raise ArgumentError(
        f"entry at latitude {lat:.2f}, longitude {lon:.2f} deg, azimuth {azimuth:.2f} deg: {what} "
        f"deployment ({deployment}); choose a deployment that every entry reaches, or change "
        "entry.duration_s"
    )

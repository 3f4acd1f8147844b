"""An entry of Lou et al.: who flies where, past which beacons, and what is measured."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.papers.lou_montecarlo import World
from compass.core.papers.spherical import STATES, rk4_step
from compass.entry.beacons import Beacons
from compass.entry.faults import Fault, fault_tables
from compass.entry.inertial import check_distinct
from compass.entry.model import EntryModel
from compass.entry.radio import (
    WAKE,
    ElectronModel,
    ElectronTable,
    arrival_probability,
    check_probabilities,
    electron_density,
)
from compass.entry.schedule import in_view
from compass.errors import ArgumentError
from compass.orbits import states_mci
from compass.orbits.states import from_states
from compass.papers.spherical import spherical_parameters

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Imu:
    """Accelerometers along the drag, side and lift axes: ``a~ = a + b + noise``.

    Attributes
    ----------
    sigma
        Standard deviation of the white noise of one sample, m/s^2, one for each axis.
    bias
        Constant bias b, m/s^2, one for each axis.
    """

    sigma: tuple[float, float, float] = (1e-3, 1e-3, 1e-3)
    bias: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for sigma in self.sigma:
            if not (isfinite(sigma) and sigma >= 0):
                raise ArgumentError(f"imu: sigma = {sigma} m/s^2: must be 0 or more, and finite")
        for bias in self.bias:
            if not isfinite(bias):
                raise ArgumentError(f"imu: bias = {bias} m/s^2: must be a finite number")


@dataclass(frozen=True)
class NavigationCase:
    """The truth of an entry with its measurements, at epochs 0 to K a step apart.

    Attributes
    ----------
    name
        What to call it.
    truth
        The true world.
    start
        True ``[r, lon, lat, V, gamma, psi]`` at epoch 0, shape (6,), SI, psi from north.
    beacons
        The m beacons, at epochs 0 to K.
    range_sigma
        Standard deviations of the ranges, metres, shape (m,).
    imu
        The accelerometers.
    process_noise
        Variances added to the true state in one step, shape (8,), in the state's units squared
        (density as ln rho0). Needed wherever the consistency of a filter is judged.
    arrival
        Probability that a range gets through the plasma, shape (K+1, m) or (K+1, 1); 1 if None.
    """

    name: str
    truth: EntryModel
    start: Array
    beacons: Beacons
    range_sigma: Array
    imu: Imu = field(default_factory=Imu)
    process_noise: Array = field(default_factory=lambda: np.zeros(STATES))
    arrival: Array | None = None

    def __post_init__(self) -> None:
        m, times = self.beacons.size, self.beacons.times
        steps = np.diff(times)
        if times.size < 2 or steps[0] <= 0 or not np.allclose(steps, steps[0], rtol=1e-9):
            raise ArgumentError(
                "beacons: their times must be evenly spaced epochs, at least two; the filters step "
                "from one to the next"
            )
        if np.shape(self.range_sigma) != (m,) or not np.all(np.asarray(self.range_sigma) > 0):
            shown = np.asarray(self.range_sigma).tolist()
            raise ArgumentError(f"range_sigma = {shown} m: give one positive value a beacon")
        if not np.all(np.asarray(self.process_noise) >= 0):
            raise ArgumentError("process_noise: every variance must be 0 or more")
        check_distinct(self.beacons)
        if self.arrival is not None:
            check_probabilities(self.arrival)

    @property
    def times(self) -> Array:
        """Epochs, s, shape (K+1,)."""
        return self.beacons.times

    @property
    def step(self) -> float:
        """Seconds between epochs."""
        return float(self.times[1] - self.times[0])

    @cached_property
    def nominal(self) -> Array:
        """True states without process noise, one Runge-Kutta step an epoch, shape (K+1, 8).

        Raises
        ------
        ArgumentError
            The flight cannot be continued (it says when), for instance at rest or vertical.
        """
        states = np.empty((self.times.size, STATES))
        states[0] = self.truth.full_state(self.start)
        banks = self.truth.vehicle.bank(self.times)
        for k in range(1, len(states)):
            rk4_step(
                states[k - 1], spherical_parameters(self.truth, banks[k - 1]), self.step, states[k]
            )
            if not np.all(np.isfinite(states[k])) or states[k, 0] < self.truth.planet_radius:
                raise ArgumentError(
                    f"{self.name}: the flight ends at {self.times[k]:g} s, before the last epoch "
                    f"at {self.times[-1]:g} s; shorten the duration"
                )
        return states

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """Whether the line of sight to each beacon clears the planet, shape (K+1, m)."""
        return in_view(self.beacons, self.nominal, self.truth.planet_radius)

    @cached_property
    def density(self) -> Array:
        """Atmospheric density along the flight, kg/m^3, shape (K+1,)."""
        return self.truth.atmosphere.density(self.nominal[:, 0])

    def electrons(self, model: ElectronModel | ElectronTable = WAKE) -> Array:
        """Electrons per m^3 along the flight, shape (K+1,), by a model of `compass.entry.radio`."""
        altitude = self.nominal[:, 0] - self.truth.planet_radius
        return electron_density(model, altitude, self.density, self.nominal[:, 3])

    def through_plasma(self, model: ElectronModel | ElectronTable = WAKE) -> "NavigationCase":
        """Return the case with ranges that arrive as the plasma of a model lets them."""
        return replace(self, arrival=arrival_probability(self.electrons(model))[:, None])

    def world(self, faults: Sequence[Fault] = (), see_through: bool = False) -> World:
        """Return the truth as the kernels take it.

        Parameters
        ----------
        faults
            What goes wrong.
        see_through
            Let ranges pass through the planet, as sources do that do not check the line of sight.
        """
        tables = fault_tables(faults, self.times, self.beacons.names)
        arrival = np.ones(self.visible.shape) if self.arrival is None else self.arrival
        open_path = np.ones(self.visible.shape, dtype=bool) if see_through else self.visible
        open_path = open_path & ~tables.lost
        return World(
            x0=self.truth.full_state(self.start),
            p=spherical_parameters(self.truth),
            bank=self.truth.vehicle.bank(self.times),
            noise=np.sqrt(np.asarray(self.process_noise, dtype=float)),
            bias=np.array(self.imu.bias, dtype=float),
            acc_sigma=np.array(self.imu.sigma, dtype=float),
            range_sigma=np.asarray(self.range_sigma, dtype=float),
            beacons=np.ascontiguousarray(self.beacons.r),
            arrival=np.ascontiguousarray(np.where(open_path, arrival, 0.0)),
            offset=tables.offset,
            alive=tables.alive,
        )


def beacons_from_states(
    names: Sequence[str], r0: ArrayLike, v0: ArrayLike, times: Array, gm: float
) -> Beacons:
    """Beacons from state vectors at time 0 in axes that do not turn; those at rest stay.

    The others move as two bodies do, whatever their periapsis (sources print orbits that dip
    under the surface).

    Parameters
    ----------
    names
        One a beacon.
    r0, v0
        Metres and m/s, shape (m, 3); a velocity of zero marks a beacon at rest.
    times
        Epochs, s, shape (K+1,).
    gm
        Gravitational parameter, m^3/s^2.
    """
    start, speed = np.asarray(r0, dtype=float), np.asarray(v0, dtype=float)
    moving = np.any(speed != 0.0, axis=1)
    r = np.tile(start, (times.size, 1, 1))
    v = np.tile(speed, (times.size, 1, 1))
    if moving.any():
        paths = states_mci(from_states(start[moving], speed[moving], gm=gm), times)
        r[:, moving], v[:, moving] = (np.moveaxis(path, 0, 1) for path in paths)
    return Beacons(tuple(names), times, r, v, moving)

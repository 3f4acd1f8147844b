"""A navigation case: who flies where, past which beacons, and what is measured."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry_dynamics import STATES, rk4_step
from compass.core.montecarlo import World
from compass.entry.faults import Fault, fault_tables
from compass.entry.imu import Imu
from compass.entry.model import EntryModel
from compass.entry.radio import (
    WAKE,
    ElectronModel,
    ElectronTable,
    arrival_probability,
    check_probabilities,
    electron_density,
)
from compass.errors import ArgumentError

Array = NDArray[np.float64]

#: Two beacons nearer than this are one: their ranges tell the same.
SAME_PLACE = 1.0


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
    beacon_names
        One name a beacon.
    beacons
        Their positions in the axes of the state, metres, shape (K+1, m, 3).
    range_sigma
        Standard deviations of the ranges, metres, shape (m,).
    imu
        The accelerometers.
    process_noise
        Variances added to the true state in one step, shape (8,), in the state's units squared
        (density as ln rho0). Needed wherever the consistency of a filter is judged.
    step
        Seconds.
    arrival
        Probability that a range gets through the plasma, shape (K+1, m) or (K+1, 1); 1 if None.
    """

    name: str
    truth: EntryModel
    start: Array
    beacon_names: tuple[str, ...]
    beacons: Array
    range_sigma: Array
    imu: Imu = field(default_factory=Imu)
    process_noise: Array = field(default_factory=lambda: np.zeros(STATES))
    step: float = 1.0
    arrival: Array | None = None

    def __post_init__(self) -> None:
        m = len(self.beacon_names)
        if self.beacons.ndim != 3 or self.beacons.shape[1:] != (m, 3) or len(self.beacons) < 2:
            raise ArgumentError(
                f"beacons: positions of shape {self.beacons.shape} for {m} names; the shape must be "
                f"(epochs, {m}, 3) with at least two epochs"
            )
        if np.shape(self.range_sigma) != (m,) or not np.all(np.asarray(self.range_sigma) > 0):
            raise ArgumentError(
                f"range_sigma = {np.asarray(self.range_sigma).tolist()} m: give one positive value a beacon"
            )
        if not (np.isfinite(self.step) and self.step > 0):
            raise ArgumentError(f"step = {self.step} s: must be positive")
        if not np.all(np.asarray(self.process_noise) >= 0):
            raise ArgumentError("process_noise: every variance must be 0 or more")
        for i in range(m):
            for j in range(i):
                apart = np.linalg.norm(self.beacons[:, i] - self.beacons[:, j], axis=-1)
                if apart.min() < SAME_PLACE:
                    raise ArgumentError(
                        f"beacons {self.beacon_names[j]} and {self.beacon_names[i]}: at one place "
                        f"(within {apart.min():.3g} m at {self.step * apart.argmin():g} s); move or "
                        "remove one"
                    )
        if self.arrival is not None:
            check_probabilities(self.arrival)

    @property
    def times(self) -> Array:
        """Epochs, s, shape (K+1,)."""
        return self.step * np.arange(len(self.beacons))

    @cached_property
    def nominal(self) -> Array:
        """True states without process noise, one Runge-Kutta step an epoch, shape (K+1, 8).

        Raises
        ------
        ArgumentError
            The flight cannot be continued (it says when), for instance at rest or vertical.
        """
        states = np.empty((len(self.beacons), STATES))
        states[0] = self.truth.full_state(self.start)
        banks = self.truth.vehicle.bank(self.times)
        for k in range(1, len(states)):
            rk4_step(states[k - 1], self.truth.parameters(banks[k - 1]), self.step, states[k])
            if not np.all(np.isfinite(states[k])) or states[k, 0] < self.truth.planet_radius:
                raise ArgumentError(
                    f"{self.name}: the flight ends at {self.times[k]:g} s, before the last epoch at "
                    f"{self.times[-1]:g} s; shorten the duration"
                )
        return states

    @cached_property
    def positions(self) -> Array:
        """True positions without process noise, metres, shape (K+1, 3)."""
        r, lon, lat = self.nominal[:, 0], self.nominal[:, 1], self.nominal[:, 2]
        unit = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
        return (r * np.array(unit)).T

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """Whether the line of sight to each beacon clears the planet, shape (K+1, m)."""
        lander = self.positions[:, None, :]
        sight = self.beacons - lander
        along = -(lander * sight).sum(axis=-1) / (sight * sight).sum(axis=-1)
        nearest = lander + np.clip(along, 0.0, 1.0)[..., None] * sight
        return np.linalg.norm(nearest, axis=-1) >= self.truth.planet_radius

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
        from dataclasses import replace

        return replace(self, arrival=arrival_probability(self.electrons(model))[:, None])

    def visibility_report(self) -> tuple[str, ...]:
        """Return what is to be said about beacons that are hidden for part or all of the entry."""
        seen = self.visible.sum(axis=0)
        total = len(self.beacons)
        lines = [
            f"beacon {name}: in line of sight at {count} of {total} epochs"
            for name, count in zip(self.beacon_names, seen, strict=True)
            if count < total
        ]
        if total and not seen.any():
            lines.append("no beacon is ever in line of sight: only the accelerometers measure")
        return tuple(lines)

    def world(self, faults: Sequence[Fault] = (), see_through: bool = False) -> World:
        """Return the truth as the kernels take it.

        Parameters
        ----------
        faults
            What goes wrong.
        see_through
            Let ranges pass through the planet, as sources do that do not check the line of sight.
        """
        tables = fault_tables(faults, self.times, self.beacon_names)
        arrival = np.ones(self.visible.shape) if self.arrival is None else self.arrival
        open_path = ~tables.lost if see_through else self.visible & ~tables.lost
        return World(
            x0=self.truth.full_state(self.start),
            p=self.truth.parameters(),
            bank=self.truth.vehicle.bank(self.times),
            noise=np.sqrt(np.asarray(self.process_noise, dtype=float)),
            bias=np.array(self.imu.bias, dtype=float),
            acc_sigma=np.array(self.imu.sigma, dtype=float),
            range_sigma=np.asarray(self.range_sigma, dtype=float),
            beacons=np.ascontiguousarray(self.beacons),
            arrival=np.ascontiguousarray(np.where(open_path, arrival, 0.0)),
            offset=tables.offset,
            alive=tables.alive,
        )


def two_body_positions(r0: ArrayLike, v0: ArrayLike, times: Array, gm: float) -> Array:
    """Positions (K+1, 3), metres, of an unpowered orbiter from its state at time 0.

    Integrated by SciPy's DOP853 to 1e-13 relative: any conic, whatever its periapsis.
    """
    from scipy.integrate import solve_ivp

    def derivative(_: float, y: Array) -> Array:
        return np.concatenate([y[3:], -gm * y[:3] / np.linalg.norm(y[:3]) ** 3])

    start = np.concatenate([np.asarray(r0, dtype=float), np.asarray(v0, dtype=float)])
    solution = solve_ivp(
        derivative,
        (times[0], times[-1]),
        start,
        method="DOP853",
        t_eval=times,
        rtol=1e-13,
        atol=1e-6,
    )
    return np.asarray(solution.y[:3].T)

"""An entry with accelerometers and beacons: what is true, what is measured, what goes wrong."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.fused_runs import Truth
from compass.core.entry.groups import Problem
from compass.core.entry.kinds import ACCELERATION, ECHO, RANGE
from compass.core.entry.measure import AXES
from compass.entry.beacons import Beacons
from compass.entry.covariance import longest_step, problem_of
from compass.entry.faults import Fault, fault_tables
from compass.entry.layout import Layout
from compass.entry.model import EntryModel
from compass.entry.radio import (
    WAKE,
    ElectronModel,
    ElectronTable,
    arrival_probability,
    check_probabilities,
    electron_density,
)
from compass.entry.schedule import Measurements, in_view
from compass.entry.trajectory import Trajectory
from compass.errors import ArgumentError

Array = NDArray[np.float64]

#: Two beacons nearer than this are one: their ranges tell the same.
SAME_PLACE = 1.0


@dataclass(frozen=True)
class InertialCase:
    """A true flight past beacons, with accelerometers.

    Attributes
    ----------
    name
        What to call it.
    flight
        The true flight, at the epochs of the beacons.
    beacons
        The m beacons.
    measurements
        What is measured beside accelerations, how well and when.
    sigma
        Of one-way ranges (m) and range rates (m/s) of each beacon, shape (m, 2); nan for none.
    imu_sigma, imu_bias
        White noise of one sample and constant bias of the accelerometers along the velocity, to
        the side and across it, m/s^2, shape (3,).
    noise
        Process noise of the truth, variance per second of the six spherical numbers, then of the
        logarithm of the density and L/D, shape (8,).
    arrival
        Probability that a signal gets through the plasma, (t, m) or (t, 1); 1 if None.
    """

    name: str
    flight: Trajectory
    beacons: Beacons
    measurements: Measurements
    sigma: Array
    imu_sigma: Array
    imu_bias: Array
    noise: Array
    arrival: Array | None = None

    def __post_init__(self) -> None:
        if self.flight.times.size < self.beacons.times.size:
            raise ArgumentError(
                f"{self.flight.ending}, before the last epoch at {self.beacons.times[-1]:g} s; "
                "shorten entry.duration_s, or if the flight is not the one meant look at "
                "entry.radius_km, speed_m_s and flight_path_deg, and at planet.radius_km"
            )
        check_distinct(self.beacons)
        if self.arrival is not None:
            check_probabilities(self.arrival)

    @property
    def times(self) -> Array:
        """Epochs, s, shape (t,)."""
        return self.beacons.times

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """Whether each beacon is in view, shape (t, m); see `compass.entry.schedule.in_view`."""
        return in_view(self.beacons, self.flight.states, self.flight.model.planet_radius)

    def electrons(self, model: ElectronModel | ElectronTable = WAKE) -> Array:
        """Electrons per m^3 along the flight, shape (t,), by a model of `compass.entry.radio`."""
        density = self.flight.model.atmosphere.density(self.flight.states[:, 0])
        return electron_density(model, self.flight.altitude, density, self.flight.speed)

    def through_plasma(self, model: ElectronModel | ElectronTable = WAKE) -> "InertialCase":
        """Return the case with signals that arrive as the plasma of a model lets them."""
        return replace(self, arrival=arrival_probability(self.electrons(model))[:, None])

    def visibility_report(self) -> tuple[str, ...]:
        """Return what is to be said about beacons that are hidden for part or all of the entry."""
        seen, total = self.visible.sum(axis=0), self.times.size
        lines = [
            f"beacon {name}: in line of sight at {count} of {total} epochs"
            for name, count in zip(self.beacons.names, seen, strict=True)
            if count < total
        ]
        if not seen.any():
            lines.append("no beacon is ever in line of sight: only the accelerometers measure")
        return tuple(lines)

    @property
    def instruments(self) -> tuple[str, ...]:
        """Names of what is measured beside accelerations and beacons, one a source."""
        measured = self.measurements
        return (*measured.features.names, "own readings") if measured.instruments else ()

    def heard(
        self, taken: NDArray[np.bool_], felt: Array
    ) -> tuple[Array, Array, NDArray[np.int64]]:
        """Sources, variances and kinds along the flight, of the beacons `taken`, (t, m).

        As `compass.entry.schedule.Measurements.heard` gives them, and at every epoch, of the last
        source, the lander itself, accelerations with variances `felt`, (3,).
        """
        path = np.ascontiguousarray(self.flight.path)
        sources, variances, kinds = self.measurements.heard(
            self.beacons, taken, path, self.flight.model, sigmas=self.sigma
        )
        own = 0 if self.measurements.instruments else 1
        sources = np.pad(sources, ((0, 0), (0, own), (0, 0)))
        wide = ((0, 0), (0, own), (0, AXES))
        variances = np.pad(variances, wide, constant_values=np.nan)
        variances[:, -1, -AXES:] = felt
        return sources, variances, np.append(kinds, ACCELERATION + np.arange(AXES))

    def problem(
        self,
        model: EntryModel,
        layout: Layout,
        heard: tuple[Array, Array, NDArray[np.int64]],
        noise: Array,
    ) -> Problem:
        """Return the case as the kernels take it, in a world, with states and process noise.

        `noise` is as that of a `compass.entry.fused.FusedFilter`.
        """
        path = np.ascontiguousarray(self.flight.path)
        longest = longest_step(self.measurements)
        problem = problem_of(model, layout, path, self.times, heard, noise[:6], longest)
        problem.walk[1:, 6 : noise.size] = np.diff(self.times)[:, None] * noise[6:]
        return problem

    def truth(
        self, layout: Layout, offset: Array, faults: Sequence[Fault] = (), see_through: bool = False
    ) -> Truth:
        """Return the truth as the kernels take it.

        Parameters
        ----------
        layout
            States of the filters.
        offset
            What the truth is more than the filters' count of each, (t, s).
        faults
            What goes wrong.
        see_through
            Let signals pass through the planet, as sources do that do not check the line of sight.
        """
        tables = fault_tables(faults, self.times, self.beacons.names)
        epochs, m = self.visible.shape
        seen = np.ones_like(self.visible) if see_through else self.visible
        taken = self.measurements.taken(seen, self.times) & ~tables.lost
        heard = self.heard(taken, np.square(self.imu_sigma))
        error = np.zeros(heard[1].shape)
        error[:, :m, np.isin(heard[2], (RANGE, ECHO))] = tables.offset[..., None]
        error[:, -1, -AXES:] = self.imu_bias
        arrival = np.ones((1, 1)) if self.arrival is None else self.arrival
        shaken = self.noise[: 8 if layout.place("air") >= 0 else 6]
        return Truth(
            np.ascontiguousarray(self.flight.path),
            self.problem(self.flight.model, layout, heard, shaken),
            offset,
            error,
            np.array(np.broadcast_to(arrival, (epochs, m))),
            tables.alive,
        )


def check_distinct(beacons: Beacons) -> None:
    """Refuse beacons at one place, whose ranges tell the same.

    Raises
    ------
    ArgumentError
        Two beacons that come within a metre of each other.
    """
    for i in range(beacons.size):
        for j in range(i):
            apart = np.linalg.norm(beacons.r[:, i] - beacons.r[:, j], axis=-1)
            if apart.min() < SAME_PLACE:
                raise ArgumentError(
                    f"beacons {beacons.names[j]} and {beacons.names[i]}: at one place (within "
                    f"{apart.min():.3g} m at {beacons.times[apart.argmin()]:g} s); move or remove "
                    "one"
                )

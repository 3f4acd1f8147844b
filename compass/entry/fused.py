"""Fused filters: which there are, and what one is set to.

Their kernels are in `compass.core.entry.fuse`.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.groups import Arrangement, Problem
from compass.core.entry.weights import DETERMINANT, EQUAL, FAST, TRACE
from compass.entry.filters import root
from compass.entry.fused_kinds import KINDS_OF_FILTER, Algorithm, Kind, Weighting
from compass.entry.inertial import InertialCase
from compass.entry.layout import Layout, Part
from compass.entry.model import EntryModel
from compass.errors import ArgumentError

Array = NDArray[np.float64]

_WEIGHTINGS = {"determinant": DETERMINANT, "trace": TRACE, "fast": FAST, "equal": EQUAL}


#: States that may be estimated, position and velocity along the true flight, with their units.
STATE_NAMES = (
    "along track",
    "cross track",
    "down",
    "velocity along",
    "velocity across",
    "velocity down",
    "ln density",
    "L/D",
    "drag bias",
    "side bias",
    "lift bias",
    "clock",
    "clock drift",
)
STATE_UNITS = (*["m"] * 3, *["m/s"] * 3, "1", "1", *["m/s^2"] * 3, "m", "m/s")

#: Size of each state in which information is weighed (u of the fast rule).
SCALE = np.array([*[1e3] * 3, *[10.0] * 3, 0.1, 0.02, *[1e-2] * 3, 1e3, 1.0])

#: Places in these of the clock's states.
CLOCK = 11


@dataclass(frozen=True)
class FusedFilter:
    """A fused filter with everything it assumes.

    Attributes
    ----------
    algorithm
        One of `KINDS_OF_FILTER`.
    model
        The world it assumes.
    first
        First estimate of position and velocity, (6,), Mars-fixed.
    covariance0
        Its covariance, (6, 6).
    further
        Variances of the first estimates of the other states, (0,), (2,): logarithm of the density
        and L/D, or (5,): and accelerometer biases.
    noise
        Process noise variance per second of the six spherical numbers, then of the other states
        but for the clock's, which has none.
    clock
        One sigma of the receiver's clock (m) and of its drift (m/s), whose first error is drawn in
        every run and estimated; empty for one that agrees with the beacons'.
    imu_variance
        R of the accelerometers, (m/s^2)^2, shape (3,).
    random_start
        Draw the first estimate of each run from its covariance, instead of taking it as it is.
    known_to
        For filters of six states: sigma of the error in each run of the logarithm of the density
        and of L/D, which the filter takes as known.
    weighting
        Rule of the fusion weights; None takes the algorithm's usual one.
    scaled
        Weigh information in sizes of states rather than SI.
    weight_floor
        Smallest weight that a covariance is divided by.
    gate_sigma, gate_start
        Innovations larger than this many of their own sigma are refused, from so many seconds on:
        a filter that starts far off claims too much after its first linear update, and a gate
        would then refuse what could mend it.
    """

    algorithm: Algorithm
    model: EntryModel
    first: Array
    covariance0: Array
    further: Array
    noise: Array
    imu_variance: Array
    random_start: bool = False
    known_to: tuple[float, float] = (0.0, 0.0)
    weighting: Weighting | None = None
    scaled: bool = True
    weight_floor: float = 1e-3
    gate_sigma: float = inf
    gate_start: float = 0.0
    clock: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.further.size not in (0, 2, 5):
            raise ArgumentError(
                f"process_noise_si: {self.noise.size} values; give 6 (motion), 8 (and ln rho0, "
                "L/D) or 11 (and accelerometer biases)"
            )
        try:
            root(self.covariance0)
        except np.linalg.LinAlgError as error:
            raise ArgumentError(
                "p0_si: not positive definite; every variance must be positive, "
                "and longitude and heading defined"
            ) from error
        if self.further.size and any(self.known_to):
            raise ArgumentError(
                f"known_to = {list(self.known_to)}: this filter estimates ln rho0 and L/D; say how "
                "well they are known in p0_si"
            )

    @property
    def kind(self) -> Kind:
        """What the algorithm does."""
        return KINDS_OF_FILTER[self.algorithm]

    @property
    def states(self) -> int:
        """Number of states that are estimated."""
        return 6 + self.further.size + len(self.clock)

    @property
    def numbers(self) -> list[int]:
        """Which of `STATE_NAMES` they are."""
        known = 6 + self.further.size
        return [*range(known), *range(CLOCK, CLOCK + len(self.clock))]

    @property
    def layout(self) -> Layout:
        """Where the states stand."""
        sigma = tuple(np.sqrt(self.further).tolist())
        parts = (
            ("air", sigma[:1]),
            ("lift", sigma[1:2]),
            ("imu", sigma[2:]),
            ("clock", self.clock),
        )
        return Layout(tuple(Part(name, s) for name, s in parts if s))

    @property
    def covariance(self) -> Array:
        """Covariance of the whole first estimate, (s, s)."""
        return self.layout.covariance(self.covariance0)

    @property
    def chosen_weighting(self) -> Weighting:
        """The rule of the weights."""
        return self.weighting or self.kind.weighting

    def arrangement(self) -> Arrangement:
        """Who hears what, as the kernels take it."""
        kind = self.kind
        return Arrangement(
            kind.apart,
            kind.feedback,
            kind.divided,
            kind.fading,
            _WEIGHTINGS[self.chosen_weighting],
            self.weight_floor,
            SCALE[self.numbers] if self.scaled else np.ones(self.states),
            kind.iterations,
            float(self.gate_sigma**2),
            float(self.gate_start),
        )

    def problem(self, case: InertialCase) -> Problem:
        """The world and the measurements as the filter knows them, as if all beacons were heard."""
        heard = case.heard(np.ones_like(case.visible), self.imu_variance)
        one_way = heard[1][:, : case.beacons.size, :2]
        one_way[:] = np.where(np.isnan(one_way), np.square(case.sigma), one_way)
        return case.problem(self.model, self.layout, heard, self.noise)

    def offset(self, case: InertialCase) -> Array:
        """What the truth is more than the filter's count of each state, (t, s).

        Of the density times ``C_D S / m``, which act as their product, its logarithm over what
        the filter knows, along the flight; of L/D the difference; and the accelerometers' biases.
        """
        true, radius = case.flight.model, case.flight.states[:, 0]
        out = np.zeros((case.times.size, self.states))
        if self.further.size:
            # logarithms, for far out both densities are too small for a number
            air = true.atmosphere.log_density(radius) - self.model.atmosphere.log_density(radius)
            drag = true.vehicle.drag_area_per_mass / self.model.vehicle.drag_area_per_mass
            out[:, 6] = air + np.log(drag)
            out[:, 7] = true.vehicle.lift_to_drag - self.model.vehicle.lift_to_drag
        if self.further.size > 2:
            out[:, 8:11] = case.imu_bias
        return out

    def starts(self, normals: Array) -> Array:
        """First estimate of each run, (runs, s), from normal numbers (runs, >= s)."""
        out = np.zeros((len(normals), self.states))
        out[:, :6] = self.first
        own = self.numbers
        if self.random_start:
            out += normals[:, own] @ root(self.covariance).T
        elif self.clock:
            out[:, -2:] = normals[:, own[-2:]] * np.array(self.clock)
        return out

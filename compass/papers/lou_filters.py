"""The filters of Lou et al. 2017 and 2019: which there are, and what they are set to.

The algorithms themselves are in `compass.core.papers.lou_steps`.
"""

from dataclasses import dataclass, replace
from math import exp, inf, isfinite
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry import weights as rules
from compass.core.papers import lou_steps as steps
from compass.core.papers.lou_common import Settings
from compass.core.papers.lou_montecarlo import Belief
from compass.entry.model import EntryModel
from compass.errors import ArgumentError
from compass.papers.spherical import spherical_parameters

Array = NDArray[np.float64]
Algorithm = Literal[
    "ekf", "iterated", "information", "intermittent", "ci", "ci-feedback", "dcifaif", "federated"
]
Weighting = Literal["determinant", "trace", "fast", "equal"]

_STEPS = {
    "ekf": steps.EKF,
    "iterated": steps.ITERATED,
    "information": steps.INFORMATION,
    "intermittent": steps.INFORMATION,
    "ci": steps.CI,
    "ci-feedback": steps.CI_FEEDBACK,
    "dcifaif": steps.DCIFAIF,
    "federated": steps.FEDERATED,
}
_WEIGHTINGS = {
    "determinant": rules.DETERMINANT,
    "trace": rules.TRACE,
    "fast": rules.FAST,
    "equal": rules.EQUAL,
}
#: How the sources weigh: determinant for covariance intersection, eq. 21 for DCIFAIF.
_USUAL = {"ci": "determinant", "ci-feedback": "determinant", "dcifaif": "fast"}

STATE_NAMES = (
    "radius",
    "longitude",
    "latitude",
    "speed",
    "flight-path angle",
    "azimuth",
    "ln rho0",
    "L/D",
    "drag bias",
    "side bias",
    "lift bias",
)
STATE_UNITS = ("m", "rad", "rad", "m/s", "rad", "rad", "1", "1", "m/s^2", "m/s^2", "m/s^2")

#: Size of each state in which information is weighed (u of the fast rule).
SCALE = np.array([1e3, 3e-4, 3e-4, 10.0, 3e-3, 3e-3, 0.1, 0.02, 1e-2, 1e-2, 1e-2])


@dataclass(frozen=True)
class FilterSettings:
    """A filter with everything it assumes.

    Attributes
    ----------
    algorithm
        ``ekf``, ``iterated``; ``information`` (takes every range as arrived: a lost one reads
        0), ``intermittent`` (skips what did not arrive); ``ci``, ``ci-feedback``, ``dcifaif``,
        ``federated`` (one subsystem of IMU and range for each beacon).
    model
        The world it assumes.
    start
        Estimate at epoch 0, shape (6,), (8,) or (11,): state, then ln rho0 and L/D (those of
        `model` if left out), then accelerometer biases (0 if left out).
    p0
        Covariance of the start, shape (n,) or (n, n), in the filter's own states.
    process_noise
        Variances of one step, shape (n,).
    acceleration_variance
        R of the accelerometers, (m/s^2)^2, shape (3,).
    range_variance
        R of the ranges, m^2, shape (m,).
    random_start
        Draw the start of each run from `p0` about `start`, instead of taking `start` itself.
    parameter_sigma
        For filters of six states: sigma of the error in each run of the ln rho0 and the L/D
        that the filter takes as known.
    published_linear_density
        Carry rho0 itself as the seventh state, as the papers print it (P0 = 1e-2 then means
        0.1 kg/m^3, 500 times the density).
    weighting
        Rule of the fusion weights; None takes the algorithm's usual one.
    scale
        Size of each state, shape (n,), in which information is weighed; None for SI, where the
        fast rule hardly tells subsystems apart.
    weight_floor
        Smallest weight that a covariance is divided by.
    gate_sigma
        Innovations larger than this many of their own sigma are refused.
    gate_start
        Seconds from which on the gate is shut. A filter that starts far off claims too much after
        its first linear update; a gate would then refuse what could mend it.
    iterations
        Most relinearisations of ``iterated``.
    """

    algorithm: Algorithm
    model: EntryModel
    start: ArrayLike
    p0: ArrayLike
    process_noise: ArrayLike
    acceleration_variance: ArrayLike
    range_variance: ArrayLike
    random_start: bool = False
    parameter_sigma: tuple[float, float] = (0.0, 0.0)
    published_linear_density: bool = False
    weighting: Weighting | None = None
    scale: ArrayLike | None = None
    weight_floor: float = 1e-3
    gate_sigma: float = inf
    gate_start: float = 0.0
    iterations: int = 5

    def __post_init__(self) -> None:
        if self.algorithm not in get_args(Algorithm):
            allowed = ", ".join(get_args(Algorithm))
            raise ArgumentError(f"algorithm = {self.algorithm!r}: allowed {allowed}")
        if self.weighting is not None and self.weighting not in get_args(Weighting):
            allowed = ", ".join(get_args(Weighting))
            raise ArgumentError(f"weighting = {self.weighting!r}: allowed {allowed}")
        n = self.states
        if n not in (6, 8, 11):
            raise ArgumentError(
                f"process_noise: {n} values; give 6 (motion), 8 (and ln rho0, L/D) or 11 (and "
                "accelerometer biases)"
            )
        size = np.size(self.start)
        if size not in (6, 8, 11) or size > max(n, 8) or not np.all(np.isfinite(self.start)):
            raise ArgumentError(
                f"start = {np.asarray(self.start).tolist()}: give 6, 8 or 11 finite numbers, no "
                f"more than the filter's {n} states"
            )
        _check_covariance(self.covariance, n)
        noise = np.asarray(self.process_noise, dtype=float)
        if not np.all((noise >= 0) & np.isfinite(noise)):
            raise ArgumentError("process_noise: every variance must be 0 or more, and finite")
        for name, shape in (("acceleration_variance", 3), ("range_variance", None)):
            values = np.asarray(getattr(self, name), dtype=float)
            if shape is not None and values.shape != (shape,):
                raise ArgumentError(f"{name}: {values.size} values; give {shape}")
            if not np.all((values > 0) & np.isfinite(values)):
                raise ArgumentError(f"{name}: every variance must be positive and finite")
        if self.scale is not None and (
            np.shape(self.scale) != (n,) or not np.all(np.asarray(self.scale) > 0)
        ):
            raise ArgumentError(f"scale: give {n} positive sizes, one a state")
        if not 0 < self.weight_floor < 1:
            raise ArgumentError(
                f"weight_floor = {self.weight_floor}: allowed above 0 to below 1; a weight of 0 "
                "would divide the covariance by zero"
            )
        if not self.gate_sigma > 0:
            raise ArgumentError(f"gate_sigma = {self.gate_sigma}: must be positive")
        if self.states > 6 and any(self.parameter_sigma):
            raise ArgumentError(
                f"parameter_sigma = {self.parameter_sigma}: this filter estimates ln rho0 and L/D; "
                "say how well they are known in p0"
            )
        if self.iterations < 1:
            raise ArgumentError(f"iterations = {self.iterations}: must be at least 1")

    @property
    def states(self) -> int:
        """Number of states n the filter estimates."""
        return np.size(self.process_noise)

    @property
    def covariance(self) -> Array:
        """Covariance of the start, shape (n, n)."""
        p0 = np.asarray(self.p0, dtype=float)
        return np.diag(p0) if p0.ndim == 1 else p0

    @property
    def full_start(self) -> Array:
        """The start in the filter's own states, shape (8,) or (11,)."""
        given = np.asarray(self.start, dtype=float)
        full = np.zeros(max(self.states, 8))
        full[:8] = self.model.full_state(given)
        full[: given.size] = given
        if self.published_linear_density:
            full[6] = exp(full[6])
        return full

    @property
    def chosen_weighting(self) -> str:
        """The weighting, or the algorithm's usual one."""
        return self.weighting or _USUAL.get(self.algorithm, "equal")

    def changed(self, **values: object) -> "FilterSettings":
        """Return the settings with some values changed."""
        return replace(self, **values)  # type: ignore[arg-type]

    def _spread(self) -> Array:
        """Factor by which standard normal numbers become the error of a start."""
        n, spread = self.states, np.zeros((max(self.states, 8), max(self.states, 8)))
        if self.random_start:
            spread[:n, :n] = np.linalg.cholesky(self.covariance)
        if n == 6:
            spread[6, 6], spread[7, 7] = self.parameter_sigma
        return spread

    def kernel_arguments(self, step: float) -> tuple[int, Settings, Belief]:
        """Return algorithm number, settings and belief as the kernels take them."""
        n = self.states
        scale = np.ones(n) if self.scale is None else np.asarray(self.scale, dtype=float)
        settings = Settings(
            states=n,
            linear=self.published_linear_density,
            dt=float(step),
            q=np.asarray(self.process_noise, dtype=float),
            r_acc=np.asarray(self.acceleration_variance, dtype=float),
            r_range=np.asarray(self.range_variance, dtype=float),
            scale=scale,
            gate=self.gate_sigma**2,
            gate_start=float(self.gate_start),
            weighting=_WEIGHTINGS[self.chosen_weighting],
            floor=self.weight_floor,
            iterations=self.iterations,
        )
        p0 = self.covariance
        belief = Belief(
            x0=self.full_start,
            p0=p0,
            spread=self._spread(),
            p=spherical_parameters(self.model),
            lost_is_zero=self.algorithm == "information",
        )
        return _STEPS[self.algorithm], settings, belief


def divergence_message(settings: FilterSettings, time: float, x: Array) -> str:
    """Say when a filter diverged and where it stood one epoch before."""
    shown = ", ".join(
        f"{name} {value:.6g} {unit}"
        for name, value, unit in zip(STATE_NAMES[:6], x[:6], STATE_UNITS[:6], strict=True)
    )
    return f"{settings.algorithm}: diverged at {time:g} s; one epoch before: {shown}"


def _check_covariance(p0: Array, n: int) -> None:
    """Raise `ArgumentError` unless a matrix is a covariance of n states, positive definite."""
    if p0.shape != (n, n):
        raise ArgumentError(f"p0: shape {p0.shape}; give {n} variances or {n} by {n} numbers")
    if not np.all(np.isfinite(p0)) or np.any(np.abs(p0 - p0.T) > 1e-12 * np.abs(p0).max()):
        raise ArgumentError("p0: must be finite and symmetric")
    variances = np.diag(p0)
    if not np.all(variances > 0):
        where = STATE_NAMES[int(np.argmax(~(variances > 0)))]
        raise ArgumentError(
            f"p0: variance of {where} = {variances[~(variances > 0)][0]:g}: not positive definite; "
            "every variance must be positive"
        )
    sigma = np.sqrt(variances)
    smallest = float(np.linalg.eigvalsh(p0 / np.outer(sigma, sigma))[0])
    if not (isfinite(smallest) and smallest > 1e-14):
        raise ArgumentError(
            f"p0: not positive definite (smallest eigenvalue of the correlations {smallest:.2g}); "
            "reduce the correlations"
        )

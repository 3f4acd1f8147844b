"""The filter of Yu et al. 2018 as the chapter runs it: on its six spherical states.

One Runge-Kutta step an epoch moves truth and filter alike. It is singular at the poles; landings
are navigated by `compass.entry.navigation`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.papers.spherical_geometry import cartesian_jacobian
from compass.core.papers.yu2018_filter import (
    Course,
    Draws,
    Sights,
    Start,
    monte_carlo,
    posterior_bound,
    spread,
)
from compass.cores import in_blocks
from compass.entry.beacons import Beacons
from compass.entry.model import EntryModel
from compass.entry.navigation import FilterRuns
from compass.entry.schedule import Measurements
from compass.errors import ArgumentError
from compass.papers.spherical import spherical_parameters

#: Runs handed to a thread at once.
BLOCK = 20


@dataclass(frozen=True)
class Filter:
    """An extended Kalman filter on ``[r, lon, lat, V, gamma, psi]``.

    Attributes
    ----------
    covariance0
        Covariance of the first estimate, (6, 6), SI.
    noise
        Process noise variance per second of the six states, (6,).
    iterations
        Passes of each update: 1 is the plain filter, more the iterated one.
    """

    covariance0: NDArray[np.float64]
    noise: NDArray[np.float64]
    iterations: int = 1

    def __post_init__(self) -> None:
        if self.iterations < 1:
            raise ArgumentError(f"iterations = {self.iterations}: must be at least 1")
        if np.any(~(np.asarray(self.noise) >= 0)):
            raise ArgumentError("process noise: every variance must be 0 or more")
        try:
            np.linalg.cholesky(self.covariance0)
        except np.linalg.LinAlgError as error:
            raise ArgumentError(
                "initial covariance: not positive definite; every sigma must be above 0"
            ) from error


def run_monte_carlo(
    model: EntryModel,
    state: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike,
    measurements: Measurements,
    settings: Filter,
    *,
    runs: int = 500,
    seed: int = 0,
    truth: EntryModel | None = None,
    threads: int | None = None,
) -> FilterRuns:
    """Fly the truth and filter it `runs` times with independent errors and noise.

    The first estimate is drawn about the true first state with the filter's own covariance.
    Each run has its own stream of ``numpy.random.SeedSequence(seed)``, so the numbers do not
    depend on the number of threads, and more runs begin with the same ones.

    Parameters
    ----------
    model
        The world as the filter knows it.
    state
        True first state, (6,) or (8,).
    beacons, taken, measurements
        What is measured, `taken` of shape (t, n).
    settings
        The filter.
    runs, seed
        How many, and from which seed.
    truth
        The world as it is; `model` if left out.
    threads
        Threads; one a processor if left out.
    """
    if runs < 1:
        raise ArgumentError(f"runs = {runs}: must be at least 1")
    count, n = beacons.times.size, beacons.size
    world = truth or model
    covariance0 = np.array(settings.covariance0, dtype=float)
    scale = np.sqrt(np.diag(covariance0))
    root = scale[:, None] * np.linalg.cholesky(covariance0 / np.outer(scale, scale))
    errors, nees = np.empty((runs, count, 6)), np.empty((runs, count))
    sigmas = np.empty((runs, count, 2))
    streams = np.random.SeedSequence(seed).spawn(runs)
    start = Start(model.full_state(state), covariance0, root)
    course, sights = _course(model, beacons, settings.noise), _sights(beacons, taken, measurements)

    def work(part: slice) -> None:
        size = 6 + count * (2 * n + 6)
        drawn = np.stack([np.random.default_rng(s).standard_normal(size) for s in streams[part]])
        monte_carlo(
            world.full_state(state),
            spherical_parameters(world),
            start,
            course,
            sights,
            settings.iterations,
            Draws(
                drawn[:, :6],
                drawn[:, 6 : 6 + 2 * count * n].reshape(len(drawn), count, n, 2),
                drawn[:, 6 + 2 * count * n :].reshape(len(drawn), count, 6),
            ),
            errors[part],
            nees[part],
            sigmas[part],
        )

    in_blocks(work, runs, BLOCK, threads)
    finite: NDArray[np.bool_] = np.asarray(np.isfinite(errors).all(axis=(1, 2)))
    return FilterRuns(errors, nees, sigmas, ~finite)


@dataclass(frozen=True)
class Bound:
    """Cramer-Rao bound along a trajectory.

    Attributes
    ----------
    covariance
        Of the six states after each epoch's measurements, shape (t, 6, 6), SI.
    position_sigma, velocity_sigma
        Root of the trace of the Cartesian position (m) and velocity (m/s) covariance, (t,).
    """

    covariance: NDArray[np.float64]
    position_sigma: NDArray[np.float64]
    velocity_sigma: NDArray[np.float64]


def initial_covariance(
    state: ArrayLike, position_sigma: float, velocity_sigma: float
) -> NDArray[np.float64]:
    """Covariance (6, 6) of the states for one sigma per Cartesian axis of position and velocity.

    Parameters
    ----------
    state
        Where, shape (>= 6,).
    position_sigma, velocity_sigma
        Metres and metres a second.
    """
    for name, sigma in (("position_sigma", position_sigma), ("velocity_sigma", velocity_sigma)):
        if not 0 < sigma < float("inf"):
            raise ArgumentError(f"{name} = {sigma}: must be positive")
    jacobian = np.empty((6, 6))
    cartesian_jacobian(np.asarray(state, dtype=float), jacobian)
    inverse = np.linalg.inv(jacobian)
    variances = np.repeat([position_sigma**2, velocity_sigma**2], 3)
    covariance = (inverse * variances) @ inverse.T
    return 0.5 * (covariance + covariance.T)


def cramer_rao_bound(
    model: EntryModel,
    states: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike,
    measurements: Measurements,
    covariance0: ArrayLike,
    noise: ArrayLike = 0.0,
) -> Bound:
    """Posterior Cramer-Rao bound with prior and process noise, along the true trajectory.

    Without process noise it is exact for the linearised problem; with it, Phi and H are taken on
    the given trajectory rather than averaged over its scatter.

    Parameters
    ----------
    model
        The world.
    states
        Trajectory at the beacons' times, shape (t, 6) or (t, 8).
    beacons, taken, measurements
        What is measured: `taken` has shape (t, n).
    covariance0
        Prior at the first time, (6, 6), SI.
    noise
        Process noise variance per second of the six states, scalar or (6,).

    References
    ----------
    Tichavsky, Muravchik and Nehorai 1998, IEEE Trans. Signal Process. 46:1386, eq. 21.
    """
    x = np.ascontiguousarray(model.full_state(states))
    covariance = np.empty((len(x), 6, 6))
    posterior_bound(
        x,
        np.array(covariance0, dtype=float),
        _course(model, beacons, noise),
        _sights(beacons, taken, measurements),
        covariance,
    )
    sigmas, jacobian = np.empty((len(x), 2)), np.empty((6, 6))
    for t in range(len(x)):
        cartesian_jacobian(x[t], jacobian)
        spread(covariance[t], jacobian, sigmas[t])
    return Bound(covariance, sigmas[:, 0], sigmas[:, 1])


def _course(model: EntryModel, beacons: Beacons, noise: ArrayLike) -> Course:
    """The filter's world at the beacons' times; process noise one for all states, or six."""
    return Course(
        spherical_parameters(model),
        model.vehicle.bank(beacons.times),
        beacons.times,
        np.broadcast_to(np.asarray(noise, dtype=float), (6,)).copy(),
    )


def _sights(beacons: Beacons, taken: ArrayLike, measurements: Measurements) -> Sights:
    """What is measured of the beacons."""
    seen = np.asarray(taken, dtype=bool)
    return Sights(beacons.r, beacons.v, seen, measurements.radio_variances()[:2])

"""How well a lander navigates on radio beacons: many runs of a filter."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.runs import Draws, monte_carlo
from compass.cores import in_blocks
from compass.entry.beacons import Beacons
from compass.entry.covariance import longest_step, problem_of
from compass.entry.filters import METHODS, Filter, root
from compass.entry.model import EntryModel
from compass.entry.schedule import Measurements
from compass.entry.trajectory import Trajectory
from compass.errors import ArgumentError

#: Runs handed to a thread at once.
BLOCK = 20


@dataclass(frozen=True)
class FilterRuns:
    """Errors of many runs of one filter.

    Attributes
    ----------
    errors
        Estimate minus truth in Mars-fixed position (m) and relative velocity (m/s), (runs, t, 6).
    nees
        Normalised error squared of position and velocity, (runs, t); 6 on average if the filter is
        consistent, nan where its covariance is not positive definite.
    sigmas
        What the filter claims: roots of the traces of its position and velocity covariance,
        (runs, t, 2).
    diverged
        Runs that did not stay finite; left out of the averages below.
    """

    errors: NDArray[np.float64]
    nees: NDArray[np.float64]
    sigmas: NDArray[np.float64]
    diverged: NDArray[np.bool_]

    @property
    def position_rms(self) -> NDArray[np.float64]:
        """Root mean square position error over the runs, m, shape (t,)."""
        return _rms(self.errors[~self.diverged, :, :3])

    @property
    def velocity_rms(self) -> NDArray[np.float64]:
        """Root mean square velocity error over the runs, m/s, shape (t,)."""
        return _rms(self.errors[~self.diverged, :, 3:])

    @property
    def position_rms_error(self) -> NDArray[np.float64]:
        """Standard error that so few runs leave of the position's, m, shape (t,); nan of one."""
        return _rms_error(self.errors[~self.diverged, :, :3])

    @property
    def velocity_rms_error(self) -> NDArray[np.float64]:
        """Standard error that so few runs leave of the velocity's, m/s, shape (t,); nan of one."""
        return _rms_error(self.errors[~self.diverged, :, 3:])

    @property
    def mean_nees(self) -> NDArray[np.float64]:
        """Mean of the normalised error squared over the runs, shape (t,); nan if one is."""
        kept = self.nees[~self.diverged]
        return kept.mean(axis=0) if len(kept) else np.full(kept.shape[1], np.nan)

    @property
    def broken(self) -> NDArray[np.bool_]:
        """Runs that stay finite, but with a covariance that is no longer positive definite."""
        return np.asarray(~self.diverged & np.isnan(self.nees).any(axis=1), dtype=np.bool_)


@dataclass(frozen=True)
class MonteCarlo(FilterRuns):
    """Many runs of one filter of any states.

    Attributes
    ----------
    nees_all
        Normalised error squared of all states that are estimated, (runs, t).
    estimated
        How many these are.
    """

    nees_all: NDArray[np.float64]
    estimated: int = 6


def _rms(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    if not len(errors):
        return np.full(errors.shape[1], np.nan)
    return np.sqrt((errors**2).sum(axis=2).mean(axis=0))


def _rms_error(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard error of the root of a mean, by that of the mean: ``s/sqrt(n) / (2 rms)``."""
    if len(errors) < 2:
        return np.full(errors.shape[1], np.nan)
    squares = (errors**2).sum(axis=2)
    rms = np.sqrt(squares.mean(axis=0))
    error = squares.std(axis=0, ddof=1) / np.sqrt(len(errors))
    return np.divide(error, 2.0 * rms, out=np.zeros_like(rms), where=rms > 0.0)


def run_monte_carlo(
    model: EntryModel,
    flight: Trajectory,
    beacons: Beacons,
    taken: ArrayLike,
    measurements: Measurements,
    settings: Filter,
    *,
    runs: int = 500,
    seed: int = 0,
    streams: Sequence[np.random.SeedSequence] | None = None,
    threads: int | None = None,
) -> MonteCarlo:
    """Filter one true flight `runs` times with independent errors and noise.

    The truth is the flight as it was flown, whatever the time between epochs; with process noise
    it is moved on from its own shaken states. The first estimate is drawn about the true first
    state with the filter's own covariance. Each run has its own stream of
    ``numpy.random.SeedSequence(seed)``, so the numbers do not depend on the number of threads, and
    more runs begin with the same ones.

    Parameters
    ----------
    model
        The world as the filter knows it; `flight.model` is the world as it is.
    flight
        The truth, at the times of `beacons`.
    beacons, taken, measurements
        What is measured, `taken` of shape (t, n), or another in each run, (runs, t, n).
    settings
        The filter.
    runs, seed
        How many, and from which seed.
    streams
        Of each run; those of `seed` if left out.
    threads
        Threads; one a processor if left out.
    """
    if runs < 1:
        raise ArgumentError(f"runs = {runs}: must be at least 1")
    count, layout = beacons.times.size, settings.layout(beacons.size)
    covariance0 = layout.covariance(np.asarray(settings.covariance0, dtype=float))
    errors, squares = np.empty((runs, count, 6)), np.empty((runs, count, 2))
    sigmas = np.empty((runs, count, 2))
    if streams is None:
        streams = np.random.SeedSequence(seed).spawn(runs)
    arrives = np.asarray(taken, dtype=bool)
    path = np.ascontiguousarray(flight.path)
    problem = problem_of(
        model,
        layout,
        path,
        beacons.times,
        measurements.heard(
            beacons, arrives.any(axis=tuple(range(arrives.ndim - 2))), path, flight.model
        ),
        settings.noise,
        longest_step(measurements),
    )
    spread = root(covariance0)
    world = problem._replace(p=flight.model.flight_parameters())
    size, heard = layout.size, problem.variances.size

    def work(part: slice) -> None:
        total = size + heard + count * size
        drawn = np.stack([np.random.default_rng(s).standard_normal(total) for s in streams[part]])
        first_state, heard_by, shaken_by = np.split(drawn, [size, size + heard], axis=1)
        # of several runs these are strided, of one they are not: two types to the compiler
        noise = np.ascontiguousarray(heard_by).reshape(len(drawn), *problem.variances.shape)
        if arrives.ndim > 2:
            noise[:, :, : beacons.size][~arrives[part]] = np.nan
        monte_carlo(
            path,
            world,
            covariance0,
            problem,
            settings.iterations,
            METHODS[settings.method],
            Draws(
                spread,
                np.ascontiguousarray(first_state),
                noise,
                np.ascontiguousarray(shaken_by).reshape(len(drawn), count, size),
            ),
            errors[part],
            squares[part],
            sigmas[part],
        )

    in_blocks(work, runs, BLOCK, threads)
    finite: NDArray[np.bool_] = np.asarray(np.isfinite(errors).all(axis=(1, 2)))
    return MonteCarlo(
        errors, squares[..., 0], sigmas, ~finite, squares[..., 1], int(layout.estimated)
    )

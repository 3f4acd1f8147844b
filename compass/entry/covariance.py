"""Linear covariance along a flight: what no filter can beat, in one run and without draws."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.entry.beacons import Beacons
from compass.entry.layout import Layout
from compass.entry.model import EntryModel
from compass.entry.schedule import Measurements
from compass.entry.views import spherical_jacobian
from compass.errors import ArgumentError

if TYPE_CHECKING:
    from compass.core.entry.groups import Problem

#: Longest Runge-Kutta step of filters and covariances, s. Over it a flight at 13 g is off by
#: less than 2 mm and 0.1 mm/s.
LONGEST_STEP = 1.0

#: Measurements better than this, by their unit, would tell: their filters take an eighth of the
#: step, over which the flight is off by a micrometre.
FINE = {"m": 1.0, "m/s": 0.05, "rad": 1e-6, "m/s^2": 0.0}


def longest_step(measurements: Measurements) -> float:
    """Longest Runge-Kutta step of filters and covariances that hear these measurements, s."""
    pairs = [(measurements.range_sigma, "m"), (measurements.rate_sigma, "m/s")]
    pairs += [(one.sigma, one.unit) for one in measurements.instruments]
    fine = any(sigma is not None and sigma < FINE[unit] for sigma, unit in pairs)
    return LONGEST_STEP / 8.0 if fine else LONGEST_STEP


@dataclass(frozen=True)
class Bound:
    """Covariance that a filter reaches at best, at the epochs of a flight.

    Attributes
    ----------
    covariance
        Of position (m), velocity (m/s) and further blocks after each epoch's measurements, in
        Mars-fixed axes, shape (t, s, s).
    """

    covariance: NDArray[np.float64]

    @property
    def position_sigma(self) -> NDArray[np.float64]:
        """Root of the trace of the position's covariance, m, shape (t,)."""
        return self._sigma(0)

    @property
    def velocity_sigma(self) -> NDArray[np.float64]:
        """Root of the trace of the velocity's covariance, m/s, shape (t,)."""
        return self._sigma(3)

    def _sigma(self, first: int) -> NDArray[np.float64]:
        part = self.covariance[:, range(first, first + 3), range(first, first + 3)]
        with np.errstate(invalid="ignore"):  # of a covariance that rounding has spoilt, nan
            return np.asarray(np.sqrt(part.sum(axis=1)))


def linear_covariance(
    model: EntryModel,
    path: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike,
    measurements: Measurements,
    covariance0: ArrayLike,
    noise: ArrayLike = 0.0,
    layout: Layout | None = None,
    *,
    square_root: bool = False,
) -> Bound:
    """Posterior covariance with prior and process noise, along a flight.

    It is the posterior Cramer-Rao bound where all states are estimated: exact for the linearised
    problem, with process noise taken on the given flight rather than averaged over its scatter.
    With considered blocks it is what Schmidt's gain reaches.

    Parameters
    ----------
    model
        The world.
    path
        Flight at the beacons' times, shape (t, 6), Mars-fixed.
    beacons, taken, measurements
        What is measured: `taken` has shape (t, n).
    covariance0
        Prior of position and velocity at the first time, (6, 6), SI, Mars-fixed.
    noise
        Process noise variance per second of the six spherical numbers, scalar or (6,).
    layout
        Further blocks; none if left out.
    square_root
        Carry a root of the covariance, where measurements are a million times better than the
        prior.

    References
    ----------
    Tichavsky, Muravchik and Nehorai 1998, IEEE Trans. Signal Process. 46:1386, eq. 21.
    """
    from compass.core.entry.filter import covariance_run
    from compass.core.entry.kinds import PLAIN, ROOTED

    flown = np.ascontiguousarray(path, dtype=float)
    blocks = layout or Layout(beacons=beacons.size)
    out = np.empty((len(flown), blocks.size, blocks.size))
    covariance_run(
        flown,
        blocks.covariance(np.asarray(covariance0, dtype=float)),
        problem_of(
            model,
            blocks,
            flown,
            beacons.times,
            measurements.heard(beacons, taken, flown, model),
            noise,
            longest_step(measurements),
        ),
        ROOTED if square_root else PLAIN,
        out,
    )
    return Bound(out)


def problem_of(
    model: EntryModel,
    layout: Layout,
    path: NDArray[np.float64],
    times: ArrayLike,
    heard: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]],
    noise: ArrayLike,
    longest: float,
) -> "Problem":
    """Return an estimation problem as kernels take it.

    Parameters
    ----------
    model
        The world as the filter knows it.
    layout
        Blocks of the state.
    path, times
        The flight about which noise and density are taken, (t, 6), at the epochs, (t,), s.
    heard
        Sources, variances and kinds, of `compass.entry.schedule.Measurements.heard`.
    noise
        As in `linear_covariance`.
    longest
        Longest Runge-Kutta step, s.
    """
    from compass.core.entry.groups import Problem

    epochs = np.array(times, dtype=float)
    walk, fade = layout.steps(path, epochs)
    sources, variances, kinds = heard
    return Problem(
        model.flight_parameters(),
        model.vehicle.bank_schedule(),
        epochs,
        longest,
        noise_roots(path, epochs, noise),
        walk,
        fade,
        sources,
        variances,
        kinds,
        layout.numbers(),
    )


def noise_roots(path: NDArray[np.float64], times: ArrayLike, noise: ArrayLike) -> NDArray:
    """Roots of the process noise gathered from the epoch before to each, (t, 6, 6).

    ``G = J diag(sqrt(q dt))``, J the derivative of the Cartesian state in the spherical numbers,
    per second of which `noise` gives the variances q (scalar or (6,)). If all are zero it has no
    rows, (t, 0, 6).
    """
    q = np.broadcast_to(np.asarray(noise, dtype=float), (6,))
    if not q.any():
        return np.empty((len(path), 0, 6))
    steps = np.diff(np.asarray(times, dtype=float), prepend=np.asarray(times)[0])
    return spherical_jacobian(path) * np.sqrt(q * steps[:, None])[:, None, :]


def axes_covariance(position_sigma: float, velocity_sigma: float) -> NDArray[np.float64]:
    """Covariance (6, 6) of one sigma a Cartesian axis of position (m) and velocity (m/s)."""
    for name, sigma in (("position_sigma", position_sigma), ("velocity_sigma", velocity_sigma)):
        if not 0 < sigma < float("inf"):
            raise ArgumentError(f"{name} = {sigma}: must be positive")
    return np.diag(np.repeat([position_sigma**2, velocity_sigma**2], 3))

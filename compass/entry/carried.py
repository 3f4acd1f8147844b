"""The filter that a guided lander carries, and what it hears on its way."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.filter import Problem
from compass.core.entry.guided import Carried
from compass.entry.beacons import Beacons
from compass.entry.covariance import longest_step, problem_of
from compass.entry.filters import METHODS, Filter, root
from compass.entry.layout import Layout
from compass.entry.schedule import Measurements
from compass.entry.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CarriedFilter:
    """A filter that flies along with entries about a planned one.

    What is heard when, and with how much noise, is that of the planned flight: entries kilometres
    off lose or find a beacon at the edge of the view some seconds earlier or later.

    Attributes
    ----------
    planned
        The flight as planned, at the beacons' times.
    beacons, taken
        Who is heard when, (t, n).
    measurements, settings
        What is measured, and the filter. Density and L/D it begins with as they are known; all
        else it begins with is drawn about the truth, as its covariance says.
    """

    planned: Trajectory
    beacons: Beacons
    taken: NDArray[np.bool_]
    measurements: Measurements
    settings: Filter

    @property
    def longest_step(self) -> float:
        """Longest Runge-Kutta step, s."""
        return longest_step(self.measurements)

    def numbers(self) -> Carried:
        """Everything as the kernels take it."""
        path, model = np.ascontiguousarray(self.planned.path), self.planned.model
        layout = self.settings.layout(self.beacons.size)
        problem = problem_of(
            model,
            layout,
            path,
            self.beacons.times,
            self.measurements.heard(self.beacons, self.taken, path, model),
            self.settings.noise,
            self.longest_step,
        )
        return Carried(
            problem,
            layout.covariance(np.asarray(self.settings.covariance0, dtype=float)),
            self.settings.iterations,
            METHODS[self.settings.method],
        )

    def drawn(self, numbers: Carried, starts: Array, seed: int) -> tuple[Array, Array]:
        """First estimates (m, s) of entries that begin at `starts` (m, 6), and draws of the noise.

        From its `numbers`. Each entry has a stream of its own, so that more entries begin with the
        same ones.
        """
        layout = self.settings.layout(self.beacons.size)
        factor, shape = root(numbers.covariance), numbers.problem.variances.shape
        firsts, noise = np.zeros((len(starts), layout.size)), np.empty((len(starts), *shape))
        firsts[:, :6] = starts
        for m, stream in enumerate(np.random.SeedSequence(seed).spawn(len(starts))):
            generator = np.random.default_rng(stream)
            off = factor @ generator.standard_normal(layout.size)
            off[[at for at in (layout.place("air"), layout.place("lift")) if at >= 0]] = 0.0
            firsts[m] += off
            noise[m] = generator.standard_normal(shape)
        return firsts, noise


def nothing_carried(entries: int) -> tuple[Carried, Array, Array]:
    """What the kernels take of guidance that knows the true state."""
    none, three = np.empty((0, 0)), np.empty((0, 0, 6))
    problem = Problem(
        np.empty(0), np.zeros((1, 2)), np.empty(0), 0.0, three, none, np.empty(0), three,
        np.empty((0, 0, 0)), np.empty(0, dtype=np.int64), Layout().numbers(),
    )  # fmt: skip
    return Carried(problem, none, 1, 0), np.empty((entries, 0)), np.empty((entries, 0, 0, 0))

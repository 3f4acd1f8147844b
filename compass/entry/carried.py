"""The filter that a guided lander carries, and what it hears on its way."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.groups import Problem
from compass.core.entry.guided import Carried
from compass.entry.beacons import Beacons
from compass.entry.covariance import LONGEST_STEP, longest_step, problem_of
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

    def numbers(self, starts: Array, seed: int) -> Carried:
        """As the kernels take it, with first estimates and noise of entries that begin at `starts`.

        These are of shape (m, 6). Each entry has a stream of its own, so that more entries begin
        with the same ones.
        """
        path, model = np.ascontiguousarray(self.planned.path), self.planned.model
        layout = self.settings.layout(self.beacons.size)
        heard = self.measurements.heard(self.beacons, self.taken, path, model)
        longest = longest_step(self.measurements)
        problem = problem_of(
            model, layout, path, self.beacons.times, heard, self.settings.noise, longest
        )
        covariance = layout.covariance(np.asarray(self.settings.covariance0, dtype=float))
        factor, count, shape = root(covariance), len(starts), problem.variances.shape
        firsts, noise = np.zeros((count, layout.size)), np.empty((count, *shape))
        firsts[:, :6] = starts
        for m, stream in enumerate(np.random.SeedSequence(seed).spawn(count)):
            generator = np.random.default_rng(stream)
            off = factor @ generator.standard_normal(layout.size)
            off[[at for at in (layout.place("air"), layout.place("lift")) if at >= 0]] = 0.0
            firsts[m] += off
            noise[m] = generator.standard_normal(shape)
        method, iterations = METHODS[self.settings.method], self.settings.iterations
        return Carried(problem, covariance, iterations, method, firsts, noise)


def nothing_carried(entries: int) -> Carried:
    """What the kernels take of guidance that knows the true state."""
    none, three = np.empty((0, 0)), np.empty((0, 0, 6))
    problem = Problem(
        np.empty(0), np.zeros((1, 2)), np.empty(0), LONGEST_STEP, three, none, np.empty(0),
        three, np.empty((0, 0, 0)), np.empty(0, dtype=np.int64), Layout().numbers(),
    )  # fmt: skip
    return Carried(problem, none, 1, 0, np.empty((entries, 0)), np.empty((entries, 0, 0, 0)))

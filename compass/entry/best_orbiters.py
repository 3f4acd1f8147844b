"""The best circular orbits for navigation orbiters."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import simpson
from scipy.optimize import OptimizeResult, minimize

from compass.core.entry.search import circle_positions, determinants, view_margins
from compass.entry.search import Optimum, multistart
from compass.entry.trajectory import Trajectory
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci


def best_orbiters(
    flight: Trajectory,
    altitude: float,
    count: int = 3,
    *,
    starts: int = 4,
    generations: int = 60,
    seed: int = 0,
    threads: int = 2,
    progress: Callable[[], object] = lambda: None,
) -> Optimum:
    """Circular orbits, in view throughout, of the largest integral of det N (eqs. 57 to 62).

    Inertial axes coincide with the Mars-fixed ones at time 0; the orbits are two-body. Three
    orbiters reach at most the duration in seconds. Many optima are equivalent.

    Parameters
    ----------
    flight
        The trajectory.
    altitude
        Over the planet's sphere, m.
    count
        Number of orbiters, at least 3.
    starts, generations, seed, threads
        Of the search.
    progress
        Called after each start.

    Raises
    ------
    ArgumentError
        Fewer than three orbiters, an orbit not above the surface, or no start that ended with
        every orbiter in view throughout.
    """
    model = flight.model
    radius = model.planet_radius + altitude
    if count < 3:
        raise ArgumentError(f"count = {count}: det N is zero below 3 orbiters; use 3 or more")
    if not altitude > 0:
        raise ArgumentError(f"altitude = {altitude / 1e3:g} km: must be above 0")
    times = flight.times - flight.times[0]
    lander = mcmf_from_mci(cartesian_of(flight.states)[:, :3], -model.omega * times)
    lander = np.ascontiguousarray(lander)
    motion = float(np.sqrt(model.gm / radius**3))

    weights = simpson(np.eye(times.size), x=times)

    def beacons(x: NDArray) -> NDArray[np.float64]:
        r = np.empty((times.size, count, 3))
        circle_positions(x.reshape(count, 3), radius, motion, times, r)
        return r

    def integral(x: NDArray) -> float:
        out = np.empty(times.size)
        determinants(lander, beacons(x), out)
        return -float(weights @ out)

    def margins(x: NDArray) -> NDArray[np.float64]:
        out = np.empty((times.size, count))
        view_margins(lander, beacons(x), model.planet_radius, out)
        return np.asarray(out.min(axis=0))

    steep = 10.0 * times[-1] * (count / 3.0) ** 3

    def penalised(x: NDArray) -> float:
        return integral(x) + steep * max(0.0, -float(margins(x).min()))

    def polish(x: NDArray) -> OptimizeResult:
        in_view = {"type": "ineq", "fun": lambda y: margins(y) - 1e-7}
        options = {"maxiter": 500, "ftol": 1e-10}
        return minimize(integral, x, method="SLSQP", constraints=[in_view], options=options)

    def decode(x: NDArray) -> NDArray[np.float64]:
        angles = np.mod(x.reshape(count, 3), 2 * np.pi)
        beyond = angles[:, 1] > np.pi  # the same orbit seen from its other node
        angles[beyond] = [np.pi, 2 * np.pi, np.pi] + angles[beyond] * [1, -1, 1]
        return np.mod(angles, 2 * np.pi)

    optimum = multistart(
        penalised,
        polish,
        [(0.0, 2 * np.pi), (0.0, np.pi), (0.0, 2 * np.pi)] * count,
        decode,
        objective="integral of det N (s)",
        told=lambda found: -found,
        starts=starts,
        generations=generations,
        seed=seed,
        threads=threads,
        progress=progress,
    )
    feasible = [s for s in optimum.starts if margins(s.parameters.ravel()).min() > 0]
    if not feasible:
        raise ArgumentError(
            f"no orbits of {altitude / 1e3:g} km found that stay in view throughout; "
            "raise the altitude, the generations or the starts"
        )
    best = feasible[0]
    return replace(optimum, value=best.value, parameters=best.parameters, starts=tuple(feasible))

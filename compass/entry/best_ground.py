"""The best places for ground beacons."""

from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds, OptimizeResult, minimize

from compass.core.entry.search import determinants, minimum_degree, position_series
from compass.entry.beacons import Beacons
from compass.entry.covariance import linear_covariance
from compass.entry.observability import whole_path
from compass.entry.schedule import Measurements
from compass.entry.search import Optimum, multistart
from compass.entry.trajectory import Trajectory
from compass.entry.views import spherical_jacobian
from compass.entry.visible_area import VisibleArea
from compass.errors import ArgumentError
from compass.frames import latitude_longitude

GroundObjective = Literal["minimum-delta", "mean-log-index", "bound-trace"]

#: The search looks at every fourth epoch, the polish and the result at all.
STRIDE = 4


def best_ground_beacons(
    flight: Trajectory,
    count: int = 3,
    *,
    objective: GroundObjective = "minimum-delta",
    measurements: Measurements | None = None,
    covariance0: ArrayLike | None = None,
    starts: int = 4,
    generations: int = 60,
    seed: int = 0,
    threads: int = 2,
    progress: Callable[[], object] = lambda: None,
) -> Optimum:
    """Places on the surface, in view throughout, from which a lander navigates best.

    Parameters
    ----------
    flight
        The trajectory.
    count
        Number of beacons.
    objective
        ``minimum-delta``: the smallest observability degree on the way (eq. 49, SI), as large as
        can be; ``mean-log-index``: mean of ``ln I`` (eq. 54), likewise; ``bound-trace``: root of
        the mean trace of the position's Cramer-Rao bound, m, as small as can be.
    measurements, covariance0
        Noise and prior of ``bound-trace``.
    starts, generations, seed, threads
        Of the search; the result does not depend on the threads.
    progress
        Called after each start.

    Raises
    ------
    ArgumentError
        An unknown objective, no place that sees the lander throughout, too few beacons for the
        objective, or no prior for ``bound-trace``.
    """
    if objective not in get_args(GroundObjective):
        allowed = ", ".join(get_args(GroundObjective))
        raise ArgumentError(f"objective = {objective!r}: allowed {allowed}")
    least = 1 if objective == "bound-trace" else 3
    if count < least:
        raise ArgumentError(
            f"count = {count}: {objective} is zero or undefined below {least} beacons; use more, "
            "or the objective bound-trace"
        )
    model = flight.model
    area = VisibleArea(flight)

    def places(x: NDArray) -> NDArray[np.float64]:
        return model.planet_radius * area.points(x.reshape(count, 2))

    if objective == "minimum-delta":
        series = position_series(
            whole_path(model, flight.states),
            model.flight_parameters(),
            model.vehicle.bank(flight.times),
            spherical_jacobian(flight.path),
            6,
        )
        few = np.ascontiguousarray(series[::STRIDE])

        def degree(kept: NDArray) -> Callable[[NDArray], float]:
            # beacons at one place leave the matrix singular: ln 0 is a wall, not an error
            return lambda x: -float(np.log(max(minimum_degree(kept, places(x)), 1e-300)))

        coarse, fine = degree(few), degree(series)
    elif objective == "mean-log-index":
        lander = flight.path[:, :3].copy()

        def coarse(x: NDArray) -> float:
            out = np.empty(len(lander))
            determinants(lander, np.broadcast_to(places(x), (len(lander), count, 3)), out)
            return -float(np.log(np.maximum(out, 1e-300)).mean())

        fine = coarse
    else:
        if covariance0 is None:
            raise ArgumentError("covariance0: missing; bound-trace needs a prior")
        coarse = _bound_objective(
            flight, measurements or Measurements(), np.array(covariance0), places, count
        )
        fine = coarse

    def decode(x: NDArray) -> NDArray[np.float64]:
        return np.stack(latitude_longitude(places(x)), axis=1)

    bounds = [(0.0, 2 * np.pi), (0.0, 1.0)] * count

    def polish(x: NDArray) -> OptimizeResult:
        options = {"maxfev": 200 * count, "xatol": 1e-7, "fatol": 0.0, "adaptive": True}
        edges = Bounds(*np.transpose(bounds))
        return minimize(fine, x, method="Nelder-Mead", bounds=edges, options=options)

    named, told = {
        "minimum-delta": ("minimum-delta (m, s, rad)", lambda found: float(np.exp(-found))),
        "mean-log-index": (objective, lambda found: -found),
        "bound-trace": (objective, lambda found: found),
    }[objective]
    return multistart(
        coarse,
        polish,
        bounds,
        decode,
        objective=named,
        told=told,
        starts=starts,
        generations=generations,
        seed=seed,
        threads=threads,
        progress=progress,
    )


def _bound_objective(
    flight: Trajectory,
    measurements: Measurements,
    covariance0: NDArray,
    places: Callable[[NDArray], NDArray],
    count: int,
) -> Callable[[NDArray], float]:
    epochs = len(flight.times)
    taken = measurements.taken(np.ones((epochs, count), dtype=bool), flight.times)
    names, still = tuple(f"B{k + 1}" for k in range(count)), np.zeros(count, dtype=bool)

    def objective(x: NDArray) -> float:
        r = np.repeat(places(x)[None], epochs, axis=0)
        beacons = Beacons(names, flight.times, r, np.zeros_like(r), still)
        bound = linear_covariance(
            flight.model, flight.path, beacons, taken, measurements, covariance0
        )
        return float(np.sqrt((bound.position_sigma**2).mean()))

    return objective

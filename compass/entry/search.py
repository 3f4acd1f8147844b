"""Searching for the best: many starts of a global search, each polished, all remembered."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, differential_evolution


@dataclass(frozen=True)
class Start:
    """One start of a search.

    Attributes
    ----------
    value
        Objective reached.
    parameters
        Where, as `Optimum.parameters`.
    history
        Best objective after each generation of the global search, then after the polish.
    evaluations
        How often the objective was computed.
    """

    value: float
    parameters: NDArray[np.float64]
    history: tuple[float, ...]
    evaluations: int


@dataclass(frozen=True)
class Optimum:
    """What a search found.

    Attributes
    ----------
    objective
        What was optimised, with its unit.
    value
        The best value.
    parameters
        Ground: latitude and longitude, rad, shape (n, 2). Orbiters: node, inclination and
        argument of latitude at time 0, rad, (n, 3). Directions: unit vectors, (n, 3).
    starts
        Every start, best first: different local optima show here.
    seconds
        Wall time.
    """

    objective: str
    value: float
    parameters: NDArray[np.float64]
    starts: tuple[Start, ...]
    seconds: float


def multistart(
    coarse: Callable[[NDArray], float],
    polish: Callable[[NDArray], OptimizeResult],
    bounds: Sequence[tuple[float, float]],
    decode: Callable[[NDArray], NDArray],
    *,
    objective: str,
    told: Callable[[float], float],
    starts: int,
    generations: int,
    seed: int,
    threads: int,
    progress: Callable[[], object],
) -> Optimum:
    """Differential evolution, then a local polish from where it ended.

    Both minimise; what they find is reported as `told` makes of it. Each start has its own stream
    of ``SeedSequence(seed)``, so the threads do not change the result.
    """
    began = time.perf_counter()

    def one(stream: np.random.SeedSequence) -> tuple[float, Start]:
        history: list[float] = []

        def record(intermediate_result: object) -> None:
            history.append(told(float(intermediate_result.fun)))  # type: ignore[attr-defined]

        minimum = differential_evolution(
            coarse,
            bounds,
            maxiter=generations,
            popsize=8,
            tol=1e-7,
            polish=False,
            rng=np.random.default_rng(stream),
            callback=record,
        )
        polished = polish(minimum.x)
        history.append(told(float(polished.fun)))
        progress()
        evaluations = minimum.nfev + polished.nfev
        return polished.fun, Start(history[-1], decode(polished.x), tuple(history), evaluations)

    with ThreadPoolExecutor(threads) as pool:
        done = sorted(
            pool.map(one, np.random.SeedSequence(seed).spawn(starts)), key=lambda found: found[0]
        )
    ordered = tuple(start for _, start in done)
    best, seconds = ordered[0], time.perf_counter() - began
    return Optimum(objective, best.value, best.parameters, ordered, seconds)

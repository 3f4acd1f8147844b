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
    maximise: bool,
    starts: int,
    generations: int,
    seed: int,
    threads: int,
    progress: Callable[[], object],
) -> Optimum:
    """Differential evolution, then a local polish from where it ended.

    Both minimise; the values reported are negated back if `maximise`. Each start
    has its own stream of ``SeedSequence(seed)``, so the threads do not change the result.
    """
    began = time.perf_counter()
    sign = -1.0 if maximise else 1.0

    def one(stream: np.random.SeedSequence) -> Start:
        history: list[float] = []

        def record(intermediate_result: object) -> None:
            history.append(sign * float(intermediate_result.fun))  # type: ignore[attr-defined]

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
        value = sign * float(polished.fun)
        history.append(value)
        progress()
        return Start(value, decode(polished.x), tuple(history), minimum.nfev + polished.nfev)

    with ThreadPoolExecutor(threads) as pool:
        done = list(pool.map(one, np.random.SeedSequence(seed).spawn(starts)))
    done.sort(key=lambda start: sign * start.value)
    best = done[0]
    return Optimum(objective, best.value, best.parameters, tuple(done), time.perf_counter() - began)

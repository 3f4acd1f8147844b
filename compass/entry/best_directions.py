"""The best directions of beacons, found by search: the check of the closed form."""

import time

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from compass.entry.search import Optimum, Start
from compass.errors import ArgumentError


def best_directions_found(sigma: ArrayLike, *, starts: int = 4, seed: int = 0) -> Optimum:
    """Directions of the largest ``det(sum n n^T / sigma^2)``, by quasi-Newton from random starts.

    The closed form is `compass.entry.fisher.best_determinant`; this is its independent check
    (Table 1 of Yu et al. 2018) and gives directions for beacons of unequal quality.

    Parameters
    ----------
    sigma
        One sigma of each beacon, shape (n,), n at least 3.
    starts, seed
        Of the search.
    """
    began = time.perf_counter()
    w = np.atleast_1d(np.asarray(sigma, dtype=float)) ** -2.0
    if w.size < 3:
        raise ArgumentError(f"sigma: {w.size} beacons; the determinant is zero below 3")

    def objective(x: NDArray) -> tuple[float, NDArray]:
        u = x.reshape(-1, 3)
        length = np.linalg.norm(u, axis=1, keepdims=True)
        n = u / length
        information = (n * w[:, None]).T @ n
        sign, log_det = np.linalg.slogdet(information)
        if sign <= 0:
            return 1e10, np.zeros_like(x)
        gradient = -2 * w[:, None] * np.linalg.solve(information, n.T).T
        gradient -= (gradient * n).sum(axis=1, keepdims=True) * n
        return -float(log_det), (gradient / length).ravel()

    done = []
    for stream in np.random.SeedSequence(seed).spawn(starts):
        history: list[float] = []
        first = np.random.default_rng(stream).standard_normal(3 * w.size)
        minimum = minimize(
            objective,
            first,
            jac=True,
            method="L-BFGS-B",
            callback=lambda x, h=history: h.append(float(np.exp(-objective(x)[0]))),
            options={"ftol": 1e-15, "gtol": 1e-10, "maxiter": 2000},
        )
        n = minimum.x.reshape(-1, 3)
        n = n / np.linalg.norm(n, axis=1, keepdims=True)
        done.append(Start(float(np.exp(-minimum.fun)), n, tuple(history), minimum.nfev))
    done.sort(key=lambda start: -start.value)
    return Optimum(
        "det(sum n n^T / sigma^2)",
        done[0].value,
        done[0].parameters,
        tuple(done),
        time.perf_counter() - began,
    )

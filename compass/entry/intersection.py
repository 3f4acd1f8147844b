"""Fusing estimates whose correlation is unknown: covariance intersection."""

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.core.entry.weights import (
    equal_weights,
    fast_weights,
    make_scratch,
    optimal_weights,
)
from compass.entry.fused_kinds import Weighting
from compass.errors import ArgumentError

Array = NDArray[np.float64]


@checked
def intersection_weights(
    covariances: ArrayLike, weighting: Weighting = "determinant", scale: ArrayLike | None = None
) -> Array:
    """Weights of covariance intersection, shape (m,): each at least 0, their sum 1.

    Parameters
    ----------
    covariances
        Shape (m, n, n).
    weighting
        ``determinant`` or ``trace``: minimise that of the fused covariance; ``fast``: eq. 21 of Lou
        et al. 2019 in the infinity norm; ``equal``.
    scale
        Size of each state, shape (n,), in which traces and norms are taken: without it they
        depend on the units. The determinant rule does not.

    Raises
    ------
    ArgumentError
        A covariance that is not positive definite, or an unknown rule.

    Examples
    --------
    >>> import compass
    >>> compass.intersection_weights([[[1.0]], [[4.0]]]).round(6).tolist()
    [1.0, 0.0]
    """
    if weighting not in get_args(Weighting):
        raise ArgumentError(f"weighting = {weighting!r}: allowed {', '.join(get_args(Weighting))}")
    information = _information(covariances)
    m, n = information.shape[:2]
    u = np.ones(n) if scale is None else np.asarray(scale, dtype=float)
    if u.shape != (n,) or not np.all(u > 0):
        raise ArgumentError(f"scale: give {n} positive sizes, one a state")
    scaled = np.ascontiguousarray(information * np.outer(u, u))
    weights, alive, work = np.empty(m), np.ones(m, bool), make_scratch(n, m)
    if weighting == "equal":
        equal_weights(alive, weights)
    elif weighting == "fast":
        fast_weights(scaled, alive, weights, work.a)
    else:
        optimal_weights(scaled, alive, weighting == "trace", weights, work)
    return weights


@checked
def covariance_intersection(
    states: ArrayLike, covariances: ArrayLike, weights: ArrayLike
) -> tuple[Array, Array]:
    """Fused state and covariance, ``P = (sum w_i P_i^-1)^-1``, ``x = P sum w_i P_i^-1 x_i``.

    Never smaller than the true covariance of the fused state, whatever the correlation of the
    estimates, if none of their own covariances is too small.

    Parameters
    ----------
    states, covariances
        Shapes (m, n) and (m, n, n).
    weights
        Shape (m,), as from `intersection_weights`.

    Raises
    ------
    ArgumentError
        A covariance that is not positive definite, or weights that are negative, all 0 or do not
        sum to 1.

    References
    ----------
    Julier and Uhlmann 1997, A Non-divergent Estimation Algorithm in the Presence of Unknown
    Correlations, Proc. American Control Conference.

    Examples
    --------
    >>> import compass
    >>> x, p = compass.covariance_intersection([[0.0], [2.0]], [[[1.0]], [[1.0]]], [0.5, 0.5])
    >>> x.tolist(), p.tolist()
    ([1.0], [[1.0]])
    """
    w, x = np.asarray(weights, dtype=float), np.asarray(states, dtype=float)
    information = _information(covariances)
    if w.shape != information.shape[:1] or np.any(~(w >= 0)) or abs(w.sum() - 1.0) > 1e-9:
        raise ArgumentError(
            f"weights = {w.tolist()}: give {len(information)}, none negative, with the sum 1"
        )
    fused = np.linalg.inv(np.einsum("i,iab->ab", w, information))
    first = x[0]
    pull = np.einsum("i,iab,ib->a", w, information, x - first)
    return first + fused @ pull, fused


def _information(covariances: ArrayLike) -> Array:
    p = np.asarray(covariances, dtype=float)
    if p.ndim != 3 or p.shape[1] != p.shape[2]:
        raise ArgumentError(f"covariances of shape {p.shape}: must be (m, n, n)")
    for k, one in enumerate(p, start=1):
        try:
            np.linalg.cholesky(one)
        except np.linalg.LinAlgError as error:
            raise ArgumentError(f"covariance {k} of {len(p)}: not positive definite") from error
    return np.linalg.inv(p)

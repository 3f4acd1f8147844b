"""Shares of the sphere, and of area and time, by fold: exact at a moment, integrated over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.area import FULL, areas_by_fold
from compass.coverage.fold import caps_of, fold_extremes
from compass.coverage.symmetry import Span, shortest_span
from compass.orbits import Constellation


@dataclass(frozen=True)
class FoldShares:
    """Shares of area and time with fold 0, 1, 2, ...

    Attributes
    ----------
    share
        Share with exactly k satellites in view, shape (n + 1,); they sum to 1.
    error
        Estimate of the largest error: of the adaptive quadrature in time, and of what the
        symmetries miss that the span stands on.
    """

    share: NDArray[np.float64]
    error: float


def fold_shares(directions: ArrayLike, radius: ArrayLike) -> NDArray[np.float64]:
    """Shares of the sphere with fold 0 ... n at a moment, exact but for rounding.

    Parameters
    ----------
    directions, radius
        As in `fold_extremes`.
    """
    u = np.asarray(directions, dtype=float).reshape(-1, 3)
    u = u / np.linalg.norm(u, axis=1, keepdims=True)
    lam = np.broadcast_to(np.asarray(radius, dtype=float), u.shape[:1])
    cosines = np.where(lam <= 0, 2.0, np.where(lam >= np.pi, -2.0, np.cos(lam)))
    extremes = fold_extremes(u, lam)
    at_least = areas_by_fold(u, cosines, extremes.least, extremes.greatest) / FULL
    return -np.diff(at_least, append=0.0)


def mean_fold_shares(
    constellation: Constellation,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    span: Span | None = None,
    tolerance: float = 1e-6,
) -> FoldShares:
    """Shares of area and time with fold 0 ... n over a span.

    Areas are exact at every moment; time is integrated by adaptive Gauss-Kronrod quadrature to
    `tolerance`, whose own estimate of the error is passed on.
    """
    span = span or shortest_span(constellation)
    if span.stop == span.start:
        return FoldShares(
            fold_shares(*caps_of(constellation, sphere_radius, mask, span.start)), 0.0
        )
    length = span.stop - span.start

    def at(part: float) -> NDArray[np.float64]:
        return fold_shares(*caps_of(constellation, sphere_radius, mask, span.start + part * length))

    from scipy.integrate import quad_vec  # it takes a second to load, a proof does not need it

    share, error = quad_vec(
        at, 0.0, 1.0, epsabs=tolerance, epsrel=0.0, norm="max", limit=2000, quadrature="gk15"
    )
    # a rim moved by an angle moves less area than half of it, of the sphere
    moved = 0.5 * constellation.size * span.mismatch
    return FoldShares(share, float(error) + moved)

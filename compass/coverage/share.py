"""Shares of the sphere, and of area and time, by fold: exact at a moment, integrated over time."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from compass.core.area import FULL, areas_at_moments
from compass.cores import cores
from compass.coverage.cap import cap_radius
from compass.coverage.quadrature import integrate
from compass.coverage.symmetry import Span, shortest_span
from compass.orbits import Constellation, positions_mci


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
    length = span.stop - span.start

    def at(parts: NDArray[np.float64]) -> NDArray[np.float64]:
        r = positions_mci(constellation, span.start + parts * length).swapaxes(0, 1)
        return fold_shares(r, cap_radius(np.linalg.norm(r, axis=-1), sphere_radius, mask))

    if length == 0.0:
        return FoldShares(at(np.zeros(1))[0], 0.0)
    share, error = integrate(at, tolerance)
    # a rim moved by an angle moves less area than half of it, of the sphere
    moved = 0.5 * constellation.size * span.mismatch
    return FoldShares(share, error + moved)


def fold_shares(toward: NDArray[np.float64], radius: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares of the sphere with fold 0 ... n at moments, (moment, n + 1), exact but for rounding.

    Parameters
    ----------
    toward, radius
        Caps: vectors to the satellites, (moment, n, 3), any length, and radii, (moment, n).
    """
    u = np.ascontiguousarray(toward / np.linalg.norm(toward, axis=-1, keepdims=True))
    cosines = np.where(radius <= 0, 2.0, np.where(radius >= np.pi, -2.0, np.cos(radius)))
    edges = np.linspace(0, len(u), cores() + 1).astype(int)
    with ThreadPoolExecutor(cores()) as pool:
        parts = [slice(*ends) for ends in pairwise(edges)]
        areas = np.concatenate(list(pool.map(lambda p: areas_at_moments(u[p], cosines[p]), parts)))
    return -np.diff(areas / FULL, append=0.0)

"""Fisher information of radio beacons: what it is, how large it can be, what it bounds."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError

#: Angle of the cone on which equally spaced directions form a tight frame: acos(1/sqrt 3), rad.
TIGHT_CONE = float(np.arccos(1 / np.sqrt(3)))


def _weights(sigma: ArrayLike, count: int | None = None) -> NDArray[np.float64]:
    """``sigma^-2`` of each beacon, shape (n,)."""
    sigmas = np.atleast_1d(np.asarray(sigma, dtype=float))
    if count is not None:
        sigmas = np.broadcast_to(sigmas, (count,))
    if np.any(~(sigmas > 0) | ~np.isfinite(sigmas)):
        bad = sigmas[~(sigmas > 0) | ~np.isfinite(sigmas)][0]
        raise ArgumentError(f"sigma = {bad}: measurement noise must be positive and finite")
    return sigmas**-2.0


def range_information(directions: ArrayLike, sigma: ArrayLike) -> NDArray[np.float64]:
    """Information of ranges on position: ``F = sum n_i n_i^T / sigma_i^2``, shape (3, 3).

    Also that of range rates on *velocity* (eq. 42), with their noise.

    Parameters
    ----------
    directions
        Unit vectors n between beacons and lander, shape (n, 3).
    sigma
        One sigma noise, scalar or (n,).
    """
    n = np.asarray(directions, dtype=float).reshape(-1, 3)
    return (n * _weights(sigma, len(n))[:, None]).T @ n


def rate_information(
    directions: ArrayLike, distances: ArrayLike, velocities: ArrayLike, sigma: ArrayLike
) -> NDArray[np.float64]:
    """Information of range rates on position: ``sum L_i w_i w_i^T L_i^T / sigma_i^2``, (3, 3).

    ``L_i = (I - n n^T)/R_i`` and w the velocity *relative to the beacon* (eqs. 43 and 44 of
    Yu et al. 2018, which take the lander's own velocity).

    Parameters
    ----------
    directions, distances
        Unit vectors (n, 3) and ranges (n,), m.
    velocities
        Lander minus beacon velocity, m/s, (3,) or (n, 3).
    sigma
        One sigma noise, m/s, scalar or (n,).
    """
    n = np.asarray(directions, dtype=float).reshape(-1, 3)
    w = np.broadcast_to(np.asarray(velocities, dtype=float), n.shape)
    across = w - (w * n).sum(axis=1, keepdims=True) * n
    return range_information(across / np.asarray(distances, dtype=float).reshape(-1, 1), sigma)


def best_eigenvalues(sigma: ArrayLike) -> NDArray[np.float64]:
    """Eigenvalues, descending, of the best range information that any directions reach, (3,).

    With weights ``w = sigma^-2``: while the largest left exceeds the mean share of what is left,
    it is an eigenvalue by itself; the rest share equally. That is the least spread spectrum that
    the Schur-Horn theorem allows, so it maximises the determinant and minimises the trace of the
    inverse at once. Fewer than three beacons leave zeros.

    Parameters
    ----------
    sigma
        One sigma of each beacon, shape (n,).
    """
    left = np.sort(_weights(sigma))[::-1]
    eigenvalues: list[float] = []
    while len(eigenvalues) < 3 and left.size and left[0] > left.sum() / (3 - len(eigenvalues)):
        eigenvalues.append(float(left[0]))
        left = left[1:]
    share = left.sum() / max(1, 3 - len(eigenvalues))
    return np.sort(np.array(eigenvalues + [share] * (3 - len(eigenvalues))))[::-1]


def best_determinant(sigma: ArrayLike) -> float:
    """Return the largest determinant of the range information: ``(N/3)^3 sigma^-6`` if alike.

    Parameters as in `best_eigenvalues`; in units of ``sigma^-6``. Zero below three beacons.
    """
    return float(np.prod(best_eigenvalues(sigma)))


def best_directions(count: int) -> NDArray[np.float64]:
    """Directions of `count` >= 3 equally good beacons that reach `best_determinant`, (n, 3).

    Equally spaced on a cone of half-angle ``acos(1/sqrt 3)``: a unit tight frame.
    """
    if count < 3:
        raise ArgumentError(f"count = {count}: at least 3 beacons determine a position")
    angle = 2 * np.pi * np.arange(count) / count
    across, along = np.sin(TIGHT_CONE), np.cos(TIGHT_CONE)
    return np.stack([across * np.cos(angle), across * np.sin(angle), np.full(count, along)], axis=1)


def position_variance_bound(sigma: ArrayLike) -> float:
    """Lower bound of the trace of the position covariance from one epoch of ranges, m^2.

    ``9 / sum sigma^-2``, from ``tr F^-1 >= 9 / tr F``: ``9 sigma^2 / N``. Infinite below three
    beacons, whose information is singular.
    """
    w = _weights(sigma)
    return float(9.0 / w.sum()) if w.size >= 3 else float("inf")


def two_beacon_eigenvalues(sigma_1: float, sigma_2: float, angle: float) -> NDArray[np.float64]:
    """Nonzero eigenvalues, descending, of two beacons whose directions are `angle` (rad) apart.

    ``(w1 + w2)/2 +- sqrt((w1 - w2)^2 + 4 w1 w2 cos^2 angle)/2``: equal only if orthogonal and
    equally good (section 4.3 of Yu et al. 2018 takes them equal always).
    """
    w1, w2 = _weights([sigma_1, sigma_2])
    root = np.sqrt((w1 - w2) ** 2 + 4 * w1 * w2 * np.cos(angle) ** 2)
    return np.array([(w1 + w2 + root) / 2, (w1 + w2 - root) / 2])


def best_rate_determinant(count: int, sigma: float, speed: float, distance: float) -> float:
    """Return the largest determinant of range rates on position, all at one distance.

    ``sigma^-6 (4 N^3/729) (v/R)^6``, with every direction 54.7356 deg from the velocity.
    """
    weight = _weights(sigma)[0]
    return float(weight**3 * 4 * count**3 / 729 * (speed / distance) ** 6) if count >= 3 else 0.0

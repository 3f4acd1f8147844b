"""Fold at a moment: exactly, over the whole sphere or a region, and plainly at given points."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.fold import cell_point, extreme_fold
from compass.coverage.cap import cap_radius
from compass.coverage.region import GLOBE, Region
from compass.orbits import Constellation, positions_mci


@dataclass(frozen=True)
class FoldExtremes:
    """Least and greatest fold at a moment, with bounds where circles meet in one point.

    Attributes
    ----------
    least, least_place
        The least fold is not below `least`; `least_place` is a unit vector, shape (3,), inside
        the cell where it was found.
    least_reached
        The least fold that some cell is certain to have. Above `least` only where more than two
        circles meet within rounding.
    greatest, greatest_place, greatest_reached
        The same for the greatest fold, which is not above `greatest`.
    """

    least: int
    least_reached: int
    least_place: NDArray[np.float64]
    greatest: int
    greatest_reached: int
    greatest_place: NDArray[np.float64]


def fold_extremes(directions: ArrayLike, radius: ArrayLike, region: Region = GLOBE) -> FoldExtremes:
    """Exact least and greatest number of caps over the points of the sphere or a region.

    Parameters
    ----------
    directions
        Vectors to the satellites, shape (n, 3), any length; n may be 0.
    radius
        Cap radii, radians, one for all or shape (n,).
    region
        Where, in the frame of `directions`.

    Notes
    -----
    "Everywhere" means every point but those on the circles themselves, where one cap's rim
    counts as in view: the least fold is the same either way.
    """
    u = np.asarray(directions, dtype=float).reshape(-1, 3)
    u = u / np.linalg.norm(u, axis=1, keepdims=True)
    lam = np.broadcast_to(np.asarray(radius, dtype=float), u.shape[:1])
    cosines = np.where(lam <= 0, 2.0, np.where(lam >= np.pi, -2.0, np.cos(lam)))
    extremes = []
    for low in (True, False):
        no_stop = -1 if low else len(u) + 1
        arrangement = (u, cosines, region.sides)
        bound, curve, azimuth, width = extreme_fold(*arrangement, low, True, no_stop)
        reached = extreme_fold(*arrangement, low, False, no_stop)[0]
        place, count, inside = cell_point(curve, azimuth, width, *arrangement, low)
        if inside:
            reached = min(reached, count) if low else max(reached, count)
        extremes += [int(bound), int(reached), place]
    return FoldExtremes(*extremes)


def clearances(
    positions: NDArray[np.float64],
    sphere_radius: float,
    mask: float,
    points: ArrayLike,
    stretch: float = 1.0,
) -> NDArray[np.float64]:
    """Elevation above the mask of satellites at points on the body's surface, radians.

    Straight from the triangle of centre, user and satellite; caps and circles play no part, so
    it checks them.

    Parameters
    ----------
    positions
        Inertial, metres, shape (n, 3).
    sphere_radius, mask
        Metres and radians.
    points
        Unit vectors in the inertial frame, shape (..., 3).
    stretch
        Ratio of the equatorial radius, `sphere_radius`, to the polar one.

    Returns
    -------
    clearance
        Shape (..., n); the fold is the number that are not negative.
    """
    p = np.asarray(points, dtype=float)[..., np.newaxis, :]
    widened = p * [1.0, 1.0, stretch]
    user = sphere_radius * p / np.linalg.norm(widened, axis=-1, keepdims=True)
    normal = widened * [1.0, 1.0, stretch]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    sight = positions - user
    up = (sight * normal).sum(axis=-1)
    level = np.linalg.norm(sight - up[..., np.newaxis] * normal, axis=-1)
    return np.arctan2(up, level) - mask


def caps_of(
    constellation: Constellation, sphere_radius: float, mask: float, time: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inertial unit vectors (n, 3) to the satellites and their cap radii (n,), radians."""
    r = positions_mci(constellation, [time])[:, 0]
    distance = np.linalg.norm(r, axis=-1)
    return r / distance[:, np.newaxis], cap_radius(distance, sphere_radius, mask)

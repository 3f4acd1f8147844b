"""Cartesian states read as others read them: spherical numbers, and axes of the vehicle."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry_geometry import cartesian_jacobian, cartesian_of
from compass.frames import east_north_up, latitude_longitude

Array = NDArray[np.float64]

__all__ = ["along_cross_down", "cartesian_of", "local_axes", "spherical_jacobian", "spherical_of"]


def spherical_of(path: ArrayLike) -> Array:
    """``[r, lon, lat, V, gamma, psi]``, shape (..., 6), of Mars-fixed states (..., 6).

    SI and radians, psi clockwise from north. On the polar axis the longitude is taken as 0, and
    psi counted from that meridian's north; at rest gamma and psi are 0.
    """
    c = np.asarray(path, dtype=float)
    radius, speed = np.linalg.norm(c[..., :3], axis=-1), np.linalg.norm(c[..., 3:], axis=-1)
    lat, lon = latitude_longitude(c[..., :3])
    axes = east_north_up(lat, lon)
    east, north, climb = np.moveaxis((axes @ c[..., 3:, None])[..., 0], -1, 0)
    gamma, psi = np.arctan2(climb, np.hypot(east, north)), np.arctan2(east, north)
    return np.stack([radius, lon, lat, speed, gamma, psi], axis=-1)


def spherical_jacobian(path: ArrayLike) -> Array:
    """Derivative of Cartesian states in the spherical numbers, (..., 6, 6), at states (..., 6).

    A covariance S of the spherical numbers is ``J S J^T`` in Cartesian ones. Finite everywhere;
    singular on the polar axis and for vertical flight.
    """
    flat = spherical_of(path).reshape(-1, 6)
    out = np.empty((len(flat), 6, 6))
    for state, jacobian in zip(flat, out, strict=True):  # a few hundred epochs at most
        cartesian_jacobian(state, jacobian)
    return out.reshape(*np.shape(path)[:-1], 6, 6)


def local_axes(position: ArrayLike) -> Array:
    """Rows east, north and up at a position (..., 3), shape (..., 3, 3)."""
    lat, lon = latitude_longitude(np.asarray(position, dtype=float))
    return east_north_up(lat, lon)


def along_cross_down(path: ArrayLike) -> Array:
    """Rows along the ground track, across it to the right, and down, at states (..., 6)."""
    c = np.asarray(path, dtype=float)
    up = c[..., :3] / np.linalg.norm(c[..., :3], axis=-1, keepdims=True)
    level = c[..., 3:] - (c[..., 3:] * up).sum(axis=-1, keepdims=True) * up
    size = np.linalg.norm(level, axis=-1, keepdims=True)
    east = local_axes(c[..., :3])[..., 0, :]
    along = np.where(size > 0, level / np.where(size > 0, size, 1.0), east)
    return np.stack([along, np.cross(along, up), -up], axis=-2)

"""Cartesian states read as others read them: spherical numbers, and axes of the vehicle."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.frames import east_north_up, latitude_longitude

Array = NDArray[np.float64]


def cartesian_of(states: ArrayLike) -> Array:
    """Mars-fixed positions and velocities, shape (..., 6), of spherical states (..., 6 or more).

    The other way round as `spherical_of`.
    """
    radius, lon, lat, speed, gamma, psi = np.moveaxis(np.asarray(states, dtype=float), -1, 0)[:6]
    axes = east_north_up(lat, lon)
    position = radius[..., None] * axes[..., 2, :]
    return np.concatenate([position, _along(axes, *_parts(speed, gamma, psi))], axis=-1)


def _parts(speed: Array, gamma: Array, psi: Array) -> tuple[Array, Array, Array]:
    """Velocity to the east, to the north and up."""
    level = speed * np.cos(gamma)
    return level * np.sin(psi), level * np.cos(psi), speed * np.sin(gamma)


def _along(axes: Array, east: Array, north: Array, up: Array) -> Array:
    """Vectors of their parts along local axes (..., 3, 3)."""
    return (np.stack([east, north, up], axis=-1)[..., None] * axes).sum(axis=-2)


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
    radius, lon, lat, speed, gamma, psi = np.moveaxis(spherical_of(path), -1, 0)
    axes = east_north_up(lat, lon)
    (x, y), zero = np.moveaxis(np.asarray(path, dtype=float)[..., 3:5], -1, 0), np.zeros_like(lon)
    east, north, up = _parts(speed, gamma, psi)
    climb, level = speed * np.cos(gamma), -speed * np.sin(gamma)
    moved = (
        (zero, zero, np.ones_like(lon)),
        (radius * np.cos(lat), zero, zero),
        (zero, radius, zero),
        *((zero, zero, zero),) * 3,
    )
    turned = (
        np.zeros((*lon.shape, 3)),
        np.stack([-y, x, zero], axis=-1),  # about the pole
        _along(axes, zero, up, -north),  # about the east
        _along(axes, *_parts(np.ones_like(lon), gamma, psi)),
        _along(axes, level * np.sin(psi), level * np.cos(psi), climb),
        _along(axes, north, -east, zero),
    )
    columns = [
        np.concatenate([_along(axes, *parts), change], axis=-1)
        for parts, change in zip(moved, turned, strict=True)
    ]
    return np.stack(columns, axis=-1)


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

"""Random places of users: where each stands over the figure."""

import numpy as np
from numpy.typing import NDArray

from compass.coverage.region import Region
from compass.coverage.users import Users
from compass.frames import direction, east_north_up, latitude_longitude


def points_in(region: Region, rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """So many unit vectors in a convex polygon, of equal chance everywhere, shape (count, 3).

    Those of the circle around it that lie inside; of a sliver some stand for several.
    """
    normals = region.normals
    corners = np.cross(normals, np.roll(normals, -1, axis=0))
    corners *= np.sign((corners @ normals.T).sum(axis=1))[:, np.newaxis]
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    middle = corners.sum(axis=0)
    middle /= np.linalg.norm(middle)
    latitude, longitude = latitude_longitude(middle)
    east, north, up = east_north_up(latitude, longitude)
    reach = float((corners @ middle).min())
    rise, turn = rng.uniform([reach, 0.0], [1.0, 2 * np.pi], (40 * count, 2)).T
    around = direction(np.arcsin(rise), turn) @ np.stack([east, north, up])
    inside = around[region.contains(around)]
    return np.resize(inside if len(inside) else middle, (count, 3))


def stand(
    users: Users, latitude: NDArray[np.float64], up: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Places over the figure at geodetic latitudes, metres, shape (t, 3)."""
    a, b = users.figure.equatorial_radius, users.figure.polar_radius
    across = a * a / np.hypot(a * np.cos(latitude), b * np.sin(latitude))
    radii = np.stack([across, across, across * (b / a) ** 2], axis=-1)
    return (radii + users.height) * up

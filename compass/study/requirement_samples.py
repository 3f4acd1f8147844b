"""Geometry at random places and moments: which candidates are worth a certified figure, and when.

Samples sort candidates and drop those that chance cannot excuse; nothing is proven by them.
"""

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.coverage.region import Region
from compass.coverage.users import Users
from compass.design import Requirement
from compass.frames import (
    direction,
    east_north_up,
    latitude_longitude,
    planetographic_latitude,
    prime_meridian_angle,
)
from compass.orbits import Constellation, states_mci

#: Random places and moments at which geometry is looked at.
SAMPLES = 400


def sampled_geometry(c: Constellation, users: Users, wanted: Requirement) -> tuple[float, float]:
    """Share of random places and moments with the geometry wanted, and the worst over its limit."""
    rng = np.random.default_rng(0)
    times, latitude, longitude = _moments(c, users, rng)
    axes = east_north_up(latitude, longitude)
    r = np.moveaxis(states_mci(c, times)[0], 1, 0)
    sight = r - _stand(users, latitude, axes[:, 2])[:, np.newaxis]
    local = np.einsum("tna,tka->tnk", sight, axes)
    local /= np.linalg.norm(local, axis=-1, keepdims=True)
    elevation = np.arcsin(np.clip(local[..., 2], -1, 1))
    azimuth = np.mod(np.arctan2(local[..., 0], local[..., 1]), 2 * np.pi)
    seen = elevation >= users.mask.at(azimuth) + users.below
    over = over_limits(local, seen, wanted)
    return float(np.mean(over <= 1.0)), float(over.max())


def is_hopeless(share: float, wanted: float) -> bool:
    """Whether a share of samples is so far below the share wanted that chance does not explain it.

    Of what is wanted always, a sample that misses is a miss.
    """
    if wanted == 1.0:
        return share < 1.0
    sigma = np.sqrt(max(wanted * (1.0 - wanted), 1.0 / SAMPLES) / SAMPLES)
    return bool(share < wanted - 4.0 * sigma)


def _moments(
    c: Constellation, users: Users, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Seconds after the epoch, and where users then stand: geodetic latitude, inertial longitude.

    Who stands on Mars under closed tracks keeps to his longitude, or his region's; all others take
    any.
    """
    low, high = np.sin([users.south, users.north])
    latitude = np.arcsin(rng.uniform(low, high, SAMPLES))
    times = rng.uniform(0, 1e7, SAMPLES)
    longitude = rng.uniform(0, 2 * np.pi, SAMPLES)
    if c.repeat is None or users.is_belt:
        return times, latitude, longitude
    if users.longitude is not None:
        longitude = np.full(SAMPLES, users.longitude)
    else:
        centric, longitude = latitude_longitude(points_in(users.region, rng))
        latitude = planetographic_latitude(centric, users.figure)
    turned = prime_meridian_angle(c.epoch, 0.0) + MARS_ROTATION_RATE.value * times
    return times, latitude, longitude + turned


def points_in(region: Region, rng: np.random.Generator) -> NDArray[np.float64]:
    """`SAMPLES` unit vectors in a convex polygon, of equal chance everywhere, shape (s, 3).

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
    rise, turn = rng.uniform([reach, 0.0], [1.0, 2 * np.pi], (40 * SAMPLES, 2)).T
    around = direction(np.arcsin(rise), turn) @ np.stack([east, north, up])
    inside = around[region.contains(around)]
    return np.resize(inside if len(inside) else middle, (SAMPLES, 3))


def _stand(
    users: Users, latitude: NDArray[np.float64], up: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Places over the figure at geodetic latitudes, metres, shape (t, 3)."""
    a, b = users.figure.equatorial_radius, users.figure.polar_radius
    across = a * a / np.hypot(a * np.cos(latitude), b * np.sin(latitude))
    radii = np.stack([across, across, across * (b / a) ** 2], axis=-1)
    return (radii + users.height) * up


def over_limits(
    local: NDArray[np.float64], seen: NDArray[np.bool_], wanted: Requirement
) -> NDArray[np.float64]:
    """Largest dilution over its limit, of east-north-up lines of sight (t, n, 3)."""
    rows = np.concatenate([local, np.ones((*local.shape[:2], 1))], axis=-1) * seen[..., np.newaxis]
    normal = np.einsum("tna,tnb->tab", rows, rows)
    able = (seen.sum(axis=1) >= 4) & (np.linalg.cond(normal) < 1e10)
    normal[~able] = np.eye(4)
    d = np.diagonal(np.linalg.inv(normal), axis1=1, axis2=2)
    squares = {
        "gdop": d.sum(axis=1),
        "pdop": d[:, :3].sum(axis=1),
        "hdop": d[:, 0] + d[:, 1],
        "vdop": d[:, 2],
        "tdop": d[:, 3],
    }
    over = np.max([np.sqrt(squares[name]) / limit for name, limit in wanted.limits], axis=0)
    return np.where(able, over, np.inf)

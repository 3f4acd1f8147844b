"""Keplerian elements from position and velocity."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from compass.bodies import MARS_GM
from compass.errors import ArgumentError
from compass.orbits.constellation import Constellation, keplerian


def from_states(
    r_mci: ArrayLike,
    v_mci: ArrayLike,
    *,
    name: str = "constellation",
    epoch: float = 0.0,
    satellite_names: Sequence[str] = (),
    gm: float = MARS_GM.value,
) -> Constellation:
    """Make a constellation of the osculating ellipses of inertial states at the epoch.

    An equatorial orbit takes its node on the x axis, a circular one its periapsis at the node
    (eccentricity or inclination below 1e-12).

    Parameters
    ----------
    r_mci, v_mci
        Positions, m, and velocities, m/s, shape (n, 3).
    name, epoch, satellite_names, gm
        As in `Constellation`.

    Raises
    ------
    ArgumentError
        A state that is not on an ellipse (parabolic, hyperbolic or radial).

    References
    ----------
    Vallado 2013, Fundamentals of Astrodynamics and Applications, 4th ed., algorithm 9.
    """
    r, v = np.atleast_2d(np.asarray(r_mci, float)), np.atleast_2d(np.asarray(v_mci, float))
    radius = np.linalg.norm(r, axis=1)
    momentum = np.cross(r, v)
    h = np.linalg.norm(momentum, axis=1)
    with np.errstate(divide="ignore"):
        axis = 1.0 / (2.0 / radius - (v * v).sum(axis=1) / gm)
    radial = ~(h > 1e-9 * radius * np.linalg.norm(v, axis=1)) | ~np.isfinite(h)
    open_orbit = ~((axis > 0) & np.isfinite(axis))
    if np.any(radial | open_orbit):
        k = int(np.flatnonzero(radial | open_orbit)[0])
        raise ArgumentError(
            f"state {k + 1}: position {r[k].tolist()} m, velocity {v[k].tolist()} m/s is not on "
            "an ellipse about Mars; check units (m, m/s) and the speed"
        )
    pole = momentum / h[:, None]
    inclination = np.arctan2(np.hypot(pole[:, 0], pole[:, 1]), pole[:, 2])
    tilted = np.hypot(pole[:, 0], pole[:, 1]) > 1e-12
    raan = np.where(tilted, np.arctan2(pole[:, 0], -pole[:, 1]), 0.0)
    node = np.stack([np.cos(raan), np.sin(raan), np.zeros_like(raan)], axis=1)
    ahead = np.cross(pole, node)
    vector = np.cross(v, momentum) / gm - r / radius[:, None]
    eccentricity = np.linalg.norm(vector, axis=1)
    oval = eccentricity > 1e-12
    eccentricity = np.where(oval, eccentricity, 0.0)
    periapsis = np.where(
        oval, np.arctan2((vector * ahead).sum(axis=1), (vector * node).sum(axis=1)), 0.0
    )
    latitude_argument = np.arctan2((r * ahead).sum(axis=1), (r * node).sum(axis=1))
    half = 0.5 * (latitude_argument - periapsis)
    big_e = 2.0 * np.arctan2(
        np.sqrt(1.0 - eccentricity) * np.sin(half), np.sqrt(1.0 + eccentricity) * np.cos(half)
    )
    return keplerian(
        axis,
        eccentricity,
        inclination,
        raan,
        periapsis,
        big_e - eccentricity * np.sin(big_e),
        name=name,
        epoch=epoch,
        satellite_names=satellite_names,
        gm=gm,
    )

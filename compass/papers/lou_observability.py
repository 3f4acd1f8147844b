"""What accelerometers and ranges together let a lander know, density and lift included."""

from math import cos, factorial, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.rates import MU, OMEGA
from compass.core.entry.series import (
    DRAG_ACC,
    LIFT_ACC,
    flow_series,
    orbit_series,
    range_series,
)
from compass.core.jacobi_svd import jacobi_svd
from compass.entry.model import EntryModel
from compass.entry.observability import whole_path
from compass.entry.views import spherical_jacobian

Array = NDArray[np.float64]

#: Radius, longitude, latitude, speed, flight-path angle, heading, ln rho0 and L/D.
STATES = 8


def imu_range_matrix(
    model: EntryModel,
    state: ArrayLike,
    r: Array,
    v: Array,
    orders: int = STATES,
    bank: float = 0.0,
) -> Array:
    """Gradients of the Lie derivatives of three accelerations and m ranges in eight states.

    Rows ``k (3 + m)`` to ``(k + 1) (3 + m) - 1`` are ``grad L_f^k h`` of
    ``h = [-D, -L sin(bank), L cos(bank), R_1, ..., R_m]``; SI and radians, ln rho0 as state.

    Parameters
    ----------
    model, state
        The world and the state of six or eight.
    r, v
        Beacons' positions (m) and velocities (m/s) in the axes of the state, shape (m, 3); one
        without velocity is at rest in them, the others move as two bodies do.
    orders
        Number of Lie derivatives, the zeroth included.
    bank
        Radians.
    """
    p, x, view = model.flight_parameters(), whole_path(model, state), np.eye(STATES)
    view[:6, :6] = spherical_jacobian(x[:6])
    w = flow_series(x, p, cos(bank), sin(bank), orders + 1, STATES)
    drag, lift = w[DRAG_ACC, :orders, 1:], w[LIFT_ACC, :orders, 1:]
    series = [-drag, -sin(bank) * lift, cos(bank) * lift]
    for position, velocity in zip(r, v, strict=True):
        if np.any(velocity):
            beacon = orbit_series(position, velocity, p[MU], p[OMEGA], orders + 1)
        else:
            beacon = np.zeros((3, orders + 1))
            beacon[:, 0] = position
        coefficients = np.empty((orders + 1, 1 + STATES))
        range_series(w[:3], beacon, coefficients)
        series.append(coefficients[:orders, 1:])
    factorials = np.array([float(factorial(k)) for k in range(orders)])
    rows = np.stack(series, axis=1) * factorials[:, None, None]
    return np.ascontiguousarray(rows.reshape(-1, STATES) @ view)


def singular_values(matrix: Array) -> tuple[Array, Array]:
    """Singular values, descending, and right singular vectors (columns), each to rounding."""
    n = matrix.shape[1]
    values, rows = np.empty(n), np.empty((n, n))
    jacobi_svd(np.array(matrix.T, order="C"), values, rows)
    return values, rows.T


def observability_degree(matrix: Array) -> float:
    """``sigma_min / sigma_max`` of an observability matrix: depends on its units."""
    values, _ = singular_values(matrix)
    return float(values[-1] / values[0])


def rotation_about_beacon(state: ArrayLike, beacon: ArrayLike) -> Array:
    """Direction in the eight states that a lone beacon at rest cannot see, shape (8,).

    The whole flight turned about the axis from the planet's centre to the beacon, by one
    radian: ranges and accelerations stay as they are on a planet that does not turn.
    """
    x = np.asarray(state, dtype=float)
    axis = np.asarray(beacon, dtype=float) / np.linalg.norm(beacon)
    lon, lat = x[1], x[2]
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    north = np.cross(up, east)
    moved = np.cross(axis, up)
    d_lon, d_lat = (moved @ east) / cos(lat), moved @ north
    # the azimuth also turns by the axis's part along up, less what the local north turns by
    d_psi = -(axis @ up) + d_lon * sin(lat)
    return np.array([0.0, d_lon, d_lat, 0.0, 0.0, d_psi, 0.0, 0.0])

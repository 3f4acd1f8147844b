"""Objectives of beacon placement, fast enough to be called a hundred thousand times."""

import math

import numpy as np

from compass.core.entry.observe import triple_index
from compass.core.entry.series import flow_series, range_series
from compass.core.jacobi_svd import jacobi_svd
from compass.core.jit import kernel


@kernel
def position_series(path, p, banks, views, orders):
    """Lander position as Taylor series with gradients at each epoch, (t, 3, orders, 7).

    It does not depend on the beacons, so a search over them computes it once. Gradients are in the
    numbers that `views` (t, 6, 6) reads position and velocity in; `path` is (t, 8), see
    `compass.core.entry.series.flow_series`.
    """
    out = np.zeros((path.shape[0], 3, orders, 7))
    for t in range(path.shape[0]):
        w = flow_series(path[t], p, math.cos(banks[t]), math.sin(banks[t]), orders, 6)
        for i in range(3):
            for k in range(orders):
                out[t, i, k, 0] = w[i, k, 0]
                for j in range(6):
                    for a in range(6):
                        out[t, i, k, 1 + j] += w[i, k, 1 + a] * views[t, a, j]
    return out


@kernel
def minimum_degree(series, beacons):
    """Smallest ``sigma_min/sigma_max`` over the epochs, SI, of ranges to beacons (n, 3) at rest."""
    epochs, _, orders, _ = series.shape
    n = beacons.shape[0]
    rows = max(6, n * orders)
    matrix, values, vectors = np.zeros((6, rows)), np.empty(6), np.empty((6, 6))
    beacon, out = np.zeros((3, orders)), np.empty((orders, 7))
    least = np.inf
    for t in range(epochs):
        for b in range(n):
            beacon[:, 0] = beacons[b]
            range_series(series[t], beacon, out)
            factorial = 1.0
            for k in range(orders):
                factorial *= max(1, k)
                for j in range(6):
                    matrix[j, b * orders + k] = factorial * out[k, 1 + j]
        for k in range(n * orders, rows):
            matrix[:, k] = 0.0
        jacobi_svd(matrix, values, vectors)
        least = min(least, values[5] / values[0])
    return least


@kernel
def determinants(lander, beacons, out):
    """``det(sum n n^T)`` at each epoch; lander (t, 3), beacons (t, n, 3)."""
    heard = np.ones(beacons.shape[1], np.bool_)
    for t in range(lander.shape[0]):
        out[t] = triple_index(lander[t], beacons[t], heard)


@kernel
def circle_positions(angles, radius, motion, times, out):
    """Positions (t, n, 3) on circles; `angles` (n, 3): node, inclination, argument of latitude."""
    for b in range(angles.shape[0]):
        cn, sn = math.cos(angles[b, 0]), math.sin(angles[b, 0])
        ci, si = math.cos(angles[b, 1]), math.sin(angles[b, 1])
        for t in range(times.size):
            u = angles[b, 2] + motion * times[t]
            cu, su = math.cos(u), math.sin(u)
            out[t, b, 0] = radius * (cn * cu - sn * ci * su)
            out[t, b, 1] = radius * (sn * cu + cn * ci * su)
            out[t, b, 2] = radius * si * su


@kernel
def view_margins(lander, beacons, planet_radius, out):
    """``cos(theta) - cos(limit)`` of eqs. 58 to 60 into `out` (t, n): positive while in view."""
    for t in range(lander.shape[0]):
        far = math.sqrt(lander[t, 0] ** 2 + lander[t, 1] ** 2 + lander[t, 2] ** 2)
        dip = math.acos(min(1.0, planet_radius / far))
        for b in range(beacons.shape[1]):
            away, product = 0.0, 0.0
            for i in range(3):
                away += beacons[t, b, i] ** 2
                product += beacons[t, b, i] * lander[t, i]
            away = math.sqrt(away)
            limit = dip + math.acos(min(1.0, planet_radius / away))
            out[t, b] = product / (far * away) - math.cos(limit)

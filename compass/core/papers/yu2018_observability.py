"""Observability matrices of a linearised or quadratic flow, as Yu et al. 2018 approximate it."""

import math

import numpy as np

from compass.core.jacobi_svd import jacobi_svd
from compass.core.jit import kernel
from compass.core.papers.spherical import entry_jacobian, entry_rates
from compass.core.papers.spherical_geometry import cartesian, cartesian_jacobian, range_rows

QUADRATIC, PUBLISHED_QUADRATIC, LINEAR = range(3)


@kernel
def approximate_matrix(x, p, r, orders, method, out):
    """Fill the matrix of a linearised flow, for ranges to beacons at rest: row ``k n + i``.

    `QUADRATIC` carries a Hessian beside the gradient, ``J+ = J F + f^T H``,
    ``H+ = H F + F^T H`` (eqs. 13 to 17 of Yu et al. 2018, corrected); `PUBLISHED_QUADRATIC`
    halves ``H+`` as eq. 16 prints it, ``(H + H^T) F / 2``; `LINEAR` is ``J F^k``.
    """
    n = r.shape[0]
    f, full = np.empty(8), np.empty((8, 8))
    entry_rates(x, p, f)
    entry_jacobian(x, p, full)
    c, jc = np.empty(6), np.empty((6, 6))
    cartesian(x, c)
    cartesian_jacobian(x, jc)
    row, rate_row, still = np.empty(6), np.empty(6), np.zeros(3)
    gradient, ahead = np.empty(6), np.empty(6)
    hessian, product = np.empty((6, 6)), np.empty((6, 6))
    for i in range(n):
        range_rows(c, r[i], still, jc, row, rate_row)
        gradient[:] = row
        _range_hessian(x, c, jc, r[i], row, hessian)
        for k in range(orders):
            out[k * n + i] = gradient
            for j in range(6):
                ahead[j] = 0.0
                for q in range(6):
                    ahead[j] += gradient[q] * full[q, j]
                    if method == QUADRATIC:
                        ahead[j] += hessian[q, j] * f[q]
                    elif method == PUBLISHED_QUADRATIC:
                        ahead[j] += 0.5 * (hessian[q, j] + hessian[j, q]) * f[q]
            gradient[:] = ahead
            for a in range(6):
                for b in range(6):
                    product[a, b] = 0.0
                    for q in range(6):
                        both = hessian[a, q] + hessian[q, a]
                        product[a, b] += 0.5 * both * full[q, b]
            for a in range(6):
                for b in range(6):
                    if method == PUBLISHED_QUADRATIC:
                        hessian[a, b] = product[a, b]
                    else:
                        hessian[a, b] = product[a, b] + product[b, a]


@kernel
def _range_hessian(x, c, jc, beacon, row, out):
    """Second derivative of the range in the state; only radius, longitude and latitude matter.

    ``H = (P^T P - g g^T)/R + sum_i n_i d2 c_i`` with ``P = dr/dx``, ``g = dR/dx``.
    """
    out[:, :] = 0.0
    d = c[:3] - beacon
    distance = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    for a in range(3):
        for b in range(3):
            total = -row[a] * row[b]
            for i in range(3):
                total += jc[i, a] * jc[i, b]
            out[a, b] = total / distance
    nx, ny, nz = d[0] / distance, d[1] / distance, d[2] / distance
    tan_lat = math.tan(x[2])
    r_lon = (nx * jc[0, 1] + ny * jc[1, 1]) / x[0]
    r_lat = (nx * jc[0, 2] + ny * jc[1, 2] + nz * jc[2, 2]) / x[0]
    out[0, 1] += r_lon
    out[1, 0] += r_lon
    out[0, 2] += r_lat
    out[2, 0] += r_lat
    out[1, 1] -= nx * c[0] + ny * c[1]
    out[2, 2] -= nx * c[0] + ny * c[1] + nz * c[2]
    cross = -tan_lat * x[0] * r_lon
    out[1, 2] += cross
    out[2, 1] += cross


@kernel
def approximate_degrees(states, p, r, orders, method, out):
    """``sigma_min / sigma_max`` at each epoch; states (t, 8), beacons (t, n, 3), out (t,)."""
    rows = r.shape[1] * orders
    matrix, columns = np.empty((rows, 6)), np.zeros((6, max(6, rows)))
    values, vectors = np.empty(6), np.empty((6, 6))
    for t in range(states.shape[0]):
        approximate_matrix(states[t], p, r[t], orders, method, matrix)
        for k in range(rows):
            for j in range(6):
                columns[j, k] = matrix[k, j]
        jacobi_svd(columns, values, vectors)
        out[t] = values[5] / values[0]

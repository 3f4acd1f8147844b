"""Observability matrices of radio ranges along an entry: exact, quadratic and linear."""

import math

import numpy as np

from compass.core.entry_dynamics import BANK, MU, OMEGA, entry_jacobian, entry_rates
from compass.core.entry_geometry import cartesian, cartesian_jacobian, range_rows
from compass.core.entry_jets import X, Z, flow_series, orbit_series, range_series
from compass.core.jacobi_svd import jacobi_svd
from compass.core.jit import kernel

EXACT, QUADRATIC, PUBLISHED_QUADRATIC, LINEAR = range(4)


@kernel
def exact_matrix(x, p, r, v, moving, use_range, use_rate, orders, duals, out, lie):
    """Gradients of the Lie derivatives of ranges and range rates, orders 0 to ``orders - 1``.

    Row ``k m + 2 i`` of `out` is ``grad L_f^k`` of the range to beacon i, the next row that of
    its range rate (``L_f^k R' = L_f^(k+1) R``), with ``m = 2 n``; `lie` holds the Lie
    derivatives themselves. Rows not used are zero. A moving beacon is carried along its
    two-body orbit.
    """
    n = r.shape[0]
    out[:, :] = 0.0
    lie[:] = 0.0
    any_rate = False
    for i in range(n):
        any_rate = any_rate or use_rate[i]
    terms = orders + 1 if any_rate else orders
    w = flow_series(x, p, terms, duals)
    series = np.empty((terms, 1 + duals))
    for i in range(n):
        if not (use_range[i] or use_rate[i]):
            continue
        if moving[i]:
            beacon = orbit_series(r[i], v[i], p[MU], p[OMEGA], terms)
        else:
            beacon = np.zeros((3, terms))
            beacon[:, 0] = r[i]
        range_series(w[X : Z + 1], beacon, series)
        factorial = 1.0
        for k in range(terms):
            if k > 0:
                factorial *= k
            if use_range[i] and k < orders:
                row = 2 * (k * n + i)
                lie[row] = factorial * series[k, 0]
                for j in range(duals):
                    out[row, j] = factorial * series[k, 1 + j]
            if use_rate[i] and k > 0:
                row = 2 * ((k - 1) * n + i) + 1
                lie[row] = factorial * series[k, 0]
                for j in range(duals):
                    out[row, j] = factorial * series[k, 1 + j]


@kernel
def approximate_matrix(x, p, r, use_range, orders, method, out):
    """Fill the matrix of a linearised flow, for ranges to beacons at rest (rows as above).

    `QUADRATIC` carries a Hessian beside the gradient, ``J+ = J F + f^T H``,
    ``H+ = H F + F^T H`` (eqs. 13 to 17 of Yu et al. 2018, corrected); `PUBLISHED_QUADRATIC`
    halves ``H+`` as eq. 16 prints it, ``(H + H^T) F / 2``; `LINEAR` is ``J F^k``.
    """
    n = r.shape[0]
    out[:, :] = 0.0
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
        if not use_range[i]:
            continue
        range_rows(c, r[i], still, jc, row, rate_row)
        gradient[:] = row
        _range_hessian(x, c, jc, r[i], row, hessian)
        for k in range(orders):
            out[2 * (k * n + i)] = gradient
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
def observe_epochs(
    states, p, banks, r, v, moving, use_range, use_rate, orders, method, scales, singular, index
):
    """Singular values of the matrix at each epoch in several scalings, and eq. 54's index.

    Parameters
    ----------
    states, banks
        (t, 8) and (t,).
    r, v, use_range, use_rate
        Beacons, (t, n, 3) and (t, n).
    scales
        Shape (s, 9), one scaling a row: factors of range rows, of range-rate rows and of each
        further order, then of the six columns.
    singular, index
        Outputs, (s, t, 6) and (t,).
    """
    epochs, n = states.shape[0], r.shape[1]
    p = p.copy()
    rows = 2 * n * orders
    matrix, lie = np.zeros((rows, 6)), np.empty(rows)
    packed, vectors = np.zeros((6, max(rows, 6))), np.empty((6, 6))
    for t in range(epochs):
        p[BANK] = banks[t]
        if method == EXACT:
            exact_matrix(
                states[t], p, r[t], v[t], moving, use_range[t], use_rate[t], orders, 6, matrix, lie
            )
        else:
            approximate_matrix(states[t], p, r[t], use_range[t], orders, method, matrix)
        for s in range(scales.shape[0]):
            count = 0
            power = 1.0
            for k in range(orders):
                for i in range(2 * n):
                    if not (use_range[t, i // 2] if i % 2 == 0 else use_rate[t, i // 2]):
                        continue
                    factor = scales[s, i % 2] * power
                    for j in range(6):
                        packed[j, count] = matrix[2 * k * n + i, j] * factor * scales[s, 3 + j]
                    count += 1
                power *= scales[s, 2]
            packed[:, count:] = 0.0
            jacobi_svd(packed[:, : max(6, count)], singular[s, t], vectors)
        index[t] = _triple_index(states[t], r[t], use_range[t], use_rate[t])


@kernel
def _triple_index(x, r, use_range, use_rate):
    """``det(sum n n^T)``: by Cauchy and Binet the sum over triples of eq. 54."""
    c = np.empty(6)
    cartesian(x, c)
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(r.shape[0]):
        if not (use_range[i] or use_rate[i]):
            continue
        dx, dy, dz = c[0] - r[i, 0], c[1] - r[i, 1], c[2] - r[i, 2]
        square = dx * dx + dy * dy + dz * dz
        xx += dx * dx / square
        yy += dy * dy / square
        zz += dz * dz / square
        xy += dx * dy / square
        xz += dx * dz / square
        yz += dy * dz / square
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)

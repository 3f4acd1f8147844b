"""Observability matrices of radio ranges and range rates along a flight."""

import math

import numpy as np

from compass.core.entry.rates import MU, OMEGA
from compass.core.entry.series import flow_series, orbit_series, range_series
from compass.core.jacobi_svd import jacobi_svd
from compass.core.jit import kernel


@kernel
def lie_gradients(x, p, bank, r, v, moving, use_range, use_rate, orders, out, lie):
    """Gradients of the Lie derivatives of ranges and range rates, orders 0 to ``orders - 1``.

    Row ``k m + 2 i`` of `out` is ``grad L_f^k`` of the range to beacon i in position and velocity,
    the next row that of its range rate (``L_f^k R' = L_f^(k+1) R``), with ``m = 2 n``; `lie` holds
    the Lie derivatives themselves. Rows not used are zero. A moving beacon is carried along its
    two-body orbit. `x` and `p` are those of `compass.core.entry.series.flow_series`.
    """
    n = r.shape[0]
    out[:, :] = 0.0
    lie[:] = 0.0
    any_rate = False
    for i in range(n):
        any_rate = any_rate or use_rate[i]
    terms = orders + 1 if any_rate else orders
    w = flow_series(x, p, math.cos(bank), math.sin(bank), terms, 6)
    series = np.empty((terms, 7))
    for i in range(n):
        if not (use_range[i] or use_rate[i]):
            continue
        if moving[i]:
            beacon = orbit_series(r[i], v[i], p[MU], p[OMEGA], terms)
        else:
            beacon = np.zeros((3, terms))
            beacon[:, 0] = r[i]
        range_series(w[:3], beacon, series)
        factorial = 1.0
        for k in range(terms):
            if k > 0:
                factorial *= k
            if use_range[i] and k < orders:
                row = 2 * (k * n + i)
                lie[row] = factorial * series[k, 0]
                for j in range(6):
                    out[row, j] = factorial * series[k, 1 + j]
            if use_rate[i] and k > 0:
                row = 2 * ((k - 1) * n + i) + 1
                lie[row] = factorial * series[k, 0]
                for j in range(6):
                    out[row, j] = factorial * series[k, 1 + j]


@kernel
def observe_epochs(
    path, p, banks, r, v, moving, use_range, use_rate, orders, views, rows, singular, index
):
    """Singular values of the matrix at each epoch, read in several ways, and eq. 54's index.

    Parameters
    ----------
    path, banks
        (t, 8) and (t,), see `compass.core.entry.series.flow_series`.
    r, v, use_range, use_rate
        Beacons, (t, n, 3) and (t, n).
    views
        (s, t, 6, 6): derivative of position and velocity in the numbers of each way of reading.
    rows
        (s, 3): factors of range rows, of range-rate rows and of each further order.
    singular, index
        Outputs, (s, t, 6) and (t,).
    """
    epochs, n = path.shape[0], r.shape[1]
    count = 2 * n * orders
    matrix, lie = np.zeros((count, 6)), np.empty(count)
    packed, vectors = np.zeros((6, max(count, 6))), np.empty((6, 6))
    for t in range(epochs):
        lie_gradients(
            path[t], p, banks[t], r[t], v[t], moving, use_range[t], use_rate[t], orders, matrix, lie
        )
        for s in range(views.shape[0]):
            filled = read_matrix(
                matrix, use_range[t], use_rate[t], orders, views[s, t], rows[s], packed
            )
            jacobi_svd(packed[:, : max(6, filled)], singular[s, t], vectors)
        index[t] = triple_index(path[t], r[t], use_range[t] | use_rate[t])


@kernel
def read_matrix(matrix, use_range, use_rate, orders, view, rows, packed):
    """Write the used rows of a matrix, in other coordinates and units, as columns; how many."""
    count, power, n = 0, 1.0, use_range.size
    for k in range(orders):
        for i in range(2 * n):
            if not (use_range[i // 2] if i % 2 == 0 else use_rate[i // 2]):
                continue
            for j in range(6):
                total = 0.0
                for a in range(6):
                    total += matrix[2 * k * n + i, a] * view[a, j]
                packed[j, count] = rows[i % 2] * power * total
            count += 1
        power *= rows[2]
    packed[:, count:] = 0.0
    return count


@kernel
def triple_index(x, r, heard):
    """``det(sum n n^T)``: by Cauchy and Binet the sum over triples of eq. 54.

    From `x`, whose first three are the place, to the beacons `r` (n, 3) that are `heard` (n,).
    """
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(r.shape[0]):
        if not heard[i]:
            continue
        dx, dy, dz = x[0] - r[i, 0], x[1] - r[i, 1], x[2] - r[i, 2]
        square = dx * dx + dy * dy + dz * dz
        xx += dx * dx / square
        yy += dy * dy / square
        zz += dz * dz / square
        xy += dx * dy / square
        xz += dx * dz / square
        yz += dy * dz / square
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)

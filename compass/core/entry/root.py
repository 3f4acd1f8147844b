"""A filter's covariance carried as a root, ``P = S S^T``: rounding cannot make it negative.

Where ranges are a million times better than what was known before, a covariance loses in its
difference ``P - g g^T / s`` what is left of it; a root has half of the digits to bear. S is upper
triangular. Measurements come in by Carlson's update (1973, AIAA J. 11:1259), time by a modified
Gram and Schmidt orthogonalisation of ``[F S, G, W^(1/2)]`` (Bierman 1977, Factorization Methods for
Discrete Sequential Estimation, chapter 6).
"""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def root_of(covariance, out):
    """Upper triangular S of ``P = S S^T``, into `out`; what is not positive is taken as zero."""
    n = covariance.shape[0]
    out[:, :] = 0.0
    for j in range(n - 1, -1, -1):
        total = covariance[j, j]
        for k in range(j + 1, n):
            total -= out[j, k] * out[j, k]
        out[j, j] = math.sqrt(max(0.0, total))
        for i in range(j):
            total = covariance[i, j]
            for k in range(j + 1, n):
                total -= out[i, k] * out[j, k]
            out[i, j] = total / out[j, j] if out[j, j] > 0.0 else 0.0


@kernel
def square_of(root, out):
    """``P = S S^T``, into `out`."""
    n = root.shape[0]
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(i, n):
                total += root[i, k] * root[j, k]
            out[i, j] = total
            out[j, i] = total


@kernel
def triangle(rows, root):
    """Upper triangular S with ``S S^T = A A^T``, A the `rows` (n, k), which are spoilt."""
    n = rows.shape[0]
    root[:, :] = 0.0
    for i in range(n - 1, -1, -1):
        size = math.sqrt((rows[i] * rows[i]).sum())
        root[i, i] = size
        if size == 0.0:
            continue
        for k in range(i):
            along = (rows[k] * rows[i]).sum() / size
            root[k, i] = along
            for c in range(rows.shape[1]):
                rows[k, c] -= along / size * rows[i, c]


@kernel
def absorb_root(row, residual, variance, estimated, gain, root, shift):
    """As `compass.core.entry.update.absorb`, of a root: Carlson's update, then what Schmidt keeps.

    The best gain would correct considered states too: what that takes from their covariance,
    ``g g^T / s`` of theirs, is put back by rotations of the columns.
    """
    n, before = row.size, variance
    back = np.zeros(n)
    for i in range(n):
        gain[i] = 0.0
        residual -= row[i] * shift[i]
    for j in range(n):
        f = 0.0
        for i in range(j + 1):
            f += root[i, j] * row[i]
        after = before + f * f
        keep, take = math.sqrt(before / after), f / math.sqrt(before * after)
        for i in range(j + 1):
            old = root[i, j]
            root[i, j] = keep * old - take * gain[i]
            gain[i] += old * f
        before = after
    for i in range(estimated):
        shift[i] += gain[i] / before * residual
    if estimated == n:
        return
    for i in range(estimated, n):
        back[i] = gain[i] / math.sqrt(before)
    for j in range(n - 1, -1, -1):
        size = math.hypot(root[j, j], back[j])
        if size == 0.0:
            continue
        c, s = root[j, j] / size, back[j] / size
        for i in range(j + 1):
            old = root[i, j]
            root[i, j] = c * old + s * back[i]
            back[i] = c * back[i] - s * old

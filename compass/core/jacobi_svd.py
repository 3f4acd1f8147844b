"""Singular values by one-sided Jacobi rotations.

Where an ordinary decomposition is good to rounding times the *largest* singular value, this one
is good to rounding times each singular value once the columns are scaled alike: what is needed
for a ratio of 1e-8 between columns in metres and columns in radians.

References
----------
Demmel and Veselic 1992, Jacobi's Method is More Accurate than QR, SIAM J. Matrix Anal. Appl. 13.
"""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def jacobi_svd(a, values, vectors):
    """Singular values, descending, and right singular vectors (columns) of `a` (m by n, m >= n).

    `a` is overwritten; `values` has shape (n,), `vectors` (n, n). A matrix with fewer rows than
    columns needs zero rows put below it.
    """
    m, n = a.shape
    for i in range(n):
        for j in range(n):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(60):
        turned = False
        for i in range(n - 1):
            for j in range(i + 1, n):
                alpha, beta, gamma = 0.0, 0.0, 0.0
                for k in range(m):
                    alpha += a[k, i] * a[k, i]
                    beta += a[k, j] * a[k, j]
                    gamma += a[k, i] * a[k, j]
                if not abs(gamma) > 2.3e-16 * math.sqrt(alpha) * math.sqrt(beta):
                    continue
                turned = True
                zeta = (beta - alpha) / (2.0 * gamma)
                t = math.copysign(1.0, zeta) / (abs(zeta) + math.sqrt(1.0 + zeta * zeta))
                c = 1.0 / math.sqrt(1.0 + t * t)
                s = c * t
                for k in range(m):
                    u, v = a[k, i], a[k, j]
                    a[k, i], a[k, j] = c * u - s * v, s * u + c * v
                for k in range(n):
                    u, v = vectors[k, i], vectors[k, j]
                    vectors[k, i], vectors[k, j] = c * u - s * v, s * u + c * v
        if not turned:
            break
    for i in range(n):
        total = 0.0
        for k in range(m):
            total += a[k, i] * a[k, i]
        values[i] = math.sqrt(total)
    for i in range(n - 1):  # selection sort: n is six or eight
        best = i
        for j in range(i + 1, n):
            if values[j] > values[best]:
                best = j
        if best != i:
            values[i], values[best] = values[best], values[i]
            for k in range(n):
                vectors[k, i], vectors[k, best] = vectors[k, best], vectors[k, i]


def singular_values(a):
    """Singular values of a matrix, descending, by `jacobi_svd`."""
    m, n = np.shape(a)
    work = np.zeros((max(m, n), n))
    work[:m] = a
    values, vectors = np.empty(n), np.empty((n, n))
    jacobi_svd(work, values, vectors)
    return values

"""Singular values by one-sided Jacobi rotations.

Where an ordinary decomposition is good to rounding times the *largest* singular value, this one
is good to rounding times each singular value once the columns are scaled alike: what is needed
for a ratio of 1e-8 between columns in metres and columns in radians.

References
----------
Demmel and Veselic 1992, Jacobi's Method is More Accurate than QR, SIAM J. Matrix Anal. Appl. 13.
"""

import math

from compass.core.jit import fast_kernel

#: Columns whose squared norm is below this are zero: rounding has left them nothing else.
LEAST_SQUARE = 1e-200


@fast_kernel
def jacobi_svd(columns, values, vectors):
    """Singular values, descending, and right singular vectors of a matrix given by its columns.

    Parameters
    ----------
    columns
        The matrix transposed, (n, m) with m >= n, so that each column lies together; overwritten.
        A matrix with fewer rows than columns needs zero rows put below it.
    values
        Output, (n,).
    vectors
        Output, (n, n), one vector a row.
    """
    n, m = columns.shape
    for i in range(n):
        for j in range(n):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(60):
        turned = False
        for i in range(n - 1):
            for j in range(i + 1, n):
                alpha, beta, gamma = 0.0, 0.0, 0.0
                for k in range(m):
                    alpha += columns[i, k] * columns[i, k]
                    beta += columns[j, k] * columns[j, k]
                    gamma += columns[i, k] * columns[j, k]
                if alpha < LEAST_SQUARE or beta < LEAST_SQUARE:
                    continue
                # orthogonal to a few roundings of the dot product
                if not abs(gamma) > 1e-15 * math.sqrt(alpha) * math.sqrt(beta):
                    continue
                turned = True
                zeta = (beta - alpha) / (2.0 * gamma)
                t = math.copysign(1.0, zeta) / (abs(zeta) + math.hypot(1.0, zeta))
                c = 1.0 / math.sqrt(1.0 + t * t)
                s = c * t
                for k in range(m):
                    u, v = columns[i, k], columns[j, k]
                    columns[i, k] = c * u - s * v
                    columns[j, k] = s * u + c * v
                for k in range(n):
                    u, v = vectors[i, k], vectors[j, k]
                    vectors[i, k] = c * u - s * v
                    vectors[j, k] = s * u + c * v
        if not turned:
            break
    for i in range(n):
        total = 0.0
        for k in range(m):
            total += columns[i, k] * columns[i, k]
        values[i] = math.sqrt(total)
    for i in range(n - 1):  # selection sort: n is six or eight
        best = i
        for j in range(i + 1, n):
            if values[j] > values[best]:
                best = j
        if best != i:
            values[i], values[best] = values[best], values[i]
            for k in range(n):
                vectors[i, k], vectors[best, k] = vectors[best, k], vectors[i, k]

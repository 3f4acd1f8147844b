"""Small symmetric matrices, worked in place: products, Cholesky factors, inverses.

The filters spend their time on 6 to 11 states, where the call overhead of a library is larger
than the arithmetic; these loops allocate nothing.
"""

import math

from compass.core.jit import fast_kernel, kernel


@fast_kernel
def matmul(a, b, out):
    """Write ``a b`` into `out` (not one of the factors), of the rows of `b` that `a` takes."""
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            total = 0.0
            for k in range(a.shape[1]):
                total += a[i, k] * b[k, j]
            out[i, j] = total


@kernel
def cholesky(a, out):
    """Write the lower Cholesky factor of `a` into `out`; False if `a` is not positive definite.

    Only the lower triangle of `a` is read; `out` may be `a`, and its upper triangle is left.
    """
    n = a.shape[0]
    for j in range(n):
        total = a[j, j]
        for k in range(j):
            total -= out[j, k] * out[j, k]
        if not total > 0.0 or total == math.inf:
            return False
        pivot = math.sqrt(total)
        out[j, j] = pivot
        inverse = 1.0 / pivot
        for i in range(j + 1, n):
            total = a[i, j]
            for k in range(j):
                total -= out[i, k] * out[j, k]
            out[i, j] = total * inverse
    return True


@kernel
def cholesky_solve(factor, b):
    """Solve ``L L^T x = b`` in place of the vector `b`."""
    n = factor.shape[0]
    for i in range(n):
        total = b[i]
        for k in range(i):
            total -= factor[i, k] * b[k]
        b[i] = total / factor[i, i]
    for i in range(n - 1, -1, -1):
        total = b[i]
        for k in range(i + 1, n):
            total -= factor[k, i] * b[k]
        b[i] = total / factor[i, i]


@kernel
def log_determinant(factor):
    """Log-determinant of the matrix whose Cholesky factor is given."""
    total = 0.0
    for i in range(factor.shape[0]):
        total += math.log(factor[i, i])
    return 2.0 * total


@kernel
def invert(a, out, work):
    """Write the inverse of a symmetric positive definite matrix; False if it is not one.

    By its Cholesky factor, whose relative errors do not depend on the units of the rows
    (Demmel 1989), so metres beside radians cost no digits. `work` is scratch of the same shape.
    """
    n = a.shape[0]
    if not cholesky(a, work):
        return False
    for j in range(n):  # the factor's inverse, in place, column by column
        work[j, j] = 1.0 / work[j, j]
        for i in range(j + 1, n):
            total = 0.0
            for k in range(j, i):
                total += work[i, k] * work[k, j]
            work[i, j] = -total / work[i, i]
    for i in range(n):
        for j in range(i, n):
            total = 0.0
            for k in range(j, n):
                total += work[k, i] * work[k, j]
            out[i, j] = total
            out[j, i] = total
    return True


@kernel
def solve_general(a, b):
    """Solve ``A X = B`` in place of `b` (n, k) by elimination with row pivoting; `a` is lost.

    False if `a` is singular.
    """
    n, columns = a.shape[0], b.shape[1]
    for j in range(n):
        pivot = j
        for i in range(j + 1, n):
            if abs(a[i, j]) > abs(a[pivot, j]):
                pivot = i
        if not abs(a[pivot, j]) > 0.0:
            return False
        if pivot != j:
            for k in range(j, n):
                a[j, k], a[pivot, k] = a[pivot, k], a[j, k]
            for k in range(columns):
                b[j, k], b[pivot, k] = b[pivot, k], b[j, k]
        inverse = 1.0 / a[j, j]
        for i in range(j + 1, n):
            factor = a[i, j] * inverse
            if factor != 0.0:
                for k in range(j + 1, n):
                    a[i, k] -= factor * a[j, k]
                for k in range(columns):
                    b[i, k] -= factor * b[j, k]
    for j in range(n - 1, -1, -1):
        inverse = 1.0 / a[j, j]
        for k in range(columns):
            total = b[j, k]
            for i in range(j + 1, n):
                total -= a[j, i] * b[i, k]
            b[j, k] = total * inverse
    return True

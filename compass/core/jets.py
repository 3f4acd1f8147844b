"""Truncated Taylor arithmetic with gradients.

A series is an array of shape (K, 1 + d): row k holds the k-th Taylor coefficient in time and
its gradient with respect to d initial values. Each function writes row `k` of its result from
rows 0 to k of its arguments, so a differential equation's solution grows order by order.

References
----------
Griewank and Walther 2008, Evaluating Derivatives, 2nd ed., SIAM, Table 13.2.
"""

import math

from compass.core.jit import fast_kernel


@fast_kernel
def _add_product(weight, a, i, b, j, out, k):
    """``out_k += weight a_i b_j``, gradients too."""
    ai, bj = weight * a[i, 0], b[j, 0]
    out[k, 0] += ai * bj
    wb = weight * bj
    for q in range(1, out.shape[1]):
        out[k, q] += ai * b[j, q] + wb * a[i, q]


@fast_kernel
def _divide(out, k, b):
    """``out_k /= b_0``, gradients too."""
    inverse = 1.0 / b[0, 0]
    quotient = out[k, 0] * inverse
    out[k, 0] = quotient
    for q in range(1, out.shape[1]):
        out[k, q] = (out[k, q] - quotient * b[0, q]) * inverse


@fast_kernel
def accumulate(a, b, k, out, scale):
    """Add row k of ``scale a b``."""
    for i in range(k + 1):
        _add_product(scale, a, i, b, k - i, out, k)


@fast_kernel
def multiply(a, b, k, out, scale=1.0):
    """Row k of ``scale a b``."""
    out[k, :] = 0.0
    accumulate(a, b, k, out, scale)


@fast_kernel
def reciprocal(b, k, out):
    """Row k of ``1 / b``."""
    out[k, :] = 0.0
    if k == 0:
        out[0, 0] = 1.0
    for i in range(1, k + 1):
        _add_product(-1.0, b, i, out, k - i, out, k)
    _divide(out, k, b)


@fast_kernel
def square_root(a, k, out):
    """Row k of ``sqrt(a)``."""
    if k == 0:
        root = math.sqrt(a[0, 0])
        out[0, 0] = root
        for q in range(1, out.shape[1]):
            out[0, q] = 0.5 * a[0, q] / root
        return
    for q in range(out.shape[1]):
        out[k, q] = 0.5 * a[k, q]
    for i in range(1, k):
        _add_product(-0.5, out, i, out, k - i, out, k)
    _divide(out, k, out)


@fast_kernel
def exponential(a, k, out):
    """Row k of ``exp(a)``."""
    out[k, :] = 0.0
    if k == 0:
        out[0, 0] = math.exp(a[0, 0])
        for q in range(1, out.shape[1]):
            out[0, q] = out[0, 0] * a[0, q]
        return
    for i in range(1, k + 1):
        _add_product(i / k, a, i, out, k - i, out, k)

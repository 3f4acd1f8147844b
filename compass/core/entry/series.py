"""The flight as a Taylor series with gradients, and what is measured along it.

``grad L_f^k h = k!`` times the gradient of the k-th Taylor coefficient of ``h(x(t))``. The right-
hand side is that of `compass.core.entry.rates`, written in series: with ``w`` the velocity through
the air, V its size and ``n = w x u``, drag is ``-rho B V w / 2``, and lift
``kappa rho B V (cos(bank) n x w + V sin(bank) n) / (2 |n|)``.
"""

import numpy as np

from compass.core.entry.rates import (
    CENTRIFUGAL,
    DRAG,
    MU,
    OBLATE,
    OMEGA,
    ROTATION,
    SWAPPED,
    WINDS,
    log_density,
    wind_speeds,
)
from compass.core.jets import accumulate, exponential, multiply, reciprocal, square_root
from compass.core.jit import fast_kernel

# Places in the workspace, vectors by their first: the eight states, then what rates are made of.
POSITION, VELOCITY, THICKER, KAPPA, UP, AIR, ACROSS, RAISED, FORCE = 0, 3, 6, 7, 8, 11, 14, 17, 20
(SQUARE, R, INV_R, INV_SQUARE, PULL, SINE_SQUARE, ALONG) = range(23, 30)
(FLAT_SQUARE, FLAT, INV_FLAT, COS_LON, SIN_LON, COS_LAT, EAST, NORTH, INWARD) = range(30, 39)
(LOG_RHO, RHO, SPEED_SQUARE, SPEED, DRAG_V, DRAG_ACC, LIFT_V, LIFT_ACC) = range(39, 47)
(N_SQUARE, N, INV_N, RAISING, SIDEWAYS, TURN, SHARE, INV_N_SQUARE) = range(47, 55)
SLOTS = 55


@fast_kernel
def flow_series(x, p, cos_bank, sin_bank, orders, duals):
    """Taylor coefficients 0 to ``orders - 1`` of the flow through `x`, with gradients.

    Parameters
    ----------
    x
        Position, velocity, what is added to the logarithm of the density, and L/D, (8,).
    p, cos_bank, sin_bank
        As in `compass.core.entry.rates.acceleration`.
    orders
        Number of coefficients.
    duals
        Leading states the gradient is taken in: 6, or 8 with density and L/D.

    Returns
    -------
    w
        Shape (SLOTS, orders, 1 + duals): slots 0 to 7 the states, `DRAG_ACC` and `LIFT_ACC` the
        accelerations, which lack the last order.
    """
    w = np.zeros((SLOTS, orders, 1 + duals))
    for i in range(8):
        w[i, 0, 0] = x[i]
        if i < duals:
            w[i, 0, 1 + i] = 1.0
    swapped = p[ROTATION] == SWAPPED
    lifted = x[KAPPA] != 0.0 or duals > KAPPA or swapped
    for k in range(orders - 1):
        _place(w, k, p)
        _aerodynamics(w, k, p)
        w[FORCE : FORCE + 3, k] = 0.0
        _gravity(w, k, p)
        for i in range(3):
            accumulate(w[DRAG_V], w[AIR + i], k, w[FORCE + i], -1.0)
        if lifted:
            _lift(w, k, p, cos_bank, sin_bank, swapped)
        turn = 2.0 * p[OMEGA]
        for q in range(1 + duals):
            if not swapped:
                w[FORCE, k, q] += turn * w[VELOCITY + 1, k, q]
                w[FORCE + 1, k, q] -= turn * w[VELOCITY, k, q]
            for i in range(3):
                if p[ROTATION] == CENTRIFUGAL and i < 2:
                    w[FORCE + i, k, q] += p[OMEGA] * p[OMEGA] * w[POSITION + i, k, q]
                w[POSITION + i, k + 1, q] = w[VELOCITY + i, k, q] / (k + 1)
                w[VELOCITY + i, k + 1, q] = w[FORCE + i, k, q] / (k + 1)
    return w


@fast_kernel
def _inner(w, a, b, k, out):
    """Row k of the inner product of two vectors."""
    w[out, k] = 0.0
    for i in range(3):
        accumulate(w[a + i], w[b + i], k, w[out], 1.0)


@fast_kernel
def _cross(w, a, b, k, out):
    """Row k of the cross product of two vectors."""
    for i in range(3):
        h, j = (i + 1) % 3, (i + 2) % 3
        multiply(w[a + h], w[b + j], k, w[out + i])
        accumulate(w[a + j], w[b + h], k, w[out + i], -1.0)


@fast_kernel
def _place(w, k, p):
    """Row k of the distance, the vertical and the velocity through the air."""
    _inner(w, POSITION, POSITION, k, SQUARE)
    square_root(w[SQUARE], k, w[R])
    reciprocal(w[R], k, w[INV_R])
    for i in range(3):
        multiply(w[POSITION + i], w[INV_R], k, w[UP + i])
        w[AIR + i, k] = w[VELOCITY + i, k]
    if p[WINDS] == 0.0 or (w[POSITION, 0, 0] == 0.0 and w[POSITION + 1, 0, 0] == 0.0):
        return  # on the polar axis there is no east
    east, north, de, dn = wind_speeds(w[R, 0, 0], p)
    for q in range(w.shape[2]):
        w[EAST, k, q], w[NORTH, k, q] = de * w[R, k, q], dn * w[R, k, q]
    if k == 0:
        w[EAST, 0, 0], w[NORTH, 0, 0] = east, north
    multiply(w[POSITION], w[POSITION], k, w[FLAT_SQUARE])
    accumulate(w[POSITION + 1], w[POSITION + 1], k, w[FLAT_SQUARE], 1.0)
    square_root(w[FLAT_SQUARE], k, w[FLAT])
    reciprocal(w[FLAT], k, w[INV_FLAT])
    multiply(w[POSITION], w[INV_FLAT], k, w[COS_LON])
    multiply(w[POSITION + 1], w[INV_FLAT], k, w[SIN_LON])
    multiply(w[NORTH], w[UP + 2], k, w[INWARD])
    accumulate(w[EAST], w[SIN_LON], k, w[AIR], 1.0)
    accumulate(w[INWARD], w[COS_LON], k, w[AIR], 1.0)
    accumulate(w[EAST], w[COS_LON], k, w[AIR + 1], -1.0)
    accumulate(w[INWARD], w[SIN_LON], k, w[AIR + 1], 1.0)
    multiply(w[FLAT], w[INV_R], k, w[COS_LAT])
    accumulate(w[NORTH], w[COS_LAT], k, w[AIR + 2], -1.0)


@fast_kernel
def _aerodynamics(w, k, p):
    """Row k of drag and lift, and of both over the speed."""
    height, slope = log_density(w[R, 0, 0], p)
    for q in range(w.shape[2]):
        w[LOG_RHO, k, q] = w[THICKER, k, q] + slope * w[R, k, q]
    if k == 0:
        w[LOG_RHO, 0, 0] = w[THICKER, 0, 0] + height
    exponential(w[LOG_RHO], k, w[RHO])
    _inner(w, AIR, AIR, k, SPEED_SQUARE)
    square_root(w[SPEED_SQUARE], k, w[SPEED])
    multiply(w[RHO], w[SPEED], k, w[DRAG_V], 0.5 * p[DRAG])
    multiply(w[DRAG_V], w[SPEED], k, w[DRAG_ACC])
    multiply(w[KAPPA], w[DRAG_V], k, w[LIFT_V])
    multiply(w[LIFT_V], w[SPEED], k, w[LIFT_ACC])


@fast_kernel
def _gravity(w, k, p):
    """Add row k of the pull of a point, and of the second zonal."""
    multiply(w[INV_R], w[INV_R], k, w[INV_SQUARE])
    for i in range(3):
        accumulate(w[INV_SQUARE], w[UP + i], k, w[FORCE + i], -p[MU])
    if p[OBLATE] == 0.0:
        return
    multiply(w[INV_SQUARE], w[INV_SQUARE], k, w[PULL], p[OBLATE])
    multiply(w[UP + 2], w[UP + 2], k, w[SINE_SQUARE])
    multiply(w[PULL], w[SINE_SQUARE], k, w[ALONG], 5.0)
    for q in range(w.shape[2]):
        w[ALONG, k, q] -= w[PULL, k, q]
    for i in range(3):
        accumulate(w[ALONG], w[UP + i], k, w[FORCE + i], 1.0)
    accumulate(w[PULL], w[UP + 2], k, w[FORCE + 2], -2.0)


@fast_kernel
def _lift(w, k, p, cos_bank, sin_bank, swapped):
    """Add row k of the lift, and of Coriolis terms that are exchanged."""
    _cross(w, AIR, UP, k, ACROSS)
    _cross(w, ACROSS, AIR, k, RAISED)
    _inner(w, ACROSS, ACROSS, k, N_SQUARE)
    square_root(w[N_SQUARE], k, w[N])
    reciprocal(w[N], k, w[INV_N])
    multiply(w[LIFT_V], w[INV_N], k, w[RAISING], cos_bank)
    multiply(w[LIFT_ACC], w[INV_N], k, w[SIDEWAYS], sin_bank)
    if swapped:
        multiply(w[ACROSS + 2], w[INV_N], k, w[TURN], 2.0 * p[OMEGA])
        multiply(w[RAISED + 2], w[INV_N], k, w[SHARE], -2.0 * p[OMEGA])
        multiply(w[INV_N], w[INV_N], k, w[INV_N_SQUARE])
        accumulate(w[SHARE], w[INV_N_SQUARE], k, w[RAISING], 1.0)
        for q in range(w.shape[2]):
            w[SIDEWAYS, k, q] += w[TURN, k, q]
    for i in range(3):
        accumulate(w[RAISING], w[RAISED + i], k, w[FORCE + i], 1.0)
        accumulate(w[SIDEWAYS], w[ACROSS + i], k, w[FORCE + i], 1.0)


@fast_kernel
def orbit_series(position, velocity, gm, omega, orders):
    """Taylor coefficients (3, orders) of two-body motion in axes turning at `omega` about z.

    ``r'' = -gm r/|r|^3 - 2 w x r' - w x (w x r)``; position m and velocity m/s in those axes.
    """
    c = np.zeros((3, orders))
    square, cube = np.zeros(orders), np.zeros(orders)  # |r|^2 and |r|^-3
    for i in range(3):
        c[i, 0] = position[i]
        if orders > 1:
            c[i, 1] = velocity[i]
    for k in range(orders - 2):
        for i in range(3):
            for j in range(k + 1):
                square[k] += c[i, j] * c[i, k - j]
        if k == 0:
            cube[0] = square[0] ** -1.5
        else:
            for j in range(1, k + 1):
                cube[k] += (-1.5 * j - (k - j)) * square[j] * cube[k - j]
            cube[k] /= k * square[0]
        both = (k + 1) * (k + 2)
        for i in range(3):
            pull = 0.0
            for j in range(k + 1):
                pull += cube[j] * c[i, k - j]
            c[i, k + 2] = -gm * pull / both
        c[0, k + 2] += (2.0 * omega * (k + 1) * c[1, k + 1] + omega * omega * c[0, k]) / both
        c[1, k + 2] += (-2.0 * omega * (k + 1) * c[0, k + 1] + omega * omega * c[1, k]) / both
    return c


@fast_kernel
def range_series(position, beacon, out):
    """Range between two series: fills `out` (orders, 1 + duals).

    `position` is the lander's, (3, orders, 1 + duals), such as ``w[:3]`` of `flow_series`;
    `beacon` the beacon's plain Taylor coefficients, (3, orders).
    """
    orders, width = out.shape
    square = np.zeros((orders, width))
    part = np.empty((orders, width))
    for i in range(3):
        for k in range(orders):
            for q in range(width):
                part[k, q] = position[i, k, q]
            part[k, 0] -= beacon[i, k]
            accumulate(part, part, k, square, 1.0)
    for k in range(orders):
        square_root(square, k, out)

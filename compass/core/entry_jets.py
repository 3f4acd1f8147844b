"""The entry flow as Taylor series with gradients, and what is measured along it.

``grad L_f^k h = k!`` times the gradient of the k-th Taylor coefficient of ``h(x(t))``.
"""

import math

import numpy as np

from compass.core.entry_dynamics import (
    BANK,
    CENTRIFUGAL,
    DRAG,
    MU,
    OMEGA,
    ROTATION,
    STATES,
    SWAPPED,
    log_density_ratio,
)
from compass.core.jets import (
    add,
    exponential,
    multiply,
    reciprocal,
    sine_cosine,
    square_root,
)
from compass.core.jit import fast_kernel

# Slots of the workspace: the eight states first, in the order of the dynamics.
(R, LON, LAT, V, GAMMA, PSI, LN_RHO0, KAPPA) = range(8)
(S_LON, C_LON, S_LAT, C_LAT, S_G, C_G, S_P, C_P) = range(8, 16)
(LOG_RHO, RHO, V_SQ, DRAG_ACC, LIFT_ACC, INV_R, INV_R_SQ, V_R, INV_V, INV_CL, INV_CG) = range(
    16, 27
)
(TAN_LAT, TAN_G, CG_CP, CG_SP, VR_CGSP, G_V, TURN, LIFT_V, CP_CL) = range(27, 36)
(X, Y, Z, R_CL) = range(36, 40)
(UP, SG_SL, ACROSS, R_ACROSS, R_SIDE, R_SIDE_SP, R_SIDE_V) = range(40, 47)
# Only ever read in the row just written, so free for anything.
(ROW, ROW_TOO) = range(47, 49)
SLOTS = 49


@fast_kernel
def flow_series(x, p, orders, duals):
    """Taylor coefficients 0 to ``orders - 1`` of the flow through `x`, with gradients.

    Parameters
    ----------
    x, p
        State (8) and parameters of `compass.core.entry_dynamics`.
    orders
        Number of coefficients.
    duals
        Leading states the gradient is taken in: 6, or 8 with ln rho0 and L/D.

    Returns
    -------
    w
        Shape (SLOTS, orders, 1 + duals): slots 0 to 7 the states, `DRAG_ACC` and `LIFT_ACC` the
        accelerations, `X`, `Y`, `Z` the Mars-fixed position; drag and lift lack the last order.
    """
    w = np.zeros((SLOTS, orders, 1 + duals))
    for i in range(STATES):
        w[i, 0, 0] = x[i]
        if i < duals:
            w[i, 0, 1 + i] = 1.0
    ratio, slope = log_density_ratio(x[0], p)
    cb, sb = math.cos(p[BANK]), math.sin(p[BANK])
    for k in range(orders):
        sine_cosine(w[LON], k, w[S_LON], w[C_LON])
        sine_cosine(w[LAT], k, w[S_LAT], w[C_LAT])
        multiply(w[R], w[C_LAT], k, w[R_CL])
        multiply(w[R_CL], w[C_LON], k, w[X])
        multiply(w[R_CL], w[S_LON], k, w[Y])
        multiply(w[R], w[S_LAT], k, w[Z])
        if k == orders - 1:
            break
        _aerodynamics(w, k, p, ratio, slope)
        _shared_terms(w, k, p)
        _rates(w, k, p, cb, sb)
    return w


@fast_kernel
def _aerodynamics(w, k, p, ratio, slope):
    """Drag and lift, row k."""
    for q in range(w.shape[2]):
        w[LOG_RHO, k, q] = w[LN_RHO0, k, q] + slope * w[R, k, q]
    if k == 0:
        w[LOG_RHO, 0, 0] = w[LN_RHO0, 0, 0] + ratio
    exponential(w[LOG_RHO], k, w[RHO])
    multiply(w[V], w[V], k, w[V_SQ])
    multiply(w[RHO], w[V_SQ], k, w[DRAG_ACC], 0.5 * p[DRAG])
    multiply(w[KAPPA], w[DRAG_ACC], k, w[LIFT_ACC])


@fast_kernel
def _shared_terms(w, k, p):
    """Row k of what several rates use."""
    sine_cosine(w[GAMMA], k, w[S_G], w[C_G])
    sine_cosine(w[PSI], k, w[S_P], w[C_P])
    reciprocal(w[R], k, w[INV_R])
    multiply(w[INV_R], w[INV_R], k, w[INV_R_SQ], p[MU])
    multiply(w[V], w[INV_R], k, w[V_R])
    reciprocal(w[V], k, w[INV_V])
    reciprocal(w[C_LAT], k, w[INV_CL])
    reciprocal(w[C_G], k, w[INV_CG])
    multiply(w[S_LAT], w[INV_CL], k, w[TAN_LAT])
    multiply(w[S_G], w[INV_CG], k, w[TAN_G])
    multiply(w[C_G], w[C_P], k, w[CG_CP])
    multiply(w[C_G], w[S_P], k, w[CG_SP])
    multiply(w[V_R], w[CG_SP], k, w[VR_CGSP])
    multiply(w[INV_R_SQ], w[INV_V], k, w[G_V])


@fast_kernel
def _grow(w, state, k, term, sign=1.0):
    """Add row k of a term of the rate of `state` to its row k + 1."""
    for q in range(w.shape[2]):
        w[state, k + 1, q] += sign / (k + 1) * w[term, k, q]


@fast_kernel
def _rates(w, k, p, cb, sb):
    """Grow the six states from row k to row k + 1."""
    for state in range(6):
        w[state, k + 1, :] = 0.0
    multiply(w[V], w[S_G], k, w[ROW])
    _grow(w, R, k, ROW)
    multiply(w[VR_CGSP], w[INV_CL], k, w[ROW])
    _grow(w, LON, k, ROW)
    multiply(w[V_R], w[CG_CP], k, w[ROW])
    _grow(w, LAT, k, ROW)

    multiply(w[INV_R_SQ], w[S_G], k, w[ROW])
    _grow(w, V, k, ROW, -1.0)
    _grow(w, V, k, DRAG_ACC, -1.0)

    add(w[V_R], w[G_V], k, w[TURN], -1.0)
    multiply(w[TURN], w[C_G], k, w[ROW])
    _grow(w, GAMMA, k, ROW)
    multiply(w[LIFT_ACC], w[INV_V], k, w[LIFT_V])
    _grow(w, GAMMA, k, LIFT_V, cb)

    multiply(w[VR_CGSP], w[TAN_LAT], k, w[ROW])
    _grow(w, PSI, k, ROW)
    if sb != 0.0:
        multiply(w[LIFT_V], w[INV_CG], k, w[ROW])
        _grow(w, PSI, k, ROW, sb)
    if p[OMEGA] != 0.0:
        _coriolis(w, k, p)
    if p[ROTATION] == CENTRIFUGAL:
        _centrifugal(w, k, p)


@fast_kernel
def _coriolis(w, k, p):
    two_w = 2.0 * p[OMEGA]
    multiply(w[C_P], w[C_LAT], k, w[CP_CL])
    multiply(w[TAN_G], w[CP_CL], k, w[ROW])
    add(w[S_LAT], w[ROW], k, w[ROW_TOO], -1.0)  # psi' / 2w
    multiply(w[S_P], w[C_LAT], k, w[ROW])  # gamma' / 2w
    if p[ROTATION] == SWAPPED:
        _grow(w, GAMMA, k, ROW_TOO, -two_w)
        _grow(w, PSI, k, ROW, -two_w)
    else:
        _grow(w, GAMMA, k, ROW, two_w)
        _grow(w, PSI, k, ROW_TOO, two_w)


@fast_kernel
def _centrifugal(w, k, p):
    w2 = p[OMEGA] * p[OMEGA]
    multiply(w[S_G], w[C_LAT], k, w[ROW])
    multiply(w[CG_CP], w[S_LAT], k, w[ROW_TOO])
    add(w[ROW], w[ROW_TOO], k, w[UP], -1.0)
    multiply(w[R_CL], w[UP], k, w[ROW])
    _grow(w, V, k, ROW, w2)

    multiply(w[S_G], w[S_LAT], k, w[SG_SL])
    multiply(w[SG_SL], w[C_P], k, w[ROW])
    multiply(w[C_G], w[C_LAT], k, w[ROW_TOO])
    add(w[ROW_TOO], w[ROW], k, w[ACROSS])
    multiply(w[R_CL], w[ACROSS], k, w[R_ACROSS])
    multiply(w[R_ACROSS], w[INV_V], k, w[ROW])
    _grow(w, GAMMA, k, ROW, w2)

    multiply(w[R_CL], w[S_LAT], k, w[R_SIDE])
    multiply(w[R_SIDE], w[S_P], k, w[R_SIDE_SP])
    multiply(w[R_SIDE_SP], w[INV_V], k, w[R_SIDE_V])
    multiply(w[R_SIDE_V], w[INV_CG], k, w[ROW])
    _grow(w, PSI, k, ROW, w2)


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

    `position` is the lander's, (3, orders, 1 + duals), such as ``w[X : Z + 1]`` of `flow_series`;
    `beacon` the beacon's plain Taylor coefficients, (3, orders).
    """
    orders, width = out.shape
    square = np.zeros((orders, width))
    part, product = np.empty((orders, width)), np.empty((orders, width))
    for i in range(3):
        for k in range(orders):
            for q in range(width):
                part[k, q] = position[i, k, q]
            part[k, 0] -= beacon[i, k]
            multiply(part, part, k, product)
            add(square, product, k, square)
    for k in range(orders):
        square_root(square, k, out)

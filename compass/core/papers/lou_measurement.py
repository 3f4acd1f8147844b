"""What a lander measures during entry, accelerations and ranges, with their partial derivatives.

States as in `compass.core.papers.spherical`, where a filter may estimate the first 6 (density and
lift-to-drag taken as known), 8, or 11 of them, the last three being accelerometer biases. With
`linear` the seventh state is rho0 itself instead of its logarithm.
"""

import math

from compass.core.jit import fast_kernel
from compass.core.papers.spherical import BANK, DRAG, log_density_ratio

ACCELERATIONS = 3
#: A filter on linear rho0 may step onto zero, where its logarithm does not exist.
TINY_DENSITY = 1e-300


@fast_kernel
def surface_density(x, linear):
    """``rho0`` of a state, kg/m^3, whichever way it is carried."""
    return x[6] if linear else math.exp(x[6])


@fast_kernel
def predict_measurements(x, n, p, linear, beacons, h, big_h):
    """Write what a state would measure and the derivative of it.

    ``a = [-D, -L sin(bank), L cos(bank)] + b`` and ``R_i = |r_i - r|``.

    Parameters
    ----------
    x
        State, shape (8,) or (11,).
    n
        Number of states estimated: 6, 8 or 11.
    p
        Parameters of the dynamics, filter's side.
    linear
        Whether x[6] is rho0.
    beacons
        Mars-centred positions, metres, shape (m, 3).
    h
        Output, shape (3 + m,): m/s^2, then metres.
    big_h
        Output, shape (3 + m, n).
    """
    r, lon, lat, v = x[0], x[1], x[2], x[3]
    ratio, slope = log_density_ratio(r, p)
    rho0 = surface_density(x, linear)
    unit_drag = 0.5 * math.exp(ratio) * p[DRAG] * v * v
    drag = rho0 * unit_drag
    for axis in range(ACCELERATIONS):
        if axis == 0:
            gain, per_kappa = -1.0, 0.0
        elif axis == 1:
            per_kappa = -math.sin(p[BANK])
            gain = x[7] * per_kappa
        else:
            per_kappa = math.cos(p[BANK])
            gain = x[7] * per_kappa
        h[axis] = gain * drag
        for j in range(n):
            big_h[axis, j] = 0.0
        big_h[axis, 0] = gain * drag * slope
        big_h[axis, 3] = gain * 2.0 * drag / v
        if n > 6:
            big_h[axis, 6] = gain * (unit_drag if linear else drag)
            big_h[axis, 7] = per_kappa * drag
        if n > 8:
            h[axis] += x[8 + axis]
            big_h[axis, 8 + axis] = 1.0
    sl, cl, so, co = math.sin(lat), math.cos(lat), math.sin(lon), math.cos(lon)
    for i in range(beacons.shape[0]):
        row = ACCELERATIONS + i
        dx = r * cl * co - beacons[i, 0]
        dy = r * cl * so - beacons[i, 1]
        dz = r * sl - beacons[i, 2]
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        h[row] = distance
        for j in range(n):
            big_h[row, j] = 0.0
        big_h[row, 0] = (dx * cl * co + dy * cl * so + dz * sl) / distance
        big_h[row, 1] = r * cl * (dy * co - dx * so) / distance
        big_h[row, 2] = r * (dz * cl - sl * (dx * co + dy * so)) / distance

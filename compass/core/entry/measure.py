"""What a measurement would be, and its row: radio to a beacon and accelerometers, all kinds.

Rows stand against the states of a filter, whose first six are position and velocity; where the
others are is told by `places` (see `compass.core.entry.filter`).
"""

import math

from compass.core.entry.rates import DRAG, log_density
from compass.core.jit import fast_kernel

#: Kinds of measurement, as columns of variances and of measured values.
RANGE, RATE, KINDS = 0, 1, 2

#: Columns of `places`: how many states are estimated (the rest is considered), then the first
#: state of each further block, -1 where it is left out.
ESTIMATED, AIR, LIFT, CLOCK, BIAS, IMU, PLACES = range(7)

#: Accelerometers: along the velocity, to the side and across it.
AXES = 3


@fast_kernel
def ranges_and_rates(path, beacons, out):
    """Distances (m) and their rates (m/s), (t, n, 2), of states (t, 6) and beacons (t, n, 6)."""
    for t in range(path.shape[0]):
        for b in range(beacons.shape[1]):
            square, product = 0.0, 0.0
            for i in range(3):
                d = path[t, i] - beacons[t, b, i]
                square += d * d
                product += d * (path[t, 3 + i] - beacons[t, b, 3 + i])
            distance = math.sqrt(square)
            out[t, b, RANGE] = distance
            out[t, b, RATE] = product / distance


@fast_kernel
def measurement_rows(x, beacon, number, places, range_row, rate_row):
    """Predict range and range rate to a beacon, and write their rows.

    ``R = |r - b| + c + o``, ``R' = n.(v - b') + c'``, with the receiver's clock c (m) and its
    drift c' (m/s) and the bias o of this beacon's ranges, where they are states;
    ``dR/dr = n``, ``dR'/dr = (I - n n^T)(v - b')/R``, ``dR'/dv = n``.

    Parameters
    ----------
    x
        State, shape (s,).
    beacon, number
        Position and velocity, (6,), and which beacon it is.
    places
        See `PLACES`.
    range_row, rate_row
        Outputs, (s,); only the entries named here are written, the others must be zero.
    """
    dx, dy, dz = x[0] - beacon[0], x[1] - beacon[1], x[2] - beacon[2]
    wx, wy, wz = x[3] - beacon[3], x[4] - beacon[4], x[5] - beacon[5]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = dx / distance, dy / distance, dz / distance
    rate = nx * wx + ny * wy + nz * wz
    range_row[0], range_row[1], range_row[2] = nx, ny, nz
    rate_row[3], rate_row[4], rate_row[5] = nx, ny, nz
    rate_row[0] = (wx - rate * nx) / distance
    rate_row[1] = (wy - rate * ny) / distance
    rate_row[2] = (wz - rate * nz) / distance
    if places[CLOCK] >= 0:
        distance += x[places[CLOCK]]
        rate += x[places[CLOCK] + 1]
        range_row[places[CLOCK]] = 1.0
        rate_row[places[CLOCK] + 1] = 1.0
    if places[BIAS] >= 0:
        distance += x[places[BIAS] + number]
        range_row[places[BIAS] + number] = 1.0
    return distance, rate


@fast_kernel
def acceleration_rows(x, thicker, lift, p, cos_bank, sin_bank, places, rows, out):
    """Predict what the accelerometers read, and write their rows.

    ``a = [-D, -L sin(bank), L cos(bank)] + b``, with ``D = rho B V^2 / 2``, ``L = lift D`` and the
    biases b where they are states. At a switch the bank is the one that holds from then on.

    Parameters
    ----------
    x, thicker, lift, p, cos_bank, sin_bank
        As in `compass.core.entry.rates.acceleration`; x of shape (s,).
    places
        See `PLACES`.
    rows
        Output, (>= 3, s); only the entries named here are written, the others must be zero.
    out
        Output, (>= 3,), m/s^2.
    """
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    v = math.sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5])
    height, slope = log_density(r, p)
    drag = 0.5 * math.exp(height + thicker) * p[DRAG] * v * v
    for axis in range(AXES):
        turned = 0.0 if axis == 0 else (-sin_bank if axis == 1 else cos_bank)
        value = -drag if axis == 0 else turned * lift * drag
        out[axis] = value
        for i in range(3):
            rows[axis, i] = value * slope * x[i] / r
            rows[axis, 3 + i] = 2.0 * value * x[3 + i] / (v * v)
        if places[AIR] >= 0:
            rows[axis, places[AIR]] = value
        if places[LIFT] >= 0:
            rows[axis, places[LIFT]] = turned * drag
        if places[IMU] >= 0:
            out[axis] += x[places[IMU] + axis]
            rows[axis, places[IMU] + axis] = 1.0

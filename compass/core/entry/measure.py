"""What a measurement would be, and its row: every kind of one number, and accelerometers.

Rows stand against the states of a filter, whose first six are position and velocity; where the
others are is told by `places` (see `compass.core.entry.filter`).
"""

import math

import numpy as np

from compass.core.entry.flow import bank_at
from compass.core.entry.kinds import ACCELERATION, BEARING, ECHO, HEIGHT, RANGE, RATE, VELOCITY
from compass.core.entry.rates import DRAG, WINDS, World, log_density, through_air, wind_gradient
from compass.core.entry.rates import LIFT as RATIO
from compass.core.jit import fast_kernel, inline_kernel, kernel

#: Columns of `places`: how many states are estimated (the rest is considered), then the first
#: state of each further block, -1 where it is left out; where there is a `FRAME`, behind them a
#: number for each beacon, whether its place is told in that frame.
ESTIMATED, AIR, LIFT, CLOCK, BIAS, IMU, ATTITUDE, GYRO, FRAME, PLACES = range(10)

#: Accelerometers: along the velocity through the air, to the side and across it.
AXES = 3


@kernel
def added(x, place):
    """State at `place`, or 0 where the block is left out (-1)."""
    return x[place] if place >= 0 else 0.0


@kernel
def world_of(p, x, places):
    """World of parameters `p`, its density and L/D corrected by a state."""
    return World(p, added(x, places[AIR]), p[RATIO] + added(x, places[LIFT]))


@kernel
def ideal_values(path, sources, kinds, places, p, bank, times, out):
    """Values without noise, (t, n, c), along states (t, s), of sources (t, n, 6) and kinds (c,).

    In the world `p`, by the angles `bank` (k, 2), at `times` (t,).
    """
    row = np.empty(path.shape[1])
    for t in range(path.shape[0]):
        angle = bank[bank_at(times[t], bank), 1]
        for b in range(sources.shape[1]):
            for c in range(kinds.size):
                out[t, b, c] = measured(kinds[c], path[t], sources[t, b], b, places, p, angle, row)


@fast_kernel
def measured(kind, x, source, number, places, p, angle, row):
    """Predict one measurement of a source, and write its row.

    ``R = |r - b| + c + o``, ``R' = n.(v - b') + c'``, with the receiver's clock c (m) and its
    drift c' (m/s), of one-way kinds alone, and the bias o of this beacon's ranges, where they are
    states; ``dR/dr = n``, ``dR'/dr = (I - n n^T)(v - b')/R``, ``dR'/dv = n``. Height: ``|r|``.

    Satellites whose frame is turned by the small angles w, where they are states, are at
    ``b + w x b``, and so is their velocity turned.

    Directions ``n = (b - r)/|b - r|`` and velocities ``v - b'`` are read in axes off by the small
    angles f, where they are states: ``n - f x n``. Of a direction all three components are given,
    each with the noise of an angle: the one along n tells nothing, for its row is zero there.

    Parameters
    ----------
    kind
        See `RANGE`; of directions and velocities the first component's number and up.
    x
        State, shape (s,).
    source, number
        Position and velocity, (6,), and which source it is.
    places
        See `PLACES`.
    p, angle
        World and bank angle, which accelerometers alone ask for; see `acceleration_row`.
    row
        Output, (s,); only the entries named here are written, the others must be zero.
    """
    if kind >= ACCELERATION:
        world, axis = world_of(p, x, places), kind - ACCELERATION
        return acceleration_row(axis, x, world, math.cos(angle), math.sin(angle), places, row)
    if kind >= BEARING:
        return _component(kind, x, source, places, row)
    if kind == HEIGHT:
        distance = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        row[0], row[1], row[2] = x[0] / distance, x[1] / distance, x[2] / distance
        return distance
    sx, sy, sz, ux, uy, uz = source[0], source[1], source[2], source[3], source[4], source[5]
    frame, turned = places[FRAME], False
    if frame >= 0:
        turned = places[PLACES + number] > 0
        row[frame : frame + 3] = 0.0  # another beacon's
    if turned:
        a, b, c = x[frame], x[frame + 1], x[frame + 2]
        sx, sy, sz = sx + b * sz - c * sy, sy + c * sx - a * sz, sz + a * sy - b * sx
        ux, uy, uz = ux + b * uz - c * uy, uy + c * ux - a * uz, uz + a * uy - b * ux
    dx, dy, dz = x[0] - sx, x[1] - sy, x[2] - sz
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = dx / distance, dy / distance, dz / distance
    if kind in (RANGE, ECHO):
        if places[BIAS] >= 0:
            row[places[BIAS] :] = 0.0  # another beacon's
        row[0], row[1], row[2] = nx, ny, nz
        if kind == RANGE and places[CLOCK] >= 0:
            distance += x[places[CLOCK]]
            row[places[CLOCK]] = 1.0
        if places[BIAS] >= 0:
            distance += x[places[BIAS] + number]
            row[places[BIAS] + number] = 1.0
        if turned:
            _add_turn(row, frame, source[:3], nx, ny, nz)
        return distance
    wx, wy, wz = x[3] - ux, x[4] - uy, x[5] - uz
    rate = nx * wx + ny * wy + nz * wz
    row[3], row[4], row[5] = nx, ny, nz
    row[0] = (wx - rate * nx) / distance
    row[1] = (wy - rate * ny) / distance
    row[2] = (wz - rate * nz) / distance
    if turned:
        _add_turn(row, frame, source[:3], row[0], row[1], row[2])
        _add_turn(row, frame, source[3:], nx, ny, nz)
    if kind == RATE and places[CLOCK] >= 0:
        rate += x[places[CLOCK] + 1]
        row[places[CLOCK] + 1] = 1.0
    return rate


@inline_kernel
def _add_turn(row, frame, v, x, y, z):
    """Add what a turn of a vector v does to a number that falls along it by (x, y, z)."""
    row[frame] -= v[1] * z - v[2] * y
    row[frame + 1] -= v[2] * x - v[0] * z
    row[frame + 2] -= v[0] * y - v[1] * x


@fast_kernel
def _component(kind, x, source, places, row):
    """One component of a direction or of a velocity, and its row, as in `measured`."""
    first = 0 if kind < VELOCITY else 3
    i = kind - (BEARING if kind < VELOCITY else VELOCITY)
    j, k = (i + 1) % 3, (i + 2) % 3
    w, size = np.empty(3), 0.0
    for c in range(3):
        w[c] = x[first + c] - source[first + c]
        size += w[c] * w[c]
    scale = 1.0
    if first == 0:
        scale = -1.0 / math.sqrt(size)  # towards the source
        for c in range(3):
            w[c] *= scale
    for c in range(3):
        turn = w[i] * w[c] if first == 0 else 0.0
        row[first + c] = scale * ((1.0 if c == i else 0.0) - turn)
    value = w[i]
    if places[ATTITUDE] >= 0:
        at = places[ATTITUDE]
        value -= x[at + j] * w[k] - x[at + k] * w[j]
        row[at + j], row[at + k] = -w[k], w[j]
        for c in range(3):
            along = w[c] if first == 0 else 0.0
            dk = scale * ((1.0 if c == k else 0.0) - w[k] * along)
            dj = scale * ((1.0 if c == j else 0.0) - w[j] * along)
            row[first + c] -= x[at + j] * dk - x[at + k] * dj
    return value


@fast_kernel
def acceleration_row(axis, x, world, cos_bank, sin_bank, places, row):
    """Predict what an accelerometer reads, and write its row.

    ``a = [-D, -L sin(bank), L cos(bank)] + b``, with ``D = rho B V^2 / 2``, V through the air,
    ``L = lift D`` and the biases b where they are states. At a switch the bank is the one that
    holds from then on.

    Parameters
    ----------
    axis
        Along the velocity through the air, to the side or across it: 0, 1, 2.
    x, world, cos_bank, sin_bank
        As in `compass.core.entry.rates.acceleration`; x of shape (s,).
    places
        See `PLACES`.
    row
        Output, (s,); only the entries named here are written, the others must be zero.
    """
    p, thicker, lift = world
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    w = through_air(x, p)
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    height, slope = log_density(r, p)
    drag = 0.5 * math.exp(height + thicker) * p[DRAG] * square
    turned = 0.0 if axis == 0 else (-sin_bank if axis == 1 else cos_bank)
    value = -drag if axis == 0 else turned * lift * drag
    for i in range(3):
        row[i] = value * slope * x[i] / r
        row[3 + i] = 2.0 * value * w[i] / square
    if places[AIR] >= 0:
        row[places[AIR]] = value
    if places[LIFT] >= 0:
        row[places[LIFT]] = turned * drag
    if p[WINDS] > 0.0:
        gradient = np.empty((3, 3))
        wind_gradient(x, p, gradient)
        for i in range(3):
            for k in range(3):
                row[i] -= row[3 + k] * gradient[k, i]
    if places[IMU] >= 0:
        value += x[places[IMU] + axis]
        row[places[IMU] + axis] = 1.0
    return value

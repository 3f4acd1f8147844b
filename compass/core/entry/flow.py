"""From one time to another: Runge-Kutta steps that end where the bank or the air's law switches.

The steps are never longer than asked for, whatever the time between epochs, so that the epochs of
a filter decide nothing about its dynamics.
"""

import math

import numpy as np

from compass.core.entry.rates import (
    COLUMNS,
    OF_AIR,
    OF_LIFT,
    TABLE,
    WINDS,
    World,
    acceleration,
    acceleration_partials,
)
from compass.core.jit import fast_kernel, kernel

#: The distance from the centre of an entry bends by less than twice this, m/s^2.
MOST_BEND = 200.0


@fast_kernel
def rk4_step(x, world, cos_bank, sin_bank, dt, out):
    """Advance the state (6) by one classical Runge-Kutta step of `dt` seconds into `out`."""
    k, total, stage = np.empty(3), np.zeros(6), np.empty(6)
    for i in range(6):
        stage[i] = x[i]
    for part in range(4):
        weight = 2.0 if part == 1 or part == 2 else 1.0
        ahead = dt if part == 2 else 0.5 * dt
        acceleration(stage, world, cos_bank, sin_bank, k)
        for i in range(3):
            total[i] += weight * stage[3 + i]
            total[3 + i] += weight * k[i]
            stage[i] = x[i] + ahead * stage[3 + i]
        for i in range(3):
            stage[3 + i] = x[3 + i] + ahead * k[i]
    for i in range(6):
        out[i] = x[i] + dt / 6.0 * total[i]


@fast_kernel
def rk4_step_transition(x, world, cos_bank, sin_bank, dt, out, phi):
    """One Runge-Kutta step and the derivative of the step itself, (6, 8).

    The Runge-Kutta map is differentiated stage by stage (not the flow), so that a covariance moves
    exactly as the mean does: ``K_1' = A(x)``, ``K_2' = A(x_2)(I + dt/2 K_1')`` and so on,
    ``Phi = I + dt/6 (K_1' + 2 K_2' + 2 K_3' + K_4')``. Columns 6 and 7 belong to the logarithm of
    the density and the lift-to-drag ratio, both constant over a step.
    """
    k, total, stage = np.empty(3), np.zeros(6), np.empty(6)
    partials = np.empty((3, COLUMNS))
    m, slope = np.zeros((6, COLUMNS)), np.empty((6, COLUMNS))
    for i in range(6):
        stage[i] = x[i]
        m[i, i] = 1.0
        for j in range(COLUMNS):
            phi[i, j] = 0.0
    for part in range(4):
        weight = 2.0 if part == 1 or part == 2 else 1.0
        ahead = dt if part == 2 else 0.5 * dt
        acceleration(stage, world, cos_bank, sin_bank, k)
        acceleration_partials(stage, world, cos_bank, sin_bank, partials)
        for i in range(3):
            for j in range(COLUMNS):
                total_j = partials[i, j] if j >= OF_AIR else 0.0
                for c in range(6):
                    total_j += partials[i, c] * m[c, j]
                slope[3 + i, j] = total_j
                slope[i, j] = m[3 + i, j]
        for i in range(6):
            for j in range(COLUMNS):
                phi[i, j] += weight * slope[i, j]
                m[i, j] = ahead * slope[i, j]
            m[i, i] += 1.0
        for i in range(3):
            total[i] += weight * stage[3 + i]
            total[3 + i] += weight * k[i]
            stage[i] = x[i] + ahead * stage[3 + i]
        for i in range(3):
            stage[3 + i] = x[3 + i] + ahead * k[i]
    for i in range(6):
        out[i] = x[i] + dt / 6.0 * total[i]
        for j in range(COLUMNS):
            phi[i, j] *= dt / 6.0
        phi[i, i] += 1.0


@kernel
def to_row(x, world, cos_bank, sin_bank, dt):
    """Part of a step after which a table of densities or winds comes to its next row.

    There the slopes jump, and a step across is off by a decimetre; one that ends there, to a
    millisecond, is not. The distance from the centre is taken to bend evenly.
    """
    p, k = world.p, int(world.p[WINDS])
    n = (p.size - TABLE - 3 * k) // 2
    if n + k == 0:
        return dt
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    climb = (x[0] * x[3] + x[1] * x[4] + x[2] * x[5]) / r
    way, nearest = 1.0 if climb * dt > 0.0 else -1.0, math.inf
    for i in range(n + k):
        off = way * (p[TABLE + i if i < n else TABLE + n + i] - r)
        if 1.0 < off < nearest:  # nearer ones were just passed, or are as good as here
            nearest = off
    if nearest > abs(climb * dt) + MOST_BEND * dt * dt:
        return dt
    force = np.empty(3)
    acceleration(x, world, cos_bank, sin_bank, force)
    bend = (x[0] * force[0] + x[1] * force[1] + x[2] * force[2] - climb * climb) / r
    bend += (x[3] * x[3] + x[4] * x[4] + x[5] * x[5]) / r
    square = climb * climb + 2.0 * bend * way * nearest
    if square <= 0.0:
        return dt
    part = 2.0 * way * nearest / (climb + math.copysign(math.sqrt(square), climb))
    return part if 0.0 < part / dt < 1.0 else dt


@kernel
def bank_at(time, bank):
    """Row of `bank` (k, 2), times and angles, in force from `time` on."""
    row = 0
    while row + 1 < bank.shape[0] and bank[row + 1, 0] <= time:
        row += 1
    return row


@kernel
def advance(x, world, bank, start, stop, longest, out):
    """Fly from `start` to `stop`, later or earlier, exactly through bank switches, into `out` (6).

    Parameters
    ----------
    x, world
        As in `compass.core.entry.rates.acceleration`.
    bank
        Times (s) from which bank angles (rad) hold, (k, 2); the first holds before it too.
    start, stop
        Seconds.
    longest
        Longest Runge-Kutta step, s.
    """
    for i in range(6):
        out[i] = x[i]
    time, row = start, bank_at(start, bank)
    while time < stop or stop < time:
        end = stop
        if start < stop and row + 1 < bank.shape[0]:
            end = min(stop, bank[row + 1, 0])
        elif stop < start and row > 0:
            end = max(stop, bank[row, 0])
        steps = max(1, math.ceil(abs(end - time) / longest - 1e-9))
        cos_bank, sin_bank = math.cos(bank[row, 1]), math.sin(bank[row, 1])
        for _ in range(steps):
            left = (end - time) / steps
            while left != 0.0:
                dt = to_row(out, world, cos_bank, sin_bank, left)
                rk4_step(out, world, cos_bank, sin_bank, dt, out)
                left -= dt
        time = end
        row += 1 if start < stop else -1


@kernel
def advance_transition(x, world, bank, start, stop, longest, out, phi):
    """As `advance`, with the derivative (6, 8) of all its steps together in `phi`."""
    step, before = np.empty((6, COLUMNS)), np.empty((6, COLUMNS))
    for i in range(6):
        out[i] = x[i]
        for j in range(COLUMNS):
            phi[i, j] = 1.0 if i == j else 0.0
    time, row, first = start, bank_at(start, bank), True
    while time < stop:
        end = stop
        if row + 1 < bank.shape[0]:
            end = min(stop, bank[row + 1, 0])
        steps = max(1, math.ceil((end - time) / longest - 1e-9))
        cos_bank, sin_bank = math.cos(bank[row, 1]), math.sin(bank[row, 1])
        for _ in range(steps):
            left = (end - time) / steps
            while left != 0.0:
                dt = to_row(out, world, cos_bank, sin_bank, left)
                left -= dt
                if first:
                    rk4_step_transition(out, world, cos_bank, sin_bank, dt, out, phi)
                    first = False
                    continue
                rk4_step_transition(out, world, cos_bank, sin_bank, dt, out, step)
                before[:, :] = phi
                for i in range(6):
                    for j in range(COLUMNS):
                        total = step[i, j] if j >= OF_AIR else 0.0
                        for c in range(6):
                            total += step[i, c] * before[c, j]
                        phi[i, j] = total
        time = end
        row += 1


@kernel
def advance_spread(x, factor, world, bank, start, stop, longest, out, phi, bend):
    """Advance the mean of states that are spread, and the line that fits what becomes of them.

    From d pairs of points ``x +- sqrt(d) L_j`` come the mean of their ends, the regression Phi of
    the ends on the points, and what is left: with ``o_j, e_j`` half the difference and half the
    sum less the mean of a pair's ends, ``Phi L = O / sqrt(d)`` and the covariance of the ends is
    ``Phi P Phi^T + E E^T / d`` (cubature; Arasaratnam and Haykin 2009, IEEE Trans. Autom. Control
    54:1254; statistical linear regression).

    Parameters
    ----------
    x, world, bank, start, stop, longest
        As in `advance`; at the mean.
    factor
        Lower Cholesky factor L (8, 8) of the covariance of position, velocity, logarithm of the
        density and lift-to-drag ratio; a column of what is known is zero.
    out, phi
        Mean (6) and Phi (6, 8).
    bend
        ``E / sqrt(d)``, (6, 8).
    """
    d = 0
    for j in range(COLUMNS):
        d += 1 if factor[j, j] > 0.0 else 0
    wide = math.sqrt(d)
    point, ends = np.empty(6), np.empty((2, 6))
    out[:] = 0.0
    bend[:, :] = 0.0
    phi[:, :] = 0.0
    for j in range(COLUMNS):
        if not factor[j, j] > 0.0:
            continue
        for k in range(2):
            off = wide if k == 0 else -wide
            for i in range(6):
                point[i] = x[i] + off * factor[i, j]
            air, lift = off * factor[OF_AIR, j], off * factor[OF_LIFT, j]
            there = World(world.p, world.thicker + air, world.lift + lift)
            advance(point, there, bank, start, stop, longest, ends[k])
        for i in range(6):
            phi[i, j] = 0.5 * (ends[0, i] - ends[1, i]) / wide
            bend[i, j] = 0.5 * (ends[0, i] + ends[1, i])
            out[i] += bend[i, j] / d
    for j in range(COLUMNS - 1, -1, -1):  # Phi = (O / sqrt d) L^-1, from the last column
        if not factor[j, j] > 0.0:
            continue
        for i in range(6):
            bend[i, j] = (bend[i, j] - out[i]) / wide
            for k in range(j + 1, COLUMNS):
                phi[i, j] -= phi[i, k] * factor[k, j]
            phi[i, j] /= factor[j, j]

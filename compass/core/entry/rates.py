"""Acceleration of an entry vehicle in Mars-fixed Cartesian axes, and its exact partials.

State ``[x, y, z, vx, vy, vz]``: position and velocity relative to the rotating planet, SI. There
is no pole in it: nothing is divided by a cosine of latitude, and without lift nothing by that of
the flight-path angle.

Parameters ``p``: see `MU` and what follows it; behind `TABLE` may stand a tabulated atmosphere,
n radii, increasing, then n values of ``ln rho``, and winds, k radii, increasing, then k speeds to
the east and k to the north, linear between and constant beyond. Drag and lift are those of the
velocity through the air.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import fast_kernel, kernel

#: Places in ``p``: gravitational parameter; ``3/2 J2 mu R^2`` (0 for a point mass); rotation rate
#: and which of its terms are kept; the density at r0, its logarithm; r0; scale height;
#: ``B = C_D S / m``; lift-to-drag ratio; number k of rows of the winds.
MU, OBLATE, OMEGA, ROTATION, LOG_DENSITY, R0, SCALE_HEIGHT, DRAG, LIFT, WINDS, TABLE = range(11)

#: Terms of the rotation: Coriolis alone; Coriolis and centrifugal; Coriolis terms of the
#: flight-path and heading rates exchanged, as Yu et al. 2018 print them in eq. 1 (wrong).
CORIOLIS, CENTRIFUGAL, SWAPPED = 0.0, 1.0, 2.0

#: Columns of the partials: position, velocity, logarithm of the density, lift-to-drag ratio.
COLUMNS, OF_AIR, OF_LIFT = 8, 6, 7


class World(NamedTuple):
    """Where a state flies: the parameters, what is added to ``ln rho``, and lift-to-drag ratio."""

    p: NDArray[np.float64]
    thicker: float
    lift: float


@kernel
def thickened(p, thicker, lift):
    """Parameters of a world whose ``ln rho`` and L/D are more than in another."""
    out, n = p.copy(), (p.size - TABLE - 3 * int(p[WINDS])) // 2
    out[LOG_DENSITY] += thicker
    out[TABLE + n : TABLE + 2 * n] += thicker
    out[LIFT] += lift
    return out


@fast_kernel
def log_density(r, p):
    """``ln rho(r)`` and its derivative in r, 1/m.

    ``ln rho0 + (r0 - r)/h``, or of a table (`layered`).
    """
    n = (p.size - TABLE - 3 * int(p[WINDS])) // 2
    if n == 0:
        return p[LOG_DENSITY] + (p[R0] - r) / p[SCALE_HEIGHT], -1.0 / p[SCALE_HEIGHT]
    return layered(r, p, TABLE, n)


@fast_kernel
def layered(r, p, at, n):
    """``ln rho`` of a table and its derivative in r: n radii from ``p[at]`` on, then n values.

    Linear between the rows (exponential layers); the end layers go on for ever.
    """
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if p[at + middle] <= r:
            low = middle
        else:
            high = middle
    r_low, s_low = p[at + low], p[at + n + low]
    slope = (p[at + n + low + 1] - s_low) / (p[at + low + 1] - r_low)
    return s_low + slope * (r - r_low), slope


@fast_kernel
def wind_speeds(r, p):
    """Wind to the east and to the north, m/s, and their derivatives in r, 1/s."""
    k = int(p[WINDS])
    at = p.size - 3 * k
    if k == 0:
        return 0.0, 0.0, 0.0, 0.0
    if r <= p[at] or k == 1:
        return p[at + k], p[at + 2 * k], 0.0, 0.0
    if r >= p[at + k - 1]:
        return p[at + 2 * k - 1], p[at + 3 * k - 1], 0.0, 0.0
    low = 0
    while p[at + low + 1] <= r:
        low += 1
    span = p[at + low + 1] - p[at + low]
    east, north = p[at + k + low], p[at + 2 * k + low]
    de, dn = (p[at + k + low + 1] - east) / span, (p[at + 2 * k + low + 1] - north) / span
    return east + de * (r - p[at + low]), north + dn * (r - p[at + low]), de, dn


@fast_kernel
def through_air(x, p):
    """Velocity through the air, ``v - E e - N n``, its three components in m/s.

    East e and north n are those of the place; on the polar axis, where there is none, no wind.
    """
    if p[WINDS] == 0.0:
        return x[3], x[4], x[5]
    across = math.sqrt(x[0] * x[0] + x[1] * x[1])
    if across == 0.0:
        return x[3], x[4], x[5]
    r = math.sqrt(across * across + x[2] * x[2])
    east, north, _, _ = wind_speeds(r, p)
    cx, cy, sin_lat = x[0] / across, x[1] / across, x[2] / r
    return (
        x[3] + east * cy + north * sin_lat * cx,
        x[4] - east * cx + north * sin_lat * cy,
        x[5] - north * across / r,
    )


@fast_kernel
def wind_gradient(x, p, out):
    """Write the derivative of the wind in the position, 1/s, into `out` (3, 3).

    ``(E' e + N' n) u^T - E c e^T / q - N (u n^T / r + tan(lat) e e^T / r)``, with u up, c the
    horizontal part of u, of length 1, and q the distance from the axis.
    """
    out[:, :] = 0.0
    across = math.sqrt(x[0] * x[0] + x[1] * x[1])
    if across == 0.0:
        return
    r = math.sqrt(across * across + x[2] * x[2])
    east, north, de, dn = wind_speeds(r, p)
    sin_lat, cos_lat = x[2] / r, across / r
    c = (x[0] / across, x[1] / across, 0.0)
    u = (x[0] / r, x[1] / r, sin_lat)
    e = (-c[1], c[0], 0.0)
    n = (-sin_lat * c[0], -sin_lat * c[1], cos_lat)
    for i in range(3):
        for j in range(3):
            out[i, j] = (
                (de * e[i] + dn * n[i]) * u[j]
                - east * c[i] * e[j] / across
                - north * (u[i] * n[j] / r + sin_lat * e[i] * e[j] / across)
            )


@fast_kernel
def acceleration(x, world, cos_bank, sin_bank, out):
    """Write the acceleration (m/s^2) into ``out[0:3]``.

    ``a = -mu u/r^2 - D s + L (cos(bank) e + sin(bank) f) - 2 w x v - w x (w x r)``, with u up, s
    along the velocity through the air, of size V, ``e = (u - q s)/c`` and ``f = (s x u)/c`` across
    it, ``q = u . s``, ``c = |s x u|``; ``D = rho B V^2 / 2``, ``L = lift D``.

    Parameters
    ----------
    x
        State, shape (>= 6,).
    world
        `World`.
    cos_bank, sin_bank
        Of the bank angle, positive turning the velocity clockwise.
    """
    p, thicker, lift = world
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    vx, vy, vz = through_air(x, p)
    v = math.sqrt(vx * vx + vy * vy + vz * vz)
    ux, uy, uz = x[0] / r, x[1] / r, x[2] / r
    sx, sy, sz = vx / v, vy / v, vz / v
    height, _ = log_density(r, p)
    drag = 0.5 * math.exp(height + thicker) * p[DRAG] * v * v
    g = p[MU] / (r * r)
    ax, ay, az = -g * ux - drag * sx, -g * uy - drag * sy, -g * uz - drag * sz
    if p[OBLATE] != 0.0:
        j = p[OBLATE] / (r * r * r * r)
        along = j * (5.0 * uz * uz - 1.0)
        ax, ay, az = ax + along * ux, ay + along * uy, az + (along - 2.0 * j) * uz
    w = p[OMEGA]
    if lift != 0.0 or p[ROTATION] == SWAPPED:
        fx, fy, fz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
        c = math.sqrt(fx * fx + fy * fy + fz * fz)
        q = ux * sx + uy * sy + uz * sz
        fx, fy, fz = fx / c, fy / c, fz / c
        ex, ey, ez = (ux - q * sx) / c, (uy - q * sy) / c, (uz - q * sz) / c
        up, side = lift * drag * cos_bank, lift * drag * sin_bank
        if p[ROTATION] == SWAPPED:
            up -= 2.0 * w * v * ez / c
            side += 2.0 * w * v * c * fz
        ax, ay, az = ax + up * ex + side * fx, ay + up * ey + side * fy, az + up * ez + side * fz
    if p[ROTATION] != SWAPPED:
        ax, ay = ax + 2.0 * w * x[4], ay - 2.0 * w * x[3]
    if p[ROTATION] == CENTRIFUGAL:
        ax, ay = ax + w * w * x[0], ay + w * w * x[1]
    out[0], out[1], out[2] = ax, ay, az


@fast_kernel
def acceleration_partials(x, world, cos_bank, sin_bank, out):
    """Write the derivative of `acceleration` into `out`, shape (3, 8).

    Column by column: how u, s, the density and the speed turn, then what turns with them.
    """
    p, thicker, lift = world
    r = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    vx, vy, vz = through_air(x, p)
    v = math.sqrt(vx * vx + vy * vy + vz * vz)
    ux, uy, uz = x[0] / r, x[1] / r, x[2] / r
    sx, sy, sz = vx / v, vy / v, vz / v
    height, slope = log_density(r, p)
    drag = 0.5 * math.exp(height + thicker) * p[DRAG] * v * v
    w, swapped = p[OMEGA], p[ROTATION] == SWAPPED
    fx, fy, fz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
    c = math.sqrt(fx * fx + fy * fy + fz * fz)
    q = ux * sx + uy * sy + uz * sz
    lifted = (lift != 0.0 or swapped) and c > 0.0
    ex, ey, ez = 0.0, 0.0, 0.0
    if c > 0.0:
        fx, fy, fz = fx / c, fy / c, fz / c
        ex, ey, ez = (ux - q * sx) / c, (uy - q * sy) / c, (uz - q * sz) / c
    up, side = lift * drag * cos_bank, lift * drag * sin_bank
    g = p[MU] / (r * r * r)
    for j in range(6):
        kx = 1.0 if j % 3 == 0 else 0.0
        ky = 1.0 if j % 3 == 1 else 0.0
        kz = 1.0 if j % 3 == 2 else 0.0
        dux, duy, duz, dsx, dsy, dsz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if j < 3:
            uj = kx * ux + ky * uy + kz * uz
            dux, duy, duz = (kx - ux * uj) / r, (ky - uy * uj) / r, (kz - uz * uj) / r
            grows, speeds = slope * uj, 0.0
            ax, ay, az = -g * (kx - 3 * ux * uj), -g * (ky - 3 * uy * uj), -g * (kz - 3 * uz * uj)
            if p[OBLATE] != 0.0:
                h = p[OBLATE] / (r * r * r * r)
                along, dh = h * (5.0 * uz * uz - 1.0), -4.0 * h / r * uj
                dalong = dh * (5.0 * uz * uz - 1.0) + h * 10.0 * uz * duz
                ax, ay = ax + dalong * ux + along * dux, ay + dalong * uy + along * duy
                az += (dalong - 2.0 * dh) * uz + (along - 2.0 * h) * duz
        else:
            speeds = kx * sx + ky * sy + kz * sz
            dsx, dsy, dsz = (kx - sx * speeds) / v, (ky - sy * speeds) / v, (kz - sz * speeds) / v
            grows = 2.0 * speeds / v
            ax, ay, az = 0.0, 0.0, 0.0
        ax -= drag * (grows * sx + dsx)
        ay -= drag * (grows * sy + dsy)
        az -= drag * (grows * sz + dsz)
        if lifted:
            dq = dux * sx + duy * sy + duz * sz + ux * dsx + uy * dsy + uz * dsz
            bend = q * dq / (c * c)  # minus the relative change of c
            dex = (dux - dq * sx - q * dsx) / c + ex * bend
            dey = (duy - dq * sy - q * dsy) / c + ey * bend
            dez = (duz - dq * sz - q * dsz) / c + ez * bend
            dfx = (dsy * uz - dsz * uy + sy * duz - sz * duy) / c + fx * bend
            dfy = (dsz * ux - dsx * uz + sz * dux - sx * duz) / c + fy * bend
            dfz = (dsx * uy - dsy * ux + sx * duy - sy * dux) / c + fz * bend
            all_up, all_side, dup, dside = up, side, up * grows, side * grows
            if swapped:
                turn = 2.0 * w
                all_up -= turn * v * ez / c
                all_side += turn * v * c * fz
                dup -= turn * (speeds * ez + v * dez + v * ez * bend) / c
                dside += turn * c * (speeds * fz + v * dfz - v * fz * bend)
            ax += dup * ex + all_up * dex + dside * fx + all_side * dfx
            ay += dup * ey + all_up * dey + dside * fy + all_side * dfy
            az += dup * ez + all_up * dez + dside * fz + all_side * dfz
        out[0, j], out[1, j], out[2, j] = ax, ay, az
    if p[WINDS] > 0.0:  # so far the columns of the velocity hold what the air does, and no more
        gradient = np.empty((3, 3))
        wind_gradient(x, p, gradient)
        for i in range(3):
            for j in range(3):
                for k in range(3):
                    out[i, j] -= out[i, 3 + k] * gradient[k, j]
    if not swapped:
        out[0, 4] += 2.0 * w
        out[1, 3] -= 2.0 * w
    if p[ROTATION] == CENTRIFUGAL:
        out[0, 0] += w * w
        out[1, 1] += w * w
    out[0, OF_LIFT] = drag * (cos_bank * ex + sin_bank * fx)
    out[1, OF_LIFT] = drag * (cos_bank * ey + sin_bank * fy)
    out[2, OF_LIFT] = drag * (cos_bank * ez + sin_bank * fz)
    for i in range(3):
        out[i, OF_AIR] = lift * out[i, OF_LIFT]
    out[0, OF_AIR] -= drag * sx
    out[1, OF_AIR] -= drag * sy
    out[2, OF_AIR] -= drag * sz

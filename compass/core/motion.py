"""Where things are at a time, and how fast they can at most move: ellipses, sites and tables.

A mover is a row of `WIDTH` floats; its first says how the rest is read.

ELLIPSE: a, e, cos i, sin i, node, periapsis, mean anomaly at time 0, their three rates, and the
rotation (row by row) from the elements' frame to the inertial one.
SITE: distance from the spin axis, height above the equator, longitude, cosine and sine of the
latitude of up, middle and half length of the span, and the four coefficients of the prime
meridian's angle as a polynomial of ``(t - middle) / half``.
TABLE: first row and number of rows in the table of states, time of the first row, spacing, and
bounds: smallest and largest distance, largest speed, largest acceleration.
"""

import math

import numpy as np

from compass.core.jit import kernel
from compass.core.kepler import eccentric_anomaly

WIDTH = 20
ELLIPSE, SITE, TABLE = 0.0, 1.0, 2.0


@kernel
def mover_state(mover, table, t):
    """Inertial position and velocity ``(x, y, z, vx, vy, vz)`` of a mover at time t, m and m/s."""
    if mover[0] == ELLIPSE:
        return _ellipse_state(mover, t)
    if mover[0] == SITE:
        return _site_state(mover, t)
    return _table_state(mover, table, t)


@kernel
def _ellipse_state(m, t):
    a, e, ci, si = m[1], m[2], m[3], m[4]
    big_e = eccentric_anomaly(m[7] + m[10] * t, e)
    ce, se = math.cos(big_e), math.sin(big_e)
    root = math.sqrt(1.0 - e * e)
    rate = m[10] / (1.0 - e * ce)
    px, py = a * (ce - e), a * root * se
    qx, qy = -a * se * rate, a * root * ce * rate
    omega = m[6] + m[9] * t
    co, so = math.cos(omega), math.sin(omega)
    ux, uy = co * px - so * py, so * px + co * py
    wx = co * qx - so * qy - m[9] * uy
    wy = so * qx + co * qy + m[9] * ux
    node = m[5] + m[8] * t
    cn, sn = math.cos(node), math.sin(node)
    x, y, z = cn * ux - sn * ci * uy, sn * ux + cn * ci * uy, si * uy
    vx = cn * wx - sn * ci * wy - m[8] * y
    vy = sn * wx + cn * ci * wy + m[8] * x
    vz = si * wy
    return (
        m[11] * x + m[12] * y + m[13] * z,
        m[14] * x + m[15] * y + m[16] * z,
        m[17] * x + m[18] * y + m[19] * z,
        m[11] * vx + m[12] * vy + m[13] * vz,
        m[14] * vx + m[15] * vy + m[16] * vz,
        m[17] * vx + m[18] * vy + m[19] * vz,
    )


@kernel
def meridian(mover, t):
    """Angle (rad) of a site's meridian in the inertial frame, and its rate (rad/s)."""
    x = (t - mover[6]) / mover[7]
    angle = mover[8] + x * (mover[9] + x * (mover[10] + x * mover[11]))
    rate = (mover[9] + x * (2.0 * mover[10] + x * 3.0 * mover[11])) / mover[7]
    return angle + mover[3], rate


@kernel
def _site_state(m, t):
    angle, rate = meridian(m, t)
    x, y = m[1] * math.cos(angle), m[1] * math.sin(angle)
    return x, y, m[2], -rate * y, rate * x, 0.0


@kernel
def _table_state(m, table, t):
    """Cubic Hermite interpolation between rows of states."""
    h = m[4]
    last = int(m[2]) - 2
    k = min(max(math.floor((t - m[3]) / h), 0), last)
    row = int(m[1]) + k
    s = (t - m[3]) / h - k
    h00, h10 = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2
    h01, h11 = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)
    d00, d10 = 6.0 * s * (s - 1.0) / h, (1.0 - s) * (1.0 - 3.0 * s)
    d11 = s * (3.0 * s - 2.0)
    a, b = table[row], table[row + 1]
    return (
        h00 * a[0] + h10 * h * a[3] + h01 * b[0] + h11 * h * b[3],
        h00 * a[1] + h10 * h * a[4] + h01 * b[1] + h11 * h * b[4],
        h00 * a[2] + h10 * h * a[5] + h01 * b[2] + h11 * h * b[5],
        d00 * (a[0] - b[0]) + d10 * a[3] + d11 * b[3],
        d00 * (a[1] - b[1]) + d10 * a[4] + d11 * b[4],
        d00 * (a[2] - b[2]) + d10 * a[5] + d11 * b[5],
    )


@kernel
def mover_bounds(mover, ra, rb, h):
    """Bounds on a mover's motion over an interval, from its distances at the two ends.

    Parameters
    ----------
    mover
        The mover's row.
    ra, rb
        Distances from the centre at the ends, metres.
    h
        Length of the interval, seconds.

    Returns
    -------
    tuple
        Smallest and largest distance, largest speed and acceleration, and the largest of
        ``|r . v|`` and of its rate. On an ellipse ``|r . v| <= sqrt(GM a) e`` and its rate is
        ``GM (1/r - 1/a)``, whatever node and periapsis do, for they turn the orbit rigidly.
    """
    if mover[0] == ELLIPSE:
        a, e = mover[1], mover[2]
        gm = mover[10] * mover[10] * a * a * a
        radial = math.sqrt(gm / (a * (1.0 - e * e))) * e
        low = max(a * (1.0 - e), 0.5 * (ra + rb - radial * h))
        high = min(a * (1.0 + e), 0.5 * (ra + rb + radial * h))
        turn = abs(mover[8]) + abs(mover[9])
        speed = math.sqrt(max(gm * (2.0 / low - 1.0 / a), 0.0))
        return (
            low,
            high,
            speed + turn * high,
            gm / (low * low) + 2.0 * turn * speed + 2.0 * turn * turn * high,
            math.sqrt(gm * a) * e,
            gm * max(abs(1.0 / low - 1.0 / a), abs(1.0 / high - 1.0 / a)),
        )
    if mover[0] == SITE:
        # one part in 10^5 more than the mean rate: the periodic terms of the meridian's angle
        rate = 1.00001 * abs(mover[9]) / mover[7]
        return ra, ra, rate * ra, rate * rate * ra, 0.0, 0.0
    low, high, speed, acceleration = mover[5], mover[6], mover[7], mover[8]
    return low, high, speed, acceleration, high * speed, speed * speed + high * acceleration


@kernel
def states(mover, table, times):
    """States of a mover at many times, shape (t, 6)."""
    moved = np.empty((times.size, 6))
    for k in range(times.size):
        state = mover_state(mover, table, times[k])
        for j in range(6):
            moved[k, j] = state[j]
    return moved

"""Two-body motion: Kepler's equation and positions on ellipses."""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def eccentric_anomaly(mean_anomaly, eccentricity):
    """Solve ``E - e sin E = M`` for E by Newton's method inside a shrinking bracket.

    Good to a few units in the last place for every ``0 <= e < 1``; E is in the same
    revolution as M.
    """
    turns = math.floor(mean_anomaly / (2.0 * math.pi) + 0.5)
    m = mean_anomaly - 2.0 * math.pi * turns
    low, high = m - eccentricity, m + eccentricity
    e_anomaly = m + eccentricity * math.sin(m)
    for _ in range(64):
        residual = e_anomaly - eccentricity * math.sin(e_anomaly) - m
        if residual > 0.0:
            high = e_anomaly
        else:
            low = e_anomaly
        step = residual / (1.0 - eccentricity * math.cos(e_anomaly))
        following = e_anomaly - step
        if not (low <= following <= high):
            following = 0.5 * (low + high)
        if abs(following - e_anomaly) <= 4.5e-16 * max(1.0, abs(following)):
            e_anomaly = following
            break
        e_anomaly = following
    return e_anomaly + 2.0 * math.pi * turns


@kernel
def elliptic_states(a, e, i, raan0, argp0, m0, raan_rate, argp_rate, m_rate, times):
    """Position and velocity on ellipses whose node, periapsis and anomaly drift linearly.

    The velocity is the two-body one of the instantaneous ellipse plus the drift of the frame.

    Parameters
    ----------
    a, e, i, raan0, argp0, m0
        Elements at time 0, shape (n,): metres and radians.
    raan_rate, argp_rate, m_rate
        Their rates, shape (n,), rad/s.
    times
        Seconds, shape (t,).

    Returns
    -------
    r, v
        Shape (n, t, 3), m and m/s.
    """
    n, t = a.size, times.size
    r = np.empty((n, t, 3))
    v = np.empty((n, t, 3))
    for s in range(n):
        ci, si = math.cos(i[s]), math.sin(i[s])
        root = math.sqrt(1.0 - e[s] * e[s])
        for k in range(t):
            big_e = eccentric_anomaly(m0[s] + m_rate[s] * times[k], e[s])
            ce, se = math.cos(big_e), math.sin(big_e)
            # perifocal position and velocity, the anomaly running at m_rate
            rate = m_rate[s] / (1.0 - e[s] * ce)
            px, py = a[s] * (ce - e[s]), a[s] * root * se
            qx, qy = -a[s] * se * rate, a[s] * root * ce * rate
            omega = argp0[s] + argp_rate[s] * times[k]
            co, so = math.cos(omega), math.sin(omega)
            ux, uy = co * px - so * py, so * px + co * py
            wx = co * qx - so * qy - argp_rate[s] * uy
            wy = so * qx + co * qy + argp_rate[s] * ux
            node = raan0[s] + raan_rate[s] * times[k]
            cn, sn = math.cos(node), math.sin(node)
            x, y = cn * ux - sn * ci * uy, sn * ux + cn * ci * uy
            r[s, k, 0], r[s, k, 1], r[s, k, 2] = x, y, si * uy
            v[s, k, 0] = cn * wx - sn * ci * wy - raan_rate[s] * y
            v[s, k, 1] = sn * wx + cn * ci * wy + raan_rate[s] * x
            v[s, k, 2] = si * wy
    return r, v

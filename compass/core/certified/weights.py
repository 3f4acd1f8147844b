"""Rows of the design matrix weighed by the ranges' errors, over a box: slope and curvature.

A row ``w (e, 1)`` has ``w = S/sqrt(K S^2 + (n S + z)^2)``, one over the sigma of a range: S the
sine of the elevation, n and z the receiver's noise, and

    K = x'Q x + 2 q.x + p + a r^2 + b r^4 + d^2/(c + s S^2)

with x the line of sight along the satellite's radial, along-track and cross-track directions (its
orbit's normal), r the distance, d the ionosphere's delay straight up. It is smooth at the horizon.
Where z is 0 the receiver's n^2 belongs to K, and S counts as 1. Lengths are in equatorial radii,
variances in units of one that makes w at most about 1.

**Bounds.** Along a line from the centre of a box, with E1, E2 bounds of |e'|, |e''|, the axes
turning at O1 with ``|axes''| <= O2``, V and Acc as in `compass.core.certified.sights`::

    |S'|  <= S1 = |sum S_d u_d| + S2            S2 = wn + 2 v E1 + E2
    |x'|  <= E1 + O1                            |x''| <= E2 + 2 O1 E1 + O2
    |(x'Qx + 2 q.x)''| <= 2 |Q| |x'|^2 + 2 (|Qx + q| at the centre + |Q||x'|) |x''|
    |(r^2)'| <= 2 rM V,   |(r^2)''| <= 2 V^2 + 2 rM Acc,   |(r^4)''| <= 2 (r^2)'^2 + 2 rM^2 (r^2)''
    h = 1/(c + s S^2):    |h'| <= 2 s |S| h^2,  |h''| <= 10 s h^2

and with ``D = K S^2 + y^2, y = n S + z``::

    w_S = z y D^-3/2                            w_K = -S^3/2 D^-3/2
    w_SS = z n D^-3/2 - 3/2 z y (2 K S + 2 n y) D^-5/2
    w_SK = -3/2 z y S^2 D^-5/2                  w_KK = 3/4 S^5 D^-5/2

each bounded over the range of S and K. So |w''| <= W2, |w'| <= W1, and the row's

    |a''| <= sqrt(2) W2 + 2 W1 |e'| + w |e''|.
"""

import math

from compass.core.jit import kernel

#: Columns of what is known of a satellite's ranges: Q (xx, yy, zz, xy, xz, yz), q, p, Q's Frobenius
#: norm, O1 and O2 for a unit of time.
QUAD, LINE, REST, SIZE, TURN, TURN2, RANGE = 0, 6, 9, 10, 11, 12, 13

#: A weight: w, its three slopes, bounds W1, W2; then scratch.
WEIGHT, BY, W1, W2, WEIGHED = 0, 1, 4, 5, 11

#: Numbers that all ranges share, after those of `compass.core.certified.sights`: n, z, a, b, d^2
#: and s, with ``c = 1 - s``.
NOISE, ZENITH, LOOP, LOOP2, DELAY2, SHELL2, SHARED = 0, 1, 2, 3, 4, 5, 6


@kernel
def orbit_variance(e, slopes, q, dq, ht, node_rate, about, out):
    """Variance of a satellite's place and clock along a line of sight: value, slopes and |Qx + q|.

    Parameters
    ----------
    e, slopes
        Line of sight and its three slopes over the box, shapes (3,) and (9,).
    q, dq
        Place and velocity of the satellite, shape (3,); `ht` half the box's time.
    node_rate
        Of the orbit's node as seen.
    about
        What is known of its ranges, shape (RANGE,).
    out
        Filled: value, three slopes, |Qx + q|.
    """
    # seen from its node the satellite moves in a plane that stands still
    vx, vy, vz = dq[0] + node_rate * q[1], dq[1] - node_rate * q[0], dq[2]
    cx, cy, cz = q[1] * vz - q[2] * vy, q[2] * vx - q[0] * vz, q[0] * vy - q[1] * vx
    h = math.sqrt(cx * cx + cy * cy + cz * cz)
    r = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    cx, cy, cz = cx / h, cy / h, cz / h
    rx, ry, rz = q[0] / r, q[1] / r, q[2] / r
    ax, ay, az = cy * rz - cz * ry, cz * rx - cx * rz, cx * ry - cy * rx
    spin = h / (r * r)
    x = e[0] * rx + e[1] * ry + e[2] * rz
    y = e[0] * ax + e[1] * ay + e[2] * az
    z = e[0] * cx + e[1] * cy + e[2] * cz
    gx = about[0] * x + about[3] * y + about[4] * z + about[6]
    gy = about[3] * x + about[1] * y + about[5] * z + about[7]
    gz = about[4] * x + about[5] * y + about[2] * z + about[8]
    out[0] = x * (gx + about[6]) + y * (gy + about[7]) + z * (gz + about[8]) + about[REST]
    # what the line of sight does against the axes: along it, d/dt of axes . e is -(w x e) . axes
    wx, wy, wz = spin * cx, spin * cy, spin * cz + node_rate
    tx, ty, tz = wy * e[2] - wz * e[1], wz * e[0] - wx * e[2], wx * e[1] - wy * e[0]
    for d in range(3):
        sx, sy, sz = slopes[3 * d], slopes[3 * d + 1], slopes[3 * d + 2]
        if d == 2:
            sx, sy, sz = sx - tx * ht, sy - ty * ht, sz - tz * ht
        out[1 + d] = 2.0 * (
            gx * (sx * rx + sy * ry + sz * rz)
            + gy * (sx * ax + sy * ay + sz * az)
            + gz * (sx * cx + sy * cy + sz * cz)
        )
    out[4] = math.sqrt(gx * gx + gy * gy + gz * gz)


@kernel
def line_weight(e, slopes, user, distance, q, dq, ht, node_rate, bounds, about, shared, slack, out):
    """Weight of a line of sight over a box; False where no bound of it is known.

    Parameters
    ----------
    e, slopes, q, dq, ht, node_rate, about
        As of `orbit_variance`.
    user
        From `compass.core.certified.sights.place`.
    distance
        Distance and its three slopes, sine of the elevation, shape (5,).
    bounds
        V, Acc, the shortest distance, bounds of |e'| and |e''|, shape (5,).
    shared
        Of all ranges, shape (SHARED,).
    slack
        Bound on the error of the satellite's place.
    out
        Filled: see `WEIGHT`; shape (WEIGHED,).
    """
    reach, swing, nearest, e1, e2 = bounds[0], bounds[1], bounds[2], bounds[3], bounds[4]
    v, wn = user[18], user[19]
    o1, o2 = about[TURN] * ht, about[TURN2] * ht * ht
    spare = out[W2 + 1 :]
    orbit_variance(e, slopes, q, dq, ht, node_rate, about, spare)
    flat = shared[ZENITH] == 0.0
    n, zenith = (0.0, 0.0) if flat else (shared[NOISE], shared[ZENITH])
    a, b, d2, s = shared[LOOP], shared[LOOP2], shared[DELAY2], shared[SHELL2]
    # sine of the elevation
    sine, sine2 = distance[4], wn + 2.0 * v * e1 + e2
    sine1 = sine2
    for d in range(3):
        slope = user[0] * slopes[3 * d] + user[1] * slopes[3 * d + 1] + user[2] * slopes[3 * d + 2]
        if d < 2:
            slope += user[6 + 3 * d] * e[0] + user[7 + 3 * d] * e[1] + user[8 + 3 * d] * e[2]
        out[BY + d] = slope
        sine1 += abs(slope)
    lowest = sine - sine1
    least = 0.0 if lowest <= 0.0 <= sine + sine1 else min(abs(lowest), abs(sine + sine1))
    most = min(max(abs(lowest), abs(sine + sine1)), 1.0)
    # all but the receiver's noise
    r, far = distance[0], distance[0] + reach
    r2 = r * r
    layer, thick = 1.0 / (1.0 - s + s * sine * sine), 1.0 / (1.0 - s + s * least * least)
    k = (
        spare[0]
        + a * r2
        + b * r2 * r2
        + d2 * layer
        + (shared[NOISE] * shared[NOISE] if flat else 0.0)
    )
    moved, bent = e1 + o1, e2 + 2.0 * o1 * e1 + o2
    square1, square2 = 2.0 * far * reach, 2.0 * reach * reach + 2.0 * far * swing
    thick2 = thick * thick
    k2 = 2.0 * about[SIZE] * moved * moved + 2.0 * (spare[4] + about[SIZE] * moved) * bent
    k2 += a * square2 + b * (2.0 * square1 * square1 + 2.0 * far * far * square2)
    k2 += d2 * s * thick2 * (10.0 * sine1 * sine1 + 2.0 * most * sine2)
    k1 = k2
    for d in range(3):
        by = 2.0 * r * distance[1 + d]
        spare[1 + d] += (
            a * by + 2.0 * b * r2 * by - 2.0 * d2 * s * sine * layer * layer * out[BY + d]
        )
        k1 += abs(spare[1 + d])
    low, high = max(k - k1, 0.0), k + k1
    if flat:
        sine, least, most, sine1, sine2, y_low, y_high = 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0
    else:
        y_low, y_high = n * lowest + zenith, n * most + zenith
        if y_low < 0.25 * zenith:
            return False
    bottom = low * least * least + y_low * y_low
    if not bottom > 0.0:
        return False
    y = n * sine + zenith
    middle = k * sine * sine + y * y
    w = sine / math.sqrt(middle)
    inner = 1.0 / (middle * math.sqrt(middle))
    by_sine, by_k = zenith * y * inner, -0.5 * sine * sine * sine * inner
    for d in range(3):
        out[BY + d] = by_sine * out[BY + d] + by_k * spare[1 + d]
    root = 1.0 / (bottom * math.sqrt(bottom))
    fifth = root / bottom
    ws, wk = zenith * y_high * root, 0.5 * most * most * most * root
    wss = zenith * n * root + 3.0 * zenith * y_high * (high * most + n * y_high) * fifth
    wsk = 1.5 * zenith * y_high * most * most * fifth
    wkk = 0.75 * most * most * most * most * most * fifth
    out[WEIGHT] = w
    out[W2] = wss * sine1 * sine1 + 2.0 * wsk * sine1 * k1 + wkk * k1 * k1 + ws * sine2 + wk * k2
    total = 0.0
    for d in range(3):
        total += abs(out[BY + d])
    out[W1] = min(total + out[W2], ws * sine1 + wk * k1)
    # what an error of the satellite's place does: its direction, the axes, the distance
    turned = 2.0 * slack / nearest
    error = 2.0 * (spare[4] + about[SIZE] * moved) * (turned + 4.0 * slack / r)
    error += (
        2.0 * a * far + 4.0 * b * far * far * far
    ) * slack + 2.0 * d2 * s * most * thick2 * turned
    out[W2] += 2.0 * (ws * turned + wk * error)
    return True

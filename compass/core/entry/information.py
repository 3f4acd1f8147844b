"""What each satellite tells a lander that enters past it: information on its errors u.

As `compass.core.entry.many` has them, whitened; matrices of information are packed as there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.loop import carrier_to_noise, loop_variance
from compass.core.entry.many import WAYS, add_square
from compass.core.jit import fast_kernel, kernel
from compass.core.smallmatrix import cholesky, cholesky_solve, matmul

Array = NDArray[np.float64]


class Satellites(NamedTuple):
    """Who transmits: `r`, `v` (n, m nodes, 3) inertial at the nodes of each entry, SI.

    `angles` (m,) are Mars's rotation at the first nodes (rad), `omega` its rate (rad/s), `step` the
    seconds between nodes. `roots` (n, 5, 5) are of the satellites' errors, the last column the
    bias of ranges; (n, 5, 0) for none.
    """

    r: Array
    v: Array
    angles: Array
    omega: float
    step: float
    roots: Array


class Receiver(NamedTuple):
    """What the lander measures, and when.

    `dt`: seconds between epochs. `weights` (m, t): expected measurements at each, 0 where none is
    due, else the probability that one arrives. `variances` (4,): of ranges (m^2) and range rates
    (m^2/s^2) one way, then of both there and back; nan for what is not measured. `link` (6,): of
    `compass.core.entry.loop`, whose loop adds to the noise of ranges and hears no satellite that
    is too faint; (0,) for none; `dimmed` (m, t): what plasma takes away, dB. `clock` (2,): sigmas
    of the receiver's clock and drift, the last two components of u then, which enter what is
    measured one way; (0,) for none.
    """

    dt: float
    weights: Array
    variances: Array
    link: Array
    dimmed: Array
    clock: Array


class Limb(NamedTuple):
    """Radius of the sphere that hides satellites, m, and sine and cosine of the mask over it.

    Of many patterns each has a mask of its own, (c,).
    """

    radius: float
    sin_mask: float | Array
    cos_mask: float | Array


@fast_kernel
def turn_nodes(r, v, sample, nodes, angle, omega, step, out):
    """States of all satellites at the nodes of one entry, from inertial to Mars-fixed axes.

    Parameters
    ----------
    r, v
        Inertial, shape (n, m * nodes, 3).
    sample, nodes
        Which entry, and how many nodes it has.
    angle, omega, step
        Rotation angle at its first node (rad), rotation rate (rad/s), seconds between nodes.
    out
        Output, (n, nodes, 6).
    """
    for j in range(nodes):
        turned = angle + omega * step * j
        c, s = math.cos(turned), math.sin(turned)
        at = sample * nodes + j
        for i in range(r.shape[0]):
            x, y = r[i, at, 0], r[i, at, 1]
            vx, vy = v[i, at, 0] + omega * y, v[i, at, 1] - omega * x
            out[i, j, 0], out[i, j, 1], out[i, j, 2] = c * x + s * y, c * y - s * x, r[i, at, 2]
            out[i, j, 3], out[i, j, 4], out[i, j, 5] = c * vx + s * vy, c * vy - s * vx, v[i, at, 2]


@fast_kernel
def hermite(s, step, out):
    """Weights of a cubic between two nodes: `s` in [0, 1] of the `step` seconds; into `out` (6).

    Position ``a + w0 (b - a) + w1 a' + w2 b'``, velocity ``w3 (b - a) + w4 a' + w5 b'``. The
    position is off by at most ``(step n)^4 r / 384`` for a circle of rate n and radius r: 2e-6 m
    at 20 000 km and 9 mm at 300 km above Mars, for nodes 30 s apart.
    """
    out[0], out[3] = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / step
    out[1], out[2] = s * (1.0 - s) * (1.0 - s) * step, s * s * (s - 1.0) * step
    out[4], out[5] = (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)


@fast_kernel
def horizon(x, y, z, radius, sin_mask, cos_mask):
    """Distance of a lander from the centre, and the sine of the lowest elevation that it sees.

    A satellite is seen that stands at least the mask above the limb of the sphere of `radius`:
    ``sin(elevation) >= sin(mask - dip)``, ``cos(dip) = R/r``. For a mask of 0 that is a line of
    sight that clears the sphere.
    """
    high = math.sqrt(x * x + y * y + z * z)
    cos_dip = min(1.0, radius / high)
    return high, sin_mask * cos_dip - cos_mask * math.sqrt(1.0 - cos_dip * cos_dip)


@fast_kernel
def directions(satellite, omega, axes):
    """Write a satellite's radial, along and cross directions (rows) and return its rate, rad/s.

    Of its inertial motion; `satellite` is position and velocity in axes that turn by `omega`.
    """
    x, y, z = satellite[0], satellite[1], satellite[2]
    vx, vy, vz = satellite[3] - omega * y, satellite[4] + omega * x, satellite[5]
    cx, cy, cz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    r2 = x * x + y * y + z * z
    r, c = math.sqrt(r2), math.sqrt(cx * cx + cy * cy + cz * cz)
    axes[0, 0], axes[0, 1], axes[0, 2] = x / r, y / r, z / r
    axes[2, 0], axes[2, 1], axes[2, 2] = cx / c, cy / c, cz / c
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        axes[1, i] = axes[2, j] * axes[0, k] - axes[2, k] * axes[0, j]
    return c / r2


@fast_kernel
def information(flights, receiver, satellites, limb, seen, out, sums):
    """Information on u that each satellite gives in each entry.

    A satellite's own errors p, constant in its radial, along and cross directions, in its clock and
    as a bias of its ranges, are whitened too: ``p = root e``. What it tells about u is what is left
    after its errors are found out as far as they can be, ``F_uu - F_up (I + F_pp)^-1 F_pu``. Over
    an entry F_up and F_pp are gathered in p, `WAYS` numbers, and whitened once at its end.

    Parameters
    ----------
    flights
        Of `compass.core.entry.many.fly_many`.
    receiver, satellites, limb
        `Receiver`, `Satellites`, `Limb`.
    seen
        Output, (m, t, n): which satellites are in view and strong enough.
    out
        Output, (m, n, d (d + 1)/2): ``sum over epochs of weight h^T h / variance``, less what its
        own errors take.
    sums
        Output, (m, 4, d (d + 1)/2), over all satellites: `F_uu` as if they had no errors; `F_up
        F_pu`, by which a gain that does not know of them is spoilt; and the same of the best
        gain for orbits and clocks, and for biases of ranges.
    """
    paths, gains, stops = flights
    dt, weights, variances, link, dimmed, clock = receiver
    r, v, angles, omega, step, roots = satellites
    radius, sin_mask, cos_mask = limb
    n, motion, errors = r.shape[0], gains.shape[3], roots.shape[2]
    size = motion + clock.size
    nodes = r.shape[1] // max(paths.shape[0], 1)
    node, w = np.empty((n, nodes, 6)), np.empty(6)
    gain, h = np.empty((6, motion)), np.zeros(size)
    here, axes, s = np.empty(6), np.empty((3, 3)), np.empty(WAYS)
    cross, own = np.empty((n, size, WAYS)), np.empty((n, WAYS, WAYS))
    ranged = not (math.isnan(variances[0]) and math.isnan(variances[2]))
    rated = not (math.isnan(variances[1]) and math.isnan(variances[3]))
    for m in range(paths.shape[0]):
        turn_nodes(r, v, m, nodes, angles[m], omega, step, node)
        cross[:] = 0.0
        own[:] = 0.0
        for t in range(stops[m] + 1):
            weight = weights[m, t]
            px, py, pz = paths[m, t, 0], paths[m, t, 1], paths[m, t, 2]
            ux, uy, uz = paths[m, t, 3], paths[m, t, 4], paths[m, t, 5]
            for i in range(6):
                for j in range(motion):
                    gain[i, j] = gains[m, t, i, j]
            high, lowest = horizon(px, py, pz, radius, sin_mask, cos_mask)
            k = min(int(t * dt / step), nodes - 2)
            hermite(t * dt / step - k, step, w)
            w0, w1, w2, w3, w4, w5 = w
            for i in range(n):
                ax, ay, az = node[i, k, 0], node[i, k, 1], node[i, k, 2]
                dx, dy, dz = node[i, k + 1, 0] - ax, node[i, k + 1, 1] - ay, node[i, k + 1, 2] - az
                x = px - ax - w0 * dx - w1 * node[i, k, 3] - w2 * node[i, k + 1, 3]
                y = py - ay - w0 * dy - w1 * node[i, k, 4] - w2 * node[i, k + 1, 4]
                z = pz - az - w0 * dz - w1 * node[i, k, 5] - w2 * node[i, k + 1, 5]
                distance = math.sqrt(x * x + y * y + z * z)
                if -(x * px + y * py + z * pz) < lowest * distance * high:
                    continue
                nx, ny, nz = x / distance, y / distance, z / distance
                loop = 0.0
                if link.size > 0:
                    loop = loop_variance(
                        link,
                        carrier_to_noise(link, paths[m, t], distance, -nx, -ny, -nz, dimmed[m, t]),
                    )
                    if math.isnan(loop):
                        continue
                seen[m, t, i] = True
                if weight == 0.0:
                    continue
                vx = ux - w3 * dx - w4 * node[i, k, 3] - w5 * node[i, k + 1, 3]
                vy = uy - w3 * dy - w4 * node[i, k, 4] - w5 * node[i, k + 1, 4]
                vz = uz - w3 * dz - w4 * node[i, k, 5] - w5 * node[i, k + 1, 5]
                turn = 0.0
                if errors > 0:
                    here[0], here[1], here[2] = px - x, py - y, pz - z
                    here[3], here[4], here[5] = ux - vx, uy - vy, uz - vz
                    turn = directions(here, omega, axes)
                if ranged:
                    for j in range(motion):
                        h[j] = nx * gain[0, j] + ny * gain[1, j] + nz * gain[2, j]
                    if errors > 0:
                        for a in range(3):
                            s[a] = -nx * axes[a, 0] - ny * axes[a, 1] - nz * axes[a, 2]
                        s[3] = 1.0
                    for back in range(2):  # there and back no clock of the lander enters
                        if math.isnan(variances[2 * back]):
                            continue
                        if clock.size > 0:
                            h[motion], h[motion + 1] = clock[0], clock[1] * t * dt
                            if back == 1:
                                h[motion], h[motion + 1] = 0.0, 0.0
                        worth = weight / (variances[2 * back] + loop)
                        add_square(h, worth, out, m, i)
                        if errors > 0:
                            _add_errors(h, s, worth, cross, own, i)
                if rated:
                    # R' = n . dv: (dv - R' n) / R on position, n on velocity
                    rate = vx * nx + vy * ny + vz * nz
                    vx, vy, vz = vx - rate * nx, vy - rate * ny, vz - rate * nz
                    for j in range(motion):
                        across = vx * gain[0, j] + vy * gain[1, j] + vz * gain[2, j]
                        along = nx * gain[3, j] + ny * gain[4, j] + nz * gain[5, j]
                        h[j] = across / distance + along
                    if errors > 0:
                        # the error stays in the satellite's directions, which turn with it
                        tx, ty = turn * axes[2, 0], turn * axes[2, 1]
                        tz = turn * axes[2, 2] - omega
                        for a in range(3):
                            ex, ey, ez = axes[a, 0], axes[a, 1], axes[a, 2]
                            moves = nx * (ty * ez - tz * ey) + ny * (tz * ex - tx * ez)
                            moves += nz * (tx * ey - ty * ex)
                            s[a] = -(vx * ex + vy * ey + vz * ez) / distance - moves
                        s[3] = 0.0
                    for back in range(2):
                        if math.isnan(variances[1 + 2 * back]):
                            continue
                        if clock.size > 0:
                            h[motion], h[motion + 1] = 0.0, clock[1] * (1.0 - back)
                        worth = weight / variances[1 + 2 * back]
                        add_square(h, worth, out, m, i)
                        if errors > 0:
                            _add_errors(h, s, worth, cross, own, i)
        for i in range(n):
            _eliminate(cross[i], own[i], roots[i], out[m, i], sums[m])


@fast_kernel
def _add_errors(h, s, weight, cross, own, i):
    """Add ``weight h^T s`` and ``weight s^T s`` to those of a satellite."""
    for a in range(h.size):
        scaled = weight * h[a]
        for k in range(WAYS):
            cross[i, a, k] += scaled * s[k]
    for a in range(WAYS):
        scaled = weight * s[a]
        for k in range(WAYS):
            own[i, a, k] += scaled * s[k]


@kernel
def _eliminate(told, erring, root, share, sums):
    """Take a satellite's own errors out of what it tells, in place; see `information`.

    Parameters
    ----------
    told, erring
        ``sum h^T s`` (d, WAYS) and ``sum s^T s`` (WAYS, WAYS), weighted.
    root
        Of its errors, (5, k).
    share, sums
        Its part of `out` and that of `sums` over all satellites.
    """
    size, errors = told.shape[0], root.shape[1]
    ways = root[:WAYS].copy()
    ways[WAYS - 1] += root[WAYS]  # clock and bias do the same to a range
    cross, half = np.empty((size, errors)), np.empty((WAYS, errors))
    own, low = np.empty((errors, errors)), np.empty((errors, errors))
    matmul(told, ways, cross)
    matmul(erring, ways, half)
    for a in range(errors):
        for b in range(errors):
            own[a, b] = 1.0 if a == b else 0.0
            for k in range(WAYS):
                own[a, b] += ways[k, a] * half[k, b]
    cholesky(own, low)  # at least the unit matrix
    gains = np.empty((size, errors))  # F_up (I + F_pp)^-1
    for j in range(size):
        gains[j] = cross[j]
        cholesky_solve(low, gains[j])
    k = 0
    for a in range(size):
        for b in range(a + 1):
            sums[0, k] += share[k]
            for e in range(errors):
                share[k] -= gains[a, e] * cross[b, e]
                sums[1, k] += cross[a, e] * cross[b, e]
                sums[2 if e < errors - 1 else 3, k] += gains[a, e] * gains[b, e]
            k += 1

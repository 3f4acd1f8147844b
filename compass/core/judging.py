"""Many entries past a constellation: flights with sensitivities, information, bounds.

Errors are carried in prior-whitened coordinates u: the state error at any epoch is ``S u`` with
``S S^T`` the prior moved to that epoch, so u has the unit matrix as its prior covariance. Without
process noise u is constant through the entry and information about it simply adds up, satellite
by satellite; losing one is leaving out its share.
"""

import math

import numpy as np

from compass.core.entry_dynamics import BANK, STATES, rk4_step_transition
from compass.core.entry_geometry import cartesian, cartesian_jacobian
from compass.core.jit import fast_kernel, kernel

#: Entries of a symmetric 6 by 6 matrix, row by row of its lower triangle.
PACKED = 21


@kernel
def fly_many(starts, spreads, p, banks, dt, watch, level, ground, states, paths, gains, stops):
    """Fly every entry to its end, by Runge-Kutta steps and their derivatives.

    Parameters
    ----------
    starts
        States (8) at entry, shape (m, 8).
    spreads
        S at entry, shape (m, 6, 6).
    p, banks
        Parameters of the dynamics, and the bank angle from each epoch to the next, (t,).
    dt
        Seconds between epochs.
    watch, level
        The flight ends at the first epoch at which this state is at or below the level; -1 for
        the last epoch.
    ground
        Radius below which the flight has failed, metres.
    states
        Output, (m, t, 8).
    paths
        Output, Cartesian position and velocity, (m, t, 6).
    gains
        Output, (m, t, 6, 6): derivative of `paths` in u.
    stops
        Output, (m,): index of the last epoch; ``-1 - t`` where the flight failed at epoch t.
    """
    p = p.copy()
    after, phi = np.empty(STATES), np.empty((STATES, STATES))
    jacobian, spread, moved = np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    last = banks.size - 1
    for m in range(starts.shape[0]):
        states[m, 0] = starts[m]
        spread[:, :] = spreads[m]
        stops[m] = last
        for t in range(last + 1):
            if t > 0:
                p[BANK] = banks[t - 1]
                rk4_step_transition(states[m, t - 1], p, dt, after, phi)
                states[m, t] = after
                _product(phi, spread, moved)
                spread[:, :] = moved
            if not states[m, t, 0] > ground or not math.isfinite(states[m, t, 5]):
                stops[m] = -1 - t
                break
            cartesian(states[m, t], paths[m, t])
            cartesian_jacobian(states[m, t], jacobian)
            _product(jacobian, spread, gains[m, t])
            if watch >= 0 and states[m, t, watch] <= level:
                stops[m] = t
                break


@fast_kernel
def _product(a, b, out):
    """Leading 6 by 6 part of ``a b``."""
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += a[i, k] * b[k, j]
            out[i, j] = total


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
def between(node, time, step, out):
    """Position and velocity of a satellite between its nodes (j, 6): cubic Hermite, into `out`.

    The position is off by at most ``(step n)^4 a / 384`` for a circle of rate n and radius a:
    2e-6 m at 20 000 km and 9 mm at 300 km above Mars, for nodes 30 s apart.
    """
    j = min(int(time / step), node.shape[0] - 2)
    s = time / step - j
    a, b = node[j], node[j + 1]
    p, q = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / step
    u, w = s * (1.0 - s) * (1.0 - s) * step, s * s * (s - 1.0) * step
    du, dw = (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)
    for i in range(3):
        out[i] = a[i] + p * (b[i] - a[i]) + u * a[i + 3] + w * b[i + 3]
        out[i + 3] = q * (b[i] - a[i]) + du * a[i + 3] + dw * b[i + 3]


@fast_kernel
def sight(path, satellite, radius, sin_mask, cos_mask, line):
    """Whether a lander sees a satellite; `line` becomes direction (3), range and range rate.

    Seen if the satellite stands at least the mask above the limb of the sphere of `radius`:
    ``sin(elevation) >= sin(mask - dip)``, ``cos(dip) = R/r``. For a mask of 0 that is a line of
    sight that clears the sphere.
    """
    square, up, high = 0.0, 0.0, 0.0
    for i in range(3):
        line[i] = path[i] - satellite[i]
        square += line[i] * line[i]
        up -= line[i] * path[i]
        high += path[i] * path[i]
    distance, high = math.sqrt(square), math.sqrt(high)
    cos_dip = min(1.0, radius / high)
    lowest = sin_mask * cos_dip - cos_mask * math.sqrt(1.0 - cos_dip * cos_dip)
    line[3], line[4] = distance, 0.0
    for i in range(3):
        line[i] /= distance
        line[4] += line[i] * (path[i + 3] - satellite[i + 3])
    return up >= lowest * distance * high


@fast_kernel
def row(gain, line, path, satellite, kind, out):
    """Derivative in u of a range (`kind` 0) or range rate (1) along `line`, into `out` (6)."""
    for j in range(6):
        if kind == 0:
            out[j] = line[0] * gain[0, j] + line[1] * gain[1, j] + line[2] * gain[2, j]
        else:
            total = 0.0
            for i in range(3):
                across = path[i + 3] - satellite[i + 3] - line[4] * line[i]
                total += across / line[3] * gain[i, j] + line[i] * gain[i + 3, j]
            out[j] = total


@fast_kernel
def information(
    paths, gains, stops, weights, variances, r, v, angles, omega, step, dt, radius, sin_mask,
    cos_mask, seen, out,
):  # fmt: skip
    """Information on u that each satellite gives in each entry.

    Parameters
    ----------
    paths, gains, stops
        Of `fly_many`.
    weights
        Expected measurements at each epoch, (m, t): 0 where none is due, else the probability
        that one arrives.
    variances
        Of ranges (m^2) and range rates (m^2/s^2); nan for one that is not measured.
    r, v, angles, omega, step
        Satellites at the nodes, as in `turn_nodes`; `angles` (m,).
    dt
        Seconds between epochs.
    radius, sin_mask, cos_mask
        As in `sight`.
    seen
        Output, (m, t, n): which satellites are in view.
    out
        Output, (m, n, PACKED): ``sum over epochs of weight h^T h / variance``.
    """
    n = r.shape[0]
    nodes = r.shape[1] // max(paths.shape[0], 1)
    node, satellite = np.empty((n, nodes, 6)), np.empty(6)
    line, h = np.empty(5), np.empty(6)
    for m in range(paths.shape[0]):
        turn_nodes(r, v, m, nodes, angles[m], omega, step, node)
        for t in range(stops[m] + 1):
            for i in range(n):
                between(node[i], t * dt, step, satellite)
                if not sight(paths[m, t], satellite, radius, sin_mask, cos_mask, line):
                    continue
                seen[m, t, i] = True
                if weights[m, t] == 0.0:
                    continue
                for kind in range(2):
                    if math.isnan(variances[kind]):
                        continue
                    row(gains[m, t], line, paths[m, t], satellite, kind, h)
                    weight = weights[m, t] / variances[kind]
                    k = 0
                    for a in range(6):
                        for b in range(a + 1):
                            out[m, i, k] += weight * h[a] * h[b]
                            k += 1


@kernel
def bounds(shares, gains, stops, out):
    """Posterior sigma of position (m) and velocity (m/s) at the end of each entry.

    Parameters
    ----------
    shares
        Information of each satellite, (m, n, PACKED).
    gains, stops
        Of `fly_many`.
    out
        Output, (m, 1 + n, 2): with all satellites, then without each of them. Roots of the
        traces of the parts of ``B (I + F)^-1 B^T``, B the gain at the end.
    """
    n = shares.shape[1]
    low, y = np.empty((6, 6)), np.empty(6)
    for m in range(shares.shape[0]):
        gain = gains[m, stops[m]]
        for lost in range(-1, n):
            k = 0
            for a in range(6):
                for b in range(a + 1):
                    total = 1.0 if a == b else 0.0
                    for i in range(n):
                        if i != lost:
                            total += shares[m, i, k]
                    low[a, b] = total
                    k += 1
            # Cholesky in place; every eigenvalue is at least 1
            for a in range(6):
                for b in range(a + 1):
                    total = low[a, b]
                    for c in range(b):
                        total -= low[a, c] * low[b, c]
                    low[a, b] = math.sqrt(total) if a == b else total / low[b, b]
            for part in range(2):
                trace = 0.0
                for i in range(3 * part, 3 * part + 3):
                    for a in range(6):
                        total = gain[i, a]
                        for c in range(a):
                            total -= low[a, c] * y[c]
                        y[a] = total / low[a, a]
                        trace += y[a] * y[a]
                out[m, 1 + lost, part] = math.sqrt(trace)

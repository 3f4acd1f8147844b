"""Orbits by Gauss-Legendre collocation: the result is a polynomial on every step.

On a step of length h the acceleration is interpolated at s Gauss nodes; integrated twice it gives
the position as a Legendre series of degree s + 1, and the place and velocity at the end to order
2 s (Hairer, Norsett and Wanner 1993, II.7). The equations are solved by substitution, the central
attraction in many cheap sweeps, everything else in a few dear ones: each of those brings the
positions closer by the ratio of the gradients of perturbation and attraction, some 1e-3.

All satellites share the steps, so that what does not depend on them (Sun, moons, meridian) is
found once, and a moment of the whole constellation is one piece of one table.

A shadow is a step in the acceleration, which no polynomial follows. Its projection on the first
s Legendre polynomials has the same integrals against polynomials of degree below s, thus the same
place and velocity at the end of the step; in between the path is off by at most some
``a (h / 2 s)^2``, centimetres, which counts as error.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.forces import (
    GM,
    MARS_RADIUS,
    SHADOW,
    SUN_RADIUS,
    SUNLIGHT,
    lit,
    perturbation,
    sky_at,
)
from compass.core.jit import fast_kernel

Array = NDArray[np.float64]

#: Places of a step in which shadow is looked for.
CELLS = 64

#: Sweeps over the central attraction and over everything before a step is taken as too long.
SWEEPS, PASSES = 60, 12

#: Relative change of the positions at which sweeps and passes end: the next would change them
#: 10 and 1000 times less.
SWEEP_END, PASS_END = 1e-14, 1e-12


@fast_kernel
def legendre_sums(coefficients, x):
    """Three series at once: ``sum_k c[i, k] P_k(x)`` for the rows i of `coefficients`."""
    p, q = 1.0, 0.0
    a, b, c = 0.0, 0.0, 0.0
    for k in range(coefficients.shape[1]):
        a += coefficients[0, k] * p
        b += coefficients[1, k] * p
        c += coefficients[2, k] * p
        p, q = ((2 * k + 1) * x * p - k * q) / (k + 1), p
    return a, b, c


@fast_kernel
def _share_at(x, path, near, sun, constants):
    px, py, pz = legendre_sums(path, x)
    kind, mars, size = constants[SHADOW], constants[MARS_RADIUS], constants[SUN_RADIUS]
    # the Sun moves by a line within a step: a second of arc in hours
    sx = sun[0, 0] + 0.5 * (x + 1.0) * (sun[1, 0] - sun[0, 0])
    sy = sun[0, 1] + 0.5 * (x + 1.0) * (sun[1, 1] - sun[0, 1])
    sz = sun[0, 2] + 0.5 * (x + 1.0) * (sun[1, 2] - sun[0, 2])
    if near and px * sx + py * sy + pz * sz >= 0.0:
        return 1.0
    return lit(px, py, pz, sx, sy, sz, kind, mars, size)


@fast_kernel
def project_light(path, sun, constants, project, values, shares):
    """Share of sunlight along a step, projected on the Legendre polynomials that nodes can tell.

    Between two places of different share the light counts as a step from one to the other where
    it passes their mean: of a penumbra, minutes long, that keeps the sum.

    Parameters
    ----------
    path
        Position as Legendre series, shape (3, s + 2).
    sun
        Place of the Sun at both ends, shape (2, 3).
    constants
        As in `compass.core.forces`.
    project
        Integrals of ``(2k + 1) / 2 P_k``: Legendre coefficients by row, shape (s, s + 1).
    values
        P_k at the nodes, shape (s, s).
    shares
        Takes the projection at the nodes, shape (s,).

    Returns
    -------
    bool
        Whether there is any shadow.
    """
    s = values.shape[0]
    width = 2.0 / CELLS
    left, dark = _share_at(-1.0, path, True, sun, constants), False
    moments = np.zeros(s)
    powers = np.empty(s + 1)
    start, level = -1.0, left
    for cell in range(1, CELLS + 2):
        # at the end everything since the last change is closed
        x = -1.0 + width * min(cell, CELLS)
        right = _share_at(x, path, True, sun, constants) if cell <= CELLS else -1.0
        dark = dark or right == 0.0 or 0.0 < right < 1.0 or left < 1.0
        if right == level:
            continue
        stop = 1.0
        if cell <= CELLS:
            low, high, middle = x - width, x, 0.5 * (level + right)
            for _ in range(40):
                stop = 0.5 * (low + high)
                if (_share_at(stop, path, True, sun, constants) - middle) * (right - middle) > 0.0:
                    high = stop
                else:
                    low = stop
        if level > 0.0:
            for sign, end in ((1.0, stop), (-1.0, start)):
                p, q = 1.0, 0.0
                for k in range(s + 1):
                    powers[k] = p
                    p, q = ((2 * k + 1) * end * p - k * q) / (k + 1), p
                for k in range(s):
                    total = 0.0
                    for j in range(k + 2):
                        total += project[k, j] * powers[j]
                    moments[k] += sign * level * total
        start, level, left = stop, right, right
    for i in range(s):
        shares[i] = 0.0
        for k in range(s):
            shares[i] += moments[k] * values[i, k]
    return dark


class Arcs(NamedTuple):
    """Orbits of n satellites in p steps.

    `breaks` (p + 1,) are the ends of the steps, `paths` (p, n, 3, s + 2) Legendre coefficients of
    the positions, `errors` (p, n) the size of what they leave out, m.
    """

    breaks: Array
    paths: Array
    errors: Array


@fast_kernel
def collocate(states, start, stop, first, longest, tolerance, rule, light, forces, arcs):
    """Follow satellites from `start` towards `stop`, as far as the output arrays reach.

    Parameters
    ----------
    states
        Position and velocity of each satellite, shape (n, 6), m and m/s; those at the end of the
        last step when the kernel returns.
    start, stop
        Seconds; `stop` may be earlier.
    first, longest
        Length of the first step to try and of the longest, s, positive.
    tolerance
        Largest last terms of a step's series, m.
    rule
        Nodes, shape (s,), end weights of velocity and position, and the matrix from accelerations
        at the nodes to the Legendre coefficients of their double integral, stacked: shape
        (3 + s + 2, s).
    light
        Arrays ``project, values`` as in `project_light`.
    forces
        `compass.core.forces.Forces`.
    arcs
        Output, `Arcs`.

    Returns
    -------
    steps, time, wish
        Steps taken; where the last one ended; length for the next. No step at all means that none
        was short enough, or a path below Mars's centre of attraction.
    """
    project, values = light
    constants, series, terms, moons, gms = forces
    breaks, paths, errors = arcs
    n, s, room = states.shape[0], rule.shape[1], errors.shape[0]
    nodes, end_v, end_x, integrate = rule[0], rule[1], rule[2], rule[3:]
    degree = s + 2
    # position coefficients to positions at the nodes
    at_nodes = np.empty((s, degree))
    for i in range(s):
        p, q = 1.0, 0.0
        for k in range(degree):
            at_nodes[i, k] = p
            p, q = ((2 * k + 1) * nodes[i] * p - k * q) / (k + 1), p
    to_nodes = at_nodes @ integrate
    sky = np.empty((s, 4 + 3 * gms.size))
    edge = np.empty(4 + 3 * gms.size)
    sun = np.empty((2, 3))
    places, pushes, total = np.empty((s, 3)), np.empty((s, 3)), np.empty((s, 3))
    shares, path = np.ones(s), np.empty((3, degree))
    ends = np.empty((n, 6))
    gm = constants[GM]
    way = 1.0 if stop >= start else -1.0
    breaks[0] = start
    time, wish, step = start, first, 0
    while step < room and (stop - time) * way > 0.0:
        left = (stop - time) * way
        h = min(wish, longest)
        h = left if h >= left else (0.5 * left if 2.0 * h > left else h)
        half = 0.5 * h * way
        for i in range(s):
            sky_at(time + half * (1.0 + nodes[i]), constants, series, moons, sky[i])
        for e in range(2):
            sky_at(time + 2.0 * half * e, constants, series, moons, edge)
            sun[e] = edge[1:4]
        worst, failed = 0.0, False
        for b in range(n):
            x0, y0, z0, u0, v0, w0 = states[b]
            distance = math.sqrt(x0 * x0 + y0 * y0 + z0 * z0)
            cx, cy, cz = y0 * w0 - z0 * v0, z0 * u0 - x0 * w0, x0 * v0 - y0 * u0
            turn = math.sqrt(cx * cx + cy * cy + cz * cz) / (distance * distance)
            turn = max(turn, 1e-12)
            for i in range(s):
                angle = turn * half * (1.0 + nodes[i])
                c, d = math.cos(angle), math.sin(angle) / turn
                places[i, 0], places[i, 1], places[i, 2] = (
                    c * x0 + d * u0,
                    c * y0 + d * v0,
                    c * z0 + d * w0,
                )
                pushes[i, :] = 0.0
            dark = False
            settled = False
            for dear in range(PASSES):
                moved, swept = 0.0, False
                for sweep in range(SWEEPS):
                    for i in range(s):
                        x, y, z = places[i]
                        r2 = x * x + y * y + z * z
                        pull = -gm / (r2 * math.sqrt(r2))
                        total[i, 0] = pull * x + pushes[i, 0]
                        total[i, 1] = pull * y + pushes[i, 1]
                        total[i, 2] = pull * z + pushes[i, 2]
                    change = 0.0
                    for i in range(s):
                        dx, dy, dz = 0.0, 0.0, 0.0
                        for j in range(s):
                            weight = to_nodes[i, j]
                            dx += weight * total[j, 0]
                            dy += weight * total[j, 1]
                            dz += weight * total[j, 2]
                        t = half * (1.0 + nodes[i])
                        dx = x0 + (t * u0 + half * half * dx)
                        dy = y0 + (t * v0 + half * half * dy)
                        dz = z0 + (t * w0 + half * half * dz)
                        change = max(
                            change,
                            abs(dx - places[i, 0])
                            + abs(dy - places[i, 1])
                            + abs(dz - places[i, 2]),
                        )
                        places[i, 0], places[i, 1], places[i, 2] = dx, dy, dz
                    if sweep == 0:
                        moved = change
                    if not math.isfinite(change):
                        break
                    if change < SWEEP_END * distance:
                        swept = True
                        break
                if not swept:
                    break
                if dear > 0 and moved < PASS_END * distance:
                    settled = True
                    break
                if constants[SHADOW] > 0.0 and constants[SUNLIGHT] > 0.0:
                    _series(path, x0, y0, z0, u0, v0, w0, half, integrate, total)
                    dark = project_light(path, sun, constants, project, values, shares)
                for i in range(s):
                    pushes[i, 0], pushes[i, 1], pushes[i, 2] = perturbation(
                        places[i, 0],
                        places[i, 1],
                        places[i, 2],
                        shares[i],
                        constants,
                        terms,
                        gms,
                        sky[i],
                    )
            if not settled:
                failed = True
                break
            _series(path, x0, y0, z0, u0, v0, w0, half, integrate, total)
            paths[step, b] = path
            size = 0.0
            for k in range(3):
                size += abs(path[k, degree - 1]) + abs(path[k, degree - 2])
            allowed = 0.0
            if dark:
                # the tail of a step in the acceleration falls no faster than this
                light = constants[SUNLIGHT] / (sun[0, 0] ** 2 + sun[0, 1] ** 2 + sun[0, 2] ** 2)
                allowed = 4.0 * light * (half / s) ** 2
            errors[step, b] = size + allowed
            worst = max(worst, size - allowed)
            ends[b, :3] = x0, y0, z0
            ends[b, 3:] = u0, v0, w0
            for k in range(3):
                rise, lift = 0.0, 0.0
                for i in range(s):
                    rise += end_v[i] * total[i, k]
                    lift += end_x[i] * total[i, k]
                ends[b, k] += 2.0 * half * states[b, 3 + k] + half * half * lift
                ends[b, 3 + k] += half * rise
        if failed or worst > tolerance:
            wish = h * (0.5 if failed else max(0.3, 0.9 * (tolerance / worst) ** (1.0 / s)))
            if wish < 1e-3:
                return 0, time, wish
            continue
        states[:, :] = ends
        growth = 1.5 if worst == 0.0 else min(1.5, 0.9 * (tolerance / worst) ** (1.0 / s))
        wish = max(h * growth, h if h == left else 0.0)
        time = stop if h == left else time + 2.0 * half
        step += 1
        breaks[step] = time
    return step, time, wish


@fast_kernel
def _series(path, x0, y0, z0, u0, v0, w0, half, integrate, total):
    """Fill `path` with the Legendre coefficients of the position on a step."""
    for j in range(path.shape[1]):
        dx, dy, dz = 0.0, 0.0, 0.0
        for i in range(total.shape[0]):
            dx += integrate[j, i] * total[i, 0]
            dy += integrate[j, i] * total[i, 1]
            dz += integrate[j, i] * total[i, 2]
        path[0, j] = half * half * dx
        path[1, j] = half * half * dy
        path[2, j] = half * half * dz
    path[0, 0] += x0 + half * u0
    path[1, 0] += y0 + half * v0
    path[2, 0] += z0 + half * w0
    path[0, 1] += half * u0
    path[1, 1] += half * v0
    path[2, 1] += half * w0

"""How far satellites stand from the slots of their pattern, at its best turn and phase.

Slot i at phase phi is ``w_i = cos(u_i + phi) N_i + sin(u_i + phi) M_i`` in a plane of pole H_i,
all turned by a common rotation Q. A satellite in direction s_i misses it by an angle with parts
along the track (``H_i x w_i``) and across it (H_i). Sought are Q and phi that make the least of
``spare_i - miss_i`` greatest. Turning by a small vector theta and advancing by dphi moves the
slot by ``theta x w_i + dphi H_i x w_i``: two numbers a satellite and up to four unknowns x, with
``(theta, dphi) = x' ways``: all four where only the whole sphere counts, a turn about the pole
and the phase for a belt of latitude, the time alone for places that turn with Mars.

Least squares whose weights are multiplied by what is lacking (Lawson 1961, Contributions to the
theory of linear least maximum approximation) come near the optimum; whatever comes of it is a
valid turn and phase, and is judged exactly.
"""

import math

import numpy as np

from compass.core.jit import kernel

#: Linearisations, and changes of the weights in each.
ROUNDS, WEIGHINGS = 4, 60


@kernel
def miss_of(nodes, inclination, arguments, turn, phase, s, direction, out):
    """Fill `out` with the parts of a satellite's miss along and across, and its slot's frame.

    Returns the angle of the miss, radians. `out`: along, across, slot (3), track (3), pole (3).
    """
    u, node = arguments[s] + phase, nodes[s]
    cu, su, cn, sn = math.cos(u), math.sin(u), math.cos(node), math.sin(node)
    ci, si = math.cos(inclination), math.sin(inclination)
    frame = np.empty((3, 3))
    frame[0] = cn * cu - sn * su * ci, sn * cu + cn * su * ci, su * si
    frame[1] = -cn * su - sn * cu * ci, -sn * su + cn * cu * ci, cu * si
    frame[2] = sn * si, -cn * si, ci
    parts = np.zeros(3)
    for k in range(3):
        for c in range(3):
            value = 0.0
            for j in range(3):
                value += turn[c, j] * frame[k, j]
            out[2 + 3 * k + c] = value
            parts[k] += value * direction[c]
    sideways = math.sqrt(parts[1] ** 2 + parts[2] ** 2)
    angle = math.atan2(sideways, parts[0])
    stretch = angle / sideways if sideways > 1e-300 else 1.0
    out[0], out[1] = parts[1] * stretch, parts[2] * stretch
    return angle


@kernel
def _turned(turn, theta):
    """Rotation by the vector `theta` after the rotation `turn`."""
    angle = math.sqrt(theta[0] ** 2 + theta[1] ** 2 + theta[2] ** 2)
    if angle < 1e-15:
        return turn.copy()
    x, y, z = theta[0] / angle, theta[1] / angle, theta[2] / angle
    c, s = math.cos(angle), math.sin(angle)
    d = 1.0 - c
    step = np.array(
        [
            [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
            [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
            [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
        ]
    )
    return step @ turn


@kernel
def best_slots(nodes, inclination, arguments, directions, spare, turn0, phase0, ways, misses):
    """Room in the slots at one moment: the greatest least of spare less miss, radians.

    Parameters
    ----------
    nodes, inclination, arguments
        The pattern: node and argument of latitude of each slot, shape (n,), radians.
    directions
        Unit vectors to the satellites, shape (n, 3).
    spare
        How much each cap has to spare, radians, shape (n,).
    turn0, phase0
        Where to begin: a rotation about the pole, and a phase, radians.
    ways
        Small turns and phase (theta, dphi) that are allowed, shape (m, 4).
    misses
        Takes along and across of each satellite, radians, shape (n, 2).

    Returns
    -------
    room, turn, phase
        Turn is the rotation matrix found.
    """
    n, m = arguments.size, ways.shape[0]
    turn, phase = _turned(np.eye(3), np.array([0.0, 0.0, turn0])), phase0
    best, best_turn, best_phase = -math.inf, turn, phase
    out = np.empty(11)
    rows, right = np.empty((n, 2, m)), np.empty((n, 2))
    ceiling = spare.max()
    for _ in range(ROUNDS):
        for s in range(n):
            miss_of(nodes, inclination, arguments, turn, phase, s, directions[s], out)
            right[s, 0], right[s, 1] = out[0], out[1]
            wx, wy, wz = out[2], out[3], out[4]
            for k in range(2):
                tx, ty, tz = out[5 + 3 * k], out[6 + 3 * k], out[7 + 3 * k]
                # (theta x w) . t = theta . (w x t)
                x, y, z = wy * tz - wz * ty, wz * tx - wx * tz, wx * ty - wy * tx
                ahead = 1.0 if k == 0 else 0.0
                for i in range(m):
                    rows[s, k, i] = (
                        ways[i, 0] * x + ways[i, 1] * y + ways[i, 2] * z + ways[i, 3] * ahead
                    )
        weight = np.full(n, 1.0 / n)
        for weighing in range(WEIGHINGS):
            normal, target = np.eye(m) * 1e-12, np.zeros(m)
            for s in range(n):
                for k in range(2):
                    for i in range(m):
                        target[i] += weight[s] * rows[s, k, i] * right[s, k]
                        for j in range(m):
                            normal[i, j] += weight[s] * rows[s, k, i] * rows[s, k, j]
            step = np.linalg.solve(normal, target)
            whole = np.zeros(4)
            for i in range(m):
                for j in range(4):
                    whole[j] += step[i] * ways[i, j]
            total = 0.0
            for s in range(n):
                left = 0.0
                for k in range(2):
                    rest = right[s, k]
                    for i in range(m):
                        rest -= rows[s, k, i] * step[i]
                    left += rest * rest
                left = math.sqrt(left)
                weight[s] *= left + ceiling - spare[s] + 1e-12
                total += weight[s]
            for s in range(n):
                weight[s] /= total
            # every few weighings, and at the end, the truth
            if weighing % 6 == 5:
                tried = _turned(turn, whole[:3])
                advanced = phase + whole[3]
                room = math.inf
                for s in range(n):
                    angle = miss_of(
                        nodes, inclination, arguments, tried, advanced, s, directions[s], out
                    )
                    room = min(room, spare[s] - angle)
                if room > best:
                    best, best_turn, best_phase = room, tried, advanced
        turn, phase = best_turn, best_phase
    for s in range(n):
        miss_of(nodes, inclination, arguments, turn, phase, s, directions[s], out)
        misses[s, 0], misses[s, 1] = out[0], out[1]
    return best, turn, phase


@kernel
def rooms(nodes, inclination, arguments, directions, spare, turns, phases, ways, misses):
    """`best_slots` at many moments: shapes (t, n, 3), (t, n), (t,), (t,), (m, 4), (t, n, 2).

    Phases are replaced by those found.
    """
    widths = np.empty(turns.size)
    for k in range(turns.size):
        widths[k], _, phases[k] = best_slots(
            nodes,
            inclination,
            arguments,
            directions[k],
            spare[k],
            turns[k],
            phases[k],
            ways,
            misses[k],
        )
    return widths

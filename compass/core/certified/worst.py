"""Branch and bound: where and when a dilution of precision is largest.

In a box the square is at most ``most`` of its expansion by the satellites surely in sight (`cuts`),
and infinite is possible with fewer than four of them. At a place and moment it is at least
``least`` of the expansion by all that may be in sight, of a box without width; a better place is
looked for from every one that is worse than all before (`climb`). A box whose bound does not exceed
what some place has cannot hold the largest and is dropped.

Near a place where the lines of sight lie on a cone the square grows without bound; rounding keeps
`least` of it below some 1e12.
"""

import math

import numpy as np

from compass.core.certified.cuts import (
    CENTRE,
    SCRATCH,
    TILT,
    expansion,
    gather,
    least,
    most,
)
from compass.core.certified.groups import make_room
from compass.core.certified.shares import region_parts, split
from compass.core.certified.sights import E2, HEIGHT, HIGH, place, states
from compass.core.jit import kernel

#: Columns of a leaf: centre and half-widths (b, l, t), bound of the square, value at the centre.
LEAF = 8

#: First half-width of the boxes by which a worse place is looked for, the least, and most moves.
STRIDE, LEAST_STRIDE, STRIDES = 1e-3, 1e-8, 60


@kernel
def expand(box, sure, room, problem):
    """Expand over a box whose satellites' states are filled in; -1 outside the region, else used.

    The expansion stands at the end of the room's scratch.
    """
    user, scratch, rows, kinds = room.user, room.scratch, room.rows, room.kinds
    normals, numbers = problem.normals, problem.numbers
    place(box, numbers[E2], numbers[HEIGHT], user)
    if normals.shape[0] and region_parts(user, normals)[1] >= 1.0:
        return -1
    kinds[:] = 0
    count = gather(box, room, problem)
    return expansion(rows, kinds, max(count, 0), sure, sure, scratch, scratch[SCRATCH:])


@kernel
def value_at(point, room, problem):
    """Square of a dilution at a place and moment, never too large; -1 outside the region."""
    orbits, circles, breaks, paths, normals, _, _ = problem
    user, at = room.user, np.zeros(6)
    at[:3] = point
    states(orbits, circles, breaks, paths, at[2], room.q, room.dq)
    used = expand(at, False, room, problem)
    if used < 0:
        return -1.0
    for k in range(normals.shape[0]):
        x = normals[k, 0] * user[3] + normals[k, 1] * user[4] + normals[k, 2] * user[5]
        if x < 1e-12:
            return -1.0
    return least(room.scratch[SCRATCH:]) if used >= 4 else math.inf


@kernel
def far_corner(box, rows, kinds, sides, corner):
    """Fill the corner of a box where its doubtful satellites stand lowest; or a point on the edge.

    Without doubtful satellites it is the point of the edge of the domain, where the box has one,
    that is nearest to the centre. False where there is neither.
    """
    s0 = s1 = s2 = 0.0
    any_doubtful = False
    for k in range(kinds.size):
        if kinds[k] == 2:
            any_doubtful = True
            s0 += rows[k, HIGH + 1]
            s1 += rows[k, HIGH + 2]
            s2 += rows[k, HIGH + 3]
    for d in range(3):
        slope = s0 if d == 0 else (s1 if d == 1 else s2)
        corner[d] = box[d] - (box[3 + d] if slope > 0.0 else -box[3 + d])
    if any_doubtful:
        return True
    on_edge = False
    for d in range(3):
        corner[d] = box[d]
        for side in range(2):
            if 0.0 < abs(box[d] - sides[d, side]) <= 1.001 * box[3 + d]:
                corner[d] = sides[d, side]
                on_edge = True
    return on_edge


@kernel
def climb(best, sides, speed, room, problem):
    """Move from `best` (square, b, l, t) to a worse place and moment, as far as it goes.

    ``1/DOP`` is nearly linear where it vanishes, so that Newton's step for it is taken,
    ``-2 g l/|l|^2``, and cut down until the dilution grows.
    """
    orbits, circles, breaks, paths, _, _, _ = problem
    stride = STRIDE
    box, trial = np.zeros(6), np.empty(3)
    for _ in range(STRIDES):
        if stride < LEAST_STRIDE or best[0] == math.inf:
            return
        box[:3] = best[1:]
        for d in range(3):
            box[3 + d] = stride if sides[d, 1] > sides[d, 0] else 0.0
        box[5] /= speed
        states(orbits, circles, breaks, paths, box[2], room.q, room.dq)
        used = expand(box, True, room, problem)
        if used < 4:
            expand(box, False, room, problem)
        out = room.scratch[SCRATCH:]
        l0, l1, l2 = out[TILT], out[TILT + 1], out[TILT + 2]
        length = l0 * l0 + l1 * l1 + l2 * l2
        if not length > 0.0:
            return
        step = -min(2.0 * out[CENTRE] / length, 30.0 / math.sqrt(length))
        grown = False
        for _ in range(6):
            for d in range(3):
                x = best[1 + d] + step * (l0 if d == 0 else (l1 if d == 1 else l2)) * box[3 + d]
                trial[d] = min(max(x, sides[d, 0]), sides[d, 1])
            value = value_at(trial, room, problem)
            if value > best[0]:
                grown = value > best[0] * 1.01
                best[0] = value
                best[1:] = trial
                break
            step *= 0.25
        if not grown:
            stride *= 0.1


@kernel
def pursue(leaves, best, ratio, enough, beyond, budget, speed, sides, problem):
    """Split leaves until the bound of each is near the largest value found, or small enough.

    Parameters
    ----------
    leaves
        Boxes to look into, shape (m, LEAF).
    best
        Largest square found so far and where, shape (4,).
    ratio
        How far above `best` the bound of a leaf may lie; 1 or more.
    enough
        Boxes with a bound up to this are dropped.
    beyond
        Value at which there is nothing more to look for.
    budget
        Boxes to look at at most.
    speed
        As of `compass.core.certified.shares.refine`.
    sides
        Of the domain, shape (3, 2).
    problem
        As of `compass.core.certified.shares.look`.

    Returns
    -------
    best
        As above, now.
    looked
        Boxes looked at.
    stuck
        Whether a box was too small to be split and had no bound near enough.
    open
        What is left, shape (k, LEAF).
    """
    orbits, circles, breaks, paths, _, _, _ = problem
    room = make_room(orbits.shape[0])
    best, corner = best.copy(), np.empty(3)
    out, stack = np.empty((64, LEAF)), np.empty((256, LEAF))
    left = looked = 0
    stuck = False
    for i in range(leaves.shape[0]):
        stack[0] = leaves[i]
        share = budget * (i + 1) // leaves.shape[0]  # no leaf takes the time of those after it
        depth, lost = 1, False  # a leaf with a box too small to be split is left as it is
        while depth > 0:
            depth -= 1
            box = stack[depth].copy()
            if box[6] <= max(best[0], enough):
                continue
            wide = box[6] > best[0] * ratio and best[0] < beyond and not lost
            if wide and looked < share:
                lost = depth >= 250 or not split(box, speed, stack[depth], stack[depth + 1])
                stuck, wide = stuck or lost, not lost
            if wide and looked < share:
                first = depth
                for side in range(2):
                    half = stack[first + side].copy()
                    half[6] = box[6]
                    looked += 1
                    states(orbits, circles, breaks, paths, half[2], room.q, room.dq)
                    used = expand(half, True, room, problem)
                    if used < 0:
                        continue
                    if used >= 4:
                        half[6] = min(half[6], most(room.scratch[SCRATCH:]))
                    if half[6] <= max(best[0], enough):
                        continue
                    rims = far_corner(half, room.rows, room.kinds, sides, corner)
                    for at in range(2 if rims else 1):
                        point = corner if at else half[:3]
                        value = value_at(point, room, problem)
                        half[7] = max(half[7], value) if at else value
                        if value > best[0]:
                            much = value > 1.02 * best[0]
                            best[0] = value
                            best[1:] = point
                            if much:
                                climb(best, sides, speed, room, problem)
                    stack[depth] = half
                    depth += 1
                # the half with the larger value is looked into first
                if depth == first + 2 and stack[first, 7] > stack[first + 1, 7]:
                    half = stack[first].copy()
                    stack[first] = stack[first + 1]
                    stack[first + 1] = half
                continue
            if left == out.shape[0]:
                more = np.empty((2 * left, LEAF))
                more[:left] = out
                out = more
            out[left] = box
            left += 1
    return best, looked, stuck, out[:left].copy()

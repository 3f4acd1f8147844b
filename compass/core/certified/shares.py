"""Branch and bound: how much of a domain surely keeps a limit and how much surely breaks it.

Each box is cut by half-spaces in which the limit is surely kept or broken (`cuts`). Where rims of
satellites' caps or edges of a region pass through, with G_S, B_S from the satellites surely in
sight and G_P, B_P from all that may be, and `on`, `off` bounds of the share of the box where all
or none of the doubtful are in sight (``1 - sum`` of what each leaves open)::

    kept >= max(G_S, on - (1 - G_P)),  broken >= max(B_P, off - (1 - B_S))

and, where two are doubtful, by either of them seen and the other not, as where only one matters::

    kept >= on_1 - (1 - G_S1),  broken >= off_2 - (1 - B_S1)

A fold is kept where so many are in view. With z surely seen and d doubtful, where the m = k - z
that are still wanted are all seen, those of the largest shares: ``kept >= 1 - sum of what each of
them leaves open``; broken where d - m + 1 are all hidden, likewise.

And likewise inside a region, ``max(0, kept + inside - 1)``. A share f of the volume holds at least
``max(f vol w_min, m - (1 - f) vol w_max)`` of the measure m, w the density of area in latitude.
What is neither kept nor broken nor outside is open, and split along its longest side.
What bounds the dilution over a box serves any number of limits at once.

A bound that does not hold leaves its box open. Box edges are sums of halves; midpoints may be off
by a rounding, 1e-16, against half-widths above 1e-7. The sums err by less than ``4e-16`` a box,
which callers add.
"""

import math

import numpy as np

from compass.core.belt import area_below
from compass.core.certified.cuts import (
    BROKEN,
    CUT,
    KEPT,
    SCRATCH,
    expansion,
    gather,
    half_spaces,
)
from compass.core.certified.groups import make_room
from compass.core.certified.sights import (
    DOP,
    E2,
    FALL,
    HEIGHT,
    HIGH,
    LOW,
    RISE,
    place,
    states,
)
from compass.core.certified.volumes import volume
from compass.core.jit import fused_kernel

#: Columns of a box: centre and half-widths (b, l, t), its measure but for what is surely outside
#: the region, and that; then what is kept at each limit, and what is broken. BOX: with one limit.
INSIDE, OUTSIDE, GIVEN, BOX = 6, 7, 8, 10

#: What stands for a dilution where the number of satellites in view is asked for.
FOLD = 5

#: Half-widths below which a box is not split.
FINEST = 1e-7


@fused_kernel
def measure(box, e2):
    """Measure of a box, its volume, and the smallest and largest density in it.

    A box of no width in a direction counts as one of width 1.
    """
    b, hb, hl, ht = box[0], box[3], box[4], box[5]
    wide = (2.0 * hl if hl > 0.0 else 1.0) * (2.0 * ht if ht > 0.0 else 1.0)
    if hb == 0.0:
        return wide, wide, 1.0, 1.0
    low, high = b - hb, b + hb
    cl, ch = max(math.cos(low), 0.0), max(math.cos(high), 0.0)
    most = 1.0 if low <= 0.0 <= high else max(cl, ch)
    m = (area_below(high, e2) - area_below(low, e2)) * wide
    flat = (1.0 - e2 * math.sin(low) ** 2, 1.0 - e2 * math.sin(high) ** 2)
    top = 1.0 if low <= 0.0 <= high else max(flat[0], flat[1])
    dense = (1.0 - e2) / (min(flat[0], flat[1]) ** 2)
    thin = (1.0 - e2) / (top * top)
    return m, 2.0 * hb * wide, min(cl, ch) * thin * (1.0 - 1e-12), most * dense * (1.0 + 1e-12)


@fused_kernel
def of_measure(share, m, size, thin, dense):
    """Least measure of a share of the volume."""
    if share >= 1.0:
        return m
    return max(0.0, share * size * thin, m - (1.0 - share) * size * dense)


@fused_kernel
def region_parts(user, normals):
    """Bounds of the shares of a box inside and outside half-spaces ``normals . place >= 0``."""
    inside, outside = 1.0, 0.0
    bend = 0.5 * user[20] + 1e-14
    for k in range(normals.shape[0]):
        x, y, z = normals[k, 0], normals[k, 1], normals[k, 2]
        at = x * user[3] + y * user[4] + z * user[5]
        by_b = x * user[12] + y * user[13] + z * user[14]
        by_l = x * user[15] + y * user[16] + z * user[17]
        inside -= 1.0 - volume(bend - at, by_b, by_l, 0.0)
        outside = max(outside, volume(bend + at, by_b, by_l, 0.0))
    return max(inside, 0.0), outside


@fused_kernel
def rim_shares(row):
    """Bounds of the shares of a box in which a doubtful satellite is surely seen, surely not."""
    return (
        volume(row[FALL] - row[HIGH], row[HIGH + 1], row[HIGH + 2], row[HIGH + 3]),
        volume(row[RISE] + row[LOW], row[LOW + 1], row[LOW + 2], row[LOW + 3]),
    )


@fused_kernel
def settle(rows, kinds, count, sure, on, off, squares, s, cut, parts):
    """Raise bounds of the shares of a box where limits are kept and broken; return the most open.

    Parameters
    ----------
    rows, kinds, count, sure, s
        As of `compass.core.certified.cuts.expansion`.
    on, off
        Shares of the box in which no fewer satellites than these are seen, and no more.
    squares
        Limits squared, shape (m,).
    cut
        Scratch.
    parts
        Shares kept, then broken, shape (2 m,).
    """
    out, m, still = cut[CUT:], squares.size, 0.0
    used = expansion(rows, kinds, count, sure, on > 0.0, s, out)
    for k in range(m):
        half_spaces(out, used, squares[k], cut)
        kept = on - 1.0 + volume(cut[KEPT], cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3])
        broken = off - 1.0 + volume(cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3])
        parts[k] = max(parts[k], kept)
        parts[m + k] = max(parts[m + k], broken)
        still = max(still, 1.0 - parts[k] - parts[m + k])
    return still


@fused_kernel
def kept_broken(rows, kinds, count, squares, s, cut, parts):
    """Fill bounds of the shares of a box's volume where limits are kept and broken."""
    m = squares.size
    parts[:m] = 0.0
    parts[m:] = 1.0 if 0 <= count < 4 else 0.0
    if count < 4:
        return
    on = off = 1.0
    doubtful, first, second = 0, -1, -1
    for k in range(count):
        if kinds[k] == 2:
            seen, unseen = rim_shares(rows[k])
            on, off = on - (1.0 - seen), off - (1.0 - unseen)
            doubtful, first, second = doubtful + 1, second, k
    # the surely seen first: where they keep the limit, as nearly everywhere, that is all
    still = settle(rows, kinds, count, True, 1.0, off, squares, s, cut, parts)
    if doubtful == 0 or still == 0.0:
        return
    still = settle(rows, kinds, count, False, on, 1.0, squares, s, cut, parts)
    if doubtful != 2 or still == 0.0:
        return
    for _ in range(2):
        first, second = second, first
        on, off = rim_shares(rows[first])[0], rim_shares(rows[second])[1]
        kinds[first] = 1
        settle(rows, kinds, count, True, on, off, squares, s, cut, parts)
        kinds[first] = 2


@fused_kernel
def all_of(rows, column, count, wanted):
    """Share of a box that all of the first `wanted` of `count` shares have in common at least."""
    if wanted > count:
        return 0.0
    share = 1.0
    for k in range(wanted):
        share -= 1.0 - rows[k, column]
    return max(share, 0.0)


@fused_kernel
def in_view(rows, kinds, count, folds, parts):
    """Fill bounds of the shares of a box's volume where folds are kept and broken.

    The shares in which doubtful satellites are seen, and hidden, take the place of their lines of
    sight, the largest first.
    """
    parts[:] = 0.0
    sure = doubtful = 0
    for k in range(count):
        if kinds[k] == 1:
            sure += 1
            continue
        shares = rim_shares(rows[k])
        for side in range(2):
            place = doubtful
            while place > 0 and rows[place - 1, side] < shares[side]:
                rows[place, side] = rows[place - 1, side]
                place -= 1
            rows[place, side] = shares[side]
        doubtful += 1
    if count < 0:
        return
    for k in range(folds.size):
        wanted = int(folds[k]) - sure
        parts[k] = all_of(rows, 0, doubtful, wanted)
        parts[folds.size + k] = all_of(rows, 1, doubtful, doubtful - wanted + 1)


@fused_kernel
def look(box, squares, room, problem):
    """Settle what a box's bounds settle: fills its columns from 6 on.

    `squares` are the limits squared, or folds; `room` and `problem` those of
    `compass.core.certified.groups`.
    """
    user, scratch, q, dq, rows, kinds = room
    orbits, circles, breaks, paths, normals, numbers, _ = problem
    place(box, numbers[E2], numbers[HEIGHT], user)
    m, size, thin, dense = measure(box, numbers[E2])
    inside, outside = 1.0, 0.0
    if normals.shape[0]:
        inside, outside = region_parts(user, normals)
    parts = box[GIVEN:]
    if inside > 0.0:
        states(orbits, circles, breaks, paths, box[2], q, dq)
        count = gather(box, room, problem)
        if numbers[DOP] == FOLD:
            in_view(rows, kinds, count, squares, parts)
        else:
            kept_broken(rows, kinds, count, squares, scratch, scratch[SCRATCH:], parts)
    else:
        parts[:] = 0.0
    box[OUTSIDE] = of_measure(outside, m, size, thin, dense)
    box[INSIDE] = m - box[OUTSIDE]
    for k in range(parts.size):
        parts[k] = of_measure(parts[k] + inside - 1.0, m, size, thin, dense)


@fused_kernel
def still_open(box, k):
    """Measure of a box of which a limit is neither kept nor broken."""
    limits = (box.size - GIVEN) // 2
    return max(0.0, box[INSIDE] - box[GIVEN + k] - box[GIVEN + limits + k])


@fused_kernel
def most_open(box, eps):
    """By how much more is open at one of the limits than may be (`eps`, shape (m,))."""
    most = -math.inf
    for k in range(eps.size):
        most = max(most, still_open(box, k) - eps[k])
    return most


@fused_kernel
def split(box, speed, left, right):
    """Halve a box along its longest side; False where all are too short."""
    low, high = box[0] - box[3], box[0] + box[3]
    ring = 1.0 if low <= 0.0 <= high else max(math.cos(low), math.cos(high))
    sides = (box[3], ring * box[4], speed * box[5])
    longest = 0
    for d in range(1, 3):
        if sides[d] > sides[longest]:
            longest = d
    if sides[longest] < FINEST:
        return False
    left[:6] = box[:6]
    right[:6] = box[:6]
    half = 0.5 * box[3 + longest]
    left[longest] -= half
    right[longest] += half
    left[3 + longest] = right[3 + longest] = half
    return True


@fused_kernel
def refine(leaves, fresh, whole, eps, speed, squares, problem):
    """Split boxes until none has more than `eps` open.

    Parameters
    ----------
    leaves
        Boxes to split, shape (k, GIVEN + 2 m).
    fresh
        Whether nothing is known of them yet at these limits.
    whole
        Whether boxes with nothing open are returned too, to be looked at for other limits.
    eps
        Open measure that a box may keep, by limits, shape (m,).
    speed
        How much of a length a unit of time is worth when the longest side is chosen.
    squares, problem
        See `look`.

    Returns
    -------
    settled
        Sums of the columns from `INSIDE` on of boxes that are done with, and boxes looked at.
    open
        Boxes with something open; or all.
    """
    room, columns = make_room(problem.orbits.shape[0]), leaves.shape[1]
    settled, out = np.zeros(columns - INSIDE + 1), np.empty((64, columns))
    stack, box, nothing = np.empty((256, columns)), np.empty(columns), np.zeros(eps.size)
    left = 0
    for i in range(leaves.shape[0]):
        stack[0] = leaves[i]
        first, depth = (0 if fresh else 1), 1
        while depth > 0:
            for k in range(first, depth):
                look(stack[k], squares, room, problem)
            settled[-1] += depth - first
            depth -= 1
            first = depth
            box[:] = stack[depth]
            if most_open(box, eps) > 0.0 and depth < 250 and split(
                box, speed, stack[depth], stack[depth + 1]
            ):  # fmt: skip
                depth += 2
                continue
            if whole or most_open(box, nothing) > 0.0:
                if left == out.shape[0]:
                    more = np.empty((2 * left, columns))
                    more[:left] = out
                    out = more
                out[left] = box
                left += 1
            else:
                settled[:-1] += box[INSIDE:]
    return settled, out[:left].copy()

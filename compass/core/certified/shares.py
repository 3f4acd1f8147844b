"""Branch and bound: how much of a domain surely keeps a limit and how much surely breaks it.

Each box is cut by half-spaces in which the limit is surely kept or broken (`cuts`). Where rims of
satellites' caps or edges of a region pass through, with G_S, B_S from the satellites surely in
sight and G_P, B_P from all that may be, and `on`, `off` bounds of the share of the box where all
or none of the doubtful are in sight (``1 - sum`` of what each leaves open)::

    kept >= max(G_S, on - (1 - G_P)),  broken >= max(B_P, off - (1 - B_S))

and, where two are doubtful, by either of them seen and the other not, as where only one matters::

    kept >= on_1 - (1 - G_S1),  broken >= off_2 - (1 - B_S1)

and likewise inside a region, ``max(0, kept + inside - 1)``. A share f of the volume holds at least
``max(f vol w_min, m - (1 - f) vol w_max)`` of the measure m, w the density of area in latitude.
What is neither kept nor broken nor outside is open, and split along its longest side.

A bound that does not hold leaves its box open. Box edges are sums of halves; midpoints may be off
by a rounding, 1e-16, against half-widths above 1e-7. The sums err by less than ``4e-16`` a box,
which callers add.
"""

import math

import numpy as np

from compass.core.belt import area_below
from compass.core.certified.cuts import BROKEN, CUT, EXPANSION, KEPT, SCRATCH, cuts, gather
from compass.core.certified.sights import (
    E2,
    FALL,
    HEIGHT,
    HIGH,
    LOW,
    RISE,
    SQUARE,
    USER,
    WIDTH,
    place,
    states,
)
from compass.core.certified.volumes import volume
from compass.core.jit import fused_kernel

#: Columns of a box: centre and half-widths (b, l, t), what is kept, broken, outside and open.
BOX = 10

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
def rim_parts(rows, kinds, count):
    """Bounds of the shares of a box in which all and none of the doubtful satellites are seen."""
    on, off = 1.0, 1.0
    for k in range(count):
        if kinds[k] == 2:
            seen, unseen = rim_shares(rows[k])
            on -= 1.0 - seen
            off -= 1.0 - unseen
    return max(on, 0.0), max(off, 0.0)


@fused_kernel
def rim_shares(row):
    """Bounds of the shares of a box in which a doubtful satellite is surely seen, surely not."""
    return (
        volume(row[FALL] - row[HIGH], row[HIGH + 1], row[HIGH + 2], row[HIGH + 3]),
        volume(row[RISE] + row[LOW], row[LOW + 1], row[LOW + 2], row[LOW + 3]),
    )


@fused_kernel
def kept_broken(rows, kinds, count, square, s, cut):
    """Bounds of the shares of a box's volume where a limit is kept and broken."""
    if count < 0:
        return 0.0, 0.0
    if count < 4:
        return 0.0, 1.0
    doubtful = 0
    for k in range(count):
        doubtful += kinds[k] - 1
    # the surely seen first: where they keep the limit, as nearly everywhere, that is all
    cuts(rows, kinds, count, True, True, square, s, cut)
    kept = volume(cut[KEPT], cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3])
    broken = volume(cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3])
    if doubtful == 0 or kept == 1.0:
        return kept, broken
    on, off = rim_parts(rows, kinds, count)
    cuts(rows, kinds, count, False, on > kept, square, s, cut)
    most = volume(cut[KEPT], cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3])
    least = volume(cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3])
    kept, broken = max(kept, on + most - 1.0), max(least, off + broken - 1.0)
    if doubtful == 2 and most > 0.0 and least < 1.0 and kept + broken < 1.0:
        return one_of_two(rows, kinds, count, square, s, cut, kept, broken)
    return kept, broken


@fused_kernel
def one_of_two(rows, kinds, count, square, s, cut, kept, broken):
    """Raise bounds of what is kept and broken by looking at either of two doubtful satellites."""
    first = second = -1
    for k in range(count):
        if kinds[k] == 2:
            first, second = second, k
    for _ in range(2):
        first, second = second, first
        on, off = rim_shares(rows[first])[0], rim_shares(rows[second])[1]
        if on <= kept and off <= broken:
            continue
        kinds[first] = 1
        cuts(rows, kinds, count, True, on > kept, square, s, cut)
        kinds[first] = 2
        kept = max(kept, on - 1.0 + volume(cut[KEPT], cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3]))
        out = volume(cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3])
        broken = max(broken, off - 1.0 + out)
    return kept, broken


@fused_kernel
def look(
    box, user, scratch, q, dq, rows, kinds, orbits, circles, breaks, paths, normals, numbers, mask
):
    """Settle what a box's bounds settle: fills its columns from 6 on.

    `numbers` as in `sights`, `mask` two rows: azimuths and elevations.
    """
    place(box, numbers[E2], numbers[HEIGHT], user)
    m, size, thin, dense = measure(box, numbers[E2])
    inside, outside = 1.0, 0.0
    if normals.shape[0]:
        inside, outside = region_parts(user, normals)
    kept = broken = 0.0
    if inside > 0.0:
        states(orbits, circles, breaks, paths, box[2], q, dq)
        count = gather(box, user, scratch, q, dq, rows, kinds, orbits, numbers, mask)
        cut = scratch[SCRATCH:]
        kept, broken = kept_broken(rows, kinds, count, numbers[SQUARE], scratch, cut)
    box[6] = of_measure(kept + inside - 1.0, m, size, thin, dense)
    box[7] = of_measure(broken + inside - 1.0, m, size, thin, dense)
    box[8] = of_measure(outside, m, size, thin, dense)
    box[9] = max(0.0, m - box[6] - box[7] - box[8])


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
def refine(leaves, eps, speed, orbits, circles, breaks, paths, normals, numbers, mask):
    """Split boxes until none has more than `eps` open.

    Parameters
    ----------
    leaves
        Boxes to split, shape (m, BOX).
    eps
        Open measure that a box may keep.
    speed
        How much of a length a unit of time is worth when the longest side is chosen.
    orbits, circles, breaks, paths, normals, numbers, mask
        See `look`.

    Returns
    -------
    settled
        Measure kept, broken and outside in boxes that are done with, and boxes looked at.
    open
        Boxes with something open, shape (k, BOX).
    """
    n = orbits.shape[0]
    user, scratch = np.empty(USER), np.zeros(SCRATCH + CUT + EXPANSION)
    q, dq, rows = np.empty((n, 3)), np.empty((n, 3)), np.empty((n + 1, WIDTH))
    kinds = np.empty(n + 1, np.int64)
    settled, out, stack = np.zeros(4), np.empty((64, BOX)), np.empty((256, BOX))
    box = np.empty(BOX)
    found = 0
    for i in range(leaves.shape[0]):
        stack[0] = leaves[i]
        depth = 1
        while depth > 0:
            depth -= 1
            box[:] = stack[depth]
            if box[9] > eps and depth < 250 and split(box, speed, stack[depth], stack[depth + 1]):
                for k in range(depth, depth + 2):
                    look(stack[k], user, scratch, q, dq, rows, kinds, orbits, circles, breaks,
                         paths, normals, numbers, mask)  # fmt: skip
                settled[3] += 2
                depth += 2
                continue
            if box[9] > 0.0:
                if found == out.shape[0]:
                    more = np.empty((2 * found, BOX))
                    more[:found] = out
                    out = more
                out[found] = box
                found += 1
            else:
                settled[:3] += box[6:9]
    return settled, out[:found].copy()

"""How much of the time a limit is surely kept at all places of a box at once.

A cut ``b x + l y + t z >= threshold`` holds for all latitudes x in [-1, 1] of a box where
``l y + t z >= threshold + |b|``, for all longitudes too where ``t z >= threshold + |b| + |l|``: the
cuts of `compass.core.certified.cuts` and the rims of satellites' caps, taken so, leave a share of
longitude and time, or of time alone, that no place of the box has less of.
"""

import math

import numpy as np

from compass.core.certified.cuts import CUT, EXPANSION, KEPT, SCRATCH, cuts, gather
from compass.core.certified.sights import (
    E2,
    FALL,
    HEIGHT,
    HIGH,
    USER,
    WIDTH,
    place,
    states,
)
from compass.core.certified.volumes import volume
from compass.core.jit import kernel

#: Sides that may be split are, down to this part of those that may not.
PART = 0.5

#: Columns of a box: centre and half-widths of latitude, longitude and time.
BOX = 6


@kernel
def of_all(threshold, cut, places):
    """Share of longitude and time of a box, or of time if `places`, in which all keep a cut."""
    threshold += abs(cut[0])
    if places:
        return volume(threshold + abs(cut[1]), 0.0, 0.0, cut[2])
    return volume(threshold, 0.0, cut[1], cut[2])


@kernel
def kept(rows, kinds, count, square, s, cut, places):
    """Share of longitude and time, or of time, in which all places of a box keep a limit."""
    if count < 4:
        return 0.0
    on, doubtful = 1.0, 0
    for k in range(count):
        if kinds[k] == 2:
            doubtful += 1
            on -= 1.0 - of_all(rows[k, FALL] - rows[k, HIGH], rows[k, HIGH + 1 : HIGH + 4], places)
    cuts(rows, kinds, count, False, on > 0.0, square, s, cut)
    whole = of_all(cut[KEPT], cut[KEPT + 1 : KEPT + 4], places)
    if not doubtful:
        return whole
    cuts(rows, kinds, count, True, True, square, s, cut)
    surely = of_all(cut[KEPT], cut[KEPT + 1 : KEPT + 4], places)
    return max(surely, on + whole - 1.0, 0.0)


@kernel
def kept_everywhere(boxes, places, square, speed, orbits, circles, breaks, paths, numbers, mask):
    """Share of longitude and time, or of time, of which no place of the boxes keeps a limit less.

    Parameters
    ----------
    boxes
        Which together fill the sides that are split; shape (m, BOX). All have the same others.
    places
        Whether longitudes are places: then time alone is split.
    square
        The limit squared.
    speed, orbits, circles, breaks, paths, numbers, mask
        As in `compass.core.certified.shares.refine`.

    Returns
    -------
    share, looked
        The share, and boxes looked at.
    """
    n = orbits.shape[0]
    user, scratch = np.empty(USER), np.zeros(SCRATCH + CUT + EXPANSION)
    q, dq, rows = np.empty((n, 3)), np.empty((n, 3)), np.empty((n + 1, WIDTH))
    kinds, stack = np.empty(n + 1, np.int64), np.empty((256, BOX))
    total, good, looked = 0.0, 0.0, 0
    for i in range(boxes.shape[0]):
        stack[0] = boxes[i]
        depth = 1
        while depth > 0:
            depth -= 1
            box = stack[depth].copy()
            looked += 1
            wide = 1.0
            if box[4] > 0.0 and not places:
                wide *= 2.0 * box[4]
            if box[5] > 0.0:
                wide *= 2.0 * box[5]
            place(box, numbers[E2], numbers[HEIGHT], user)
            states(orbits, circles, breaks, paths, box[2], q, dq)
            count = gather(box, user, scratch, q, dq, rows, kinds, orbits, numbers, mask)
            share = kept(rows, kinds, count, square, scratch, scratch[SCRATCH:], places)
            low, high = box[0] - box[3], box[0] + box[3]
            ring = 1.0 if low <= 0.0 <= high else max(math.cos(low), math.cos(high))
            across, later = ring * box[4], speed * box[5]
            still = max(box[3], across) if places else box[3]
            along = 2 if places or later >= across else 1
            longest = later if along == 2 else across
            if share < 1.0 and longest > PART * still and depth < 250:
                half = 0.5 * box[3 + along]
                for side in (-1.0, 1.0):
                    stack[depth] = box
                    stack[depth, along] += side * half
                    stack[depth, 3 + along] = half
                    depth += 1
                continue
            total += wide
            good += share * wide
    return good / total, looked

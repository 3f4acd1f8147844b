"""How much of the time a limit, or a fold, is surely kept at each place of a box.

A cut ``b x + l y + t z >= threshold`` leaves at latitude x (and longitude y, where places count) of
a box in [-1, 1] a share of longitude and time, or of time alone, that depends on
``w = b x (+ l y)`` and no more: the share of z (and y) beyond ``threshold - w``. A line below it
over all w of the box makes it a linear function of the place; those of all boxes of longitude and
time add up, and the least of their sum at any place is at a corner. What the lines lose is of
second order in the box's sides: bounds of each box by itself would lose the first.
"""

import math

import numpy as np

from compass.core.certified.cuts import KEPT, SCRATCH, cuts, gather
from compass.core.certified.groups import make_room
from compass.core.certified.shares import FOLD
from compass.core.certified.sights import (
    DOP,
    E2,
    FALL,
    HEIGHT,
    HIGH,
    place,
    states,
)
from compass.core.certified.volumes import volume
from compass.core.jit import kernel

#: Sides that may be split are, down to so many times those that may not: what lines lose where the
#: former are long is of second order too, and halved tiles spend the boxes better.
TIMES = 4.0

#: Columns of a box: centre and half-widths of latitude, longitude and time.
BOX = 6


@kernel
def line_below(threshold, cut, places, line):
    """Fill a share at the middle of a box and its slopes by x and y: a line below all shares.

    The density of w is a trapezoid, so that the share less a line is least at an end of the range
    or where the density is the line's slope.
    """
    wide, narrow = abs(cut[2]), 0.0
    reach = abs(cut[0])
    if places:
        reach += abs(cut[1])
    else:
        wide, narrow = max(wide, abs(cut[1])), min(wide, abs(cut[1]))
    least = volume(threshold + reach, 0.0, narrow, wide)
    line[:] = 0.0
    line[0] = least
    if reach == 0.0 or wide == 0.0:
        return
    most = volume(threshold - reach, 0.0, narrow, wide)
    slope = min(0.5 * (most - least) / reach, 0.5 / wide)
    least = min(least + slope * reach, most - slope * reach)
    turn = wide + narrow - 4.0 * narrow * wide * slope
    for side in (-1.0, 1.0):
        if abs(side * turn - threshold) < reach:
            value = volume(side * turn, 0.0, narrow, wide) + slope * (side * turn - threshold)
            least = min(least, value)
    line[0], line[1] = least, slope * cut[0]
    if places:
        line[2] = slope * cut[1]


@kernel
def better(line, other):
    """Keep the line that is higher in the middle."""
    if other[0] > line[0]:
        line[:] = other


@kernel
def kept(rows, kinds, count, square, s, cut, places, lines):
    """Fill lines[0] with a line below the shares in which places of a box keep a limit."""
    line, on, one = lines[0], lines[1], lines[2]
    line[:] = 0.0
    if count < 4:
        return
    on[:] = 0.0
    on[0], doubtful = 1.0, 0
    for k in range(count):
        if kinds[k] == 2:
            doubtful += 1
            line_below(rows[k, FALL] - rows[k, HIGH], rows[k, HIGH + 1 : HIGH + 4], places, one)
            one[0] -= 1.0
            on += one
    above = on[0] + abs(on[1]) + abs(on[2]) > 0.0
    cuts(rows, kinds, count, False, above, square, s, cut)
    line_below(cut[KEPT], cut[KEPT + 1 : KEPT + 4], places, one)
    if doubtful:
        one[0] -= 1.0
        one += on
    better(line, one)
    if doubtful:
        cuts(rows, kinds, count, True, True, square, s, cut)
        line_below(cut[KEPT], cut[KEPT + 1 : KEPT + 4], places, one)
        better(line, one)


@kernel
def in_view(rows, kinds, count, fold, places, lines):
    """Fill lines[0] with a line below the shares in which places of a box have a fold in view.

    Of the satellites in doubt so many as are wanting must be seen: the likeliest all at once, or of
    all no more hidden than may be, which is as rare as their mean number allows.
    """
    line, all_seen, few_hidden = lines[0], lines[1], lines[2]
    line[:] = 0.0
    sure = doubtful = 0
    for k in range(count):
        if kinds[k] == 1:
            sure += 1
            continue
        one = lines[3 + doubtful]
        line_below(rows[k, FALL] - rows[k, HIGH], rows[k, HIGH + 1 : HIGH + 4], places, one)
        one[0] -= 1.0
        doubtful += 1
    wanted = int(fold) - sure
    if count >= 0 and wanted <= 0:
        line[0] = 1.0
        return
    if wanted > doubtful:
        return
    all_seen[:] = 0.0
    few_hidden[:] = 0.0
    for k in range(doubtful):
        few_hidden += lines[3 + k] / (doubtful - wanted + 1.0)
    for k in range(wanted):
        best = k
        for j in range(k + 1, doubtful):
            if lines[3 + j, 0] > lines[3 + best, 0]:
                best = j
        all_seen += lines[3 + best]
        lines[3 + best] = lines[3 + k]
    all_seen[0] += 1.0
    few_hidden[0] += 1.0
    better(line, all_seen)
    better(line, few_hidden)


@kernel
def kept_everywhere(boxes, places, square, speed, problem):
    """Share of longitude and time, or of time, of which no place of the boxes keeps a limit less.

    Parameters
    ----------
    boxes
        Which together fill the sides that are split; shape (m, BOX). All have the same others.
    places
        Whether longitudes are places: then time alone is split.
    square
        The limit squared; a fold, where `numbers` ask for satellites in view.
    speed, problem
        As in `compass.core.certified.shares.refine`.

    Returns
    -------
    share, middle, looked
        The share, what the place in the middle has at least, and boxes looked at.
    """
    orbits, circles, breaks, paths, _, numbers, _ = problem
    room = make_room(orbits.shape[0])
    user, scratch, q, dq, rows, kinds = room
    stack, lines = np.empty((256, BOX)), np.empty((orbits.shape[0] + 4, 3))
    fold = square if numbers[DOP] == FOLD else 4.0
    good, line = np.zeros(3), lines[0]
    total, looked = 0.0, 0
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
            count = gather(box, room, problem)
            if numbers[DOP] == FOLD:
                in_view(rows, kinds, count, square, places, lines)
            else:
                kept(rows, kinds, count, square, scratch, scratch[SCRATCH:], places, lines)
            least = line[0] - abs(line[1]) - abs(line[2])
            hopeless = 0 <= count < fold
            low, high = box[0] - box[3], box[0] + box[3]
            ring = 1.0 if low <= 0.0 <= high else max(math.cos(low), math.cos(high))
            across, later = ring * box[4], speed * box[5]
            still = max(box[3], across) if places else box[3]
            along = 2 if places or later >= across else 1
            longest = later if along == 2 else across
            if least < 1.0 and not hopeless and longest > TIMES * still and depth < 250:
                half = 0.5 * box[3 + along]
                for side in (-1.0, 1.0):
                    stack[depth] = box
                    stack[depth, along] += side * half
                    stack[depth, 3 + along] = half
                    depth += 1
                continue
            total += wide
            good += wide * line
    return (good[0] - abs(good[1]) - abs(good[2])) / total, good[0] / total, looked

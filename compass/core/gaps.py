"""Gaps of a latitude row: how long fewer satellites than wanted are in view, epoch after epoch.

Only the state of every column is kept, not its history: epochs may come in any number of pieces.
"""

import math

import numpy as np

from compass.core.jit import kernel
from compass.core.runs import sight_runs

# What is known of a column: epochs of the gap it is in, epochs of the gap that the span began
# with (nan before it is over), longest gap, number of gaps, sum of lengths and of their squares.
RUN, FIRST, LONGEST, NUMBER, LENGTH, SQUARES = range(6)
STATES = 6


@kernel
def follow_gaps(r, cos_cap, row, fold, state):
    """Follow the gaps of one row over more epochs.

    Parameters
    ----------
    r, cos_cap, row
        As in `compass.core.dop.dop_row`, the first two with a leading epoch axis.
    fold
        Satellites wanted.
    state
        Updated; shape (STATES, column), from `new_state`.
    """
    m = row.cos_lon.size
    counts = np.empty(m, np.int16)
    runs = np.empty((m // 2 + 1, 2), np.int64)
    for t in range(r.shape[0]):
        counts[:] = 0
        for s in range(r.shape[1]):
            x, y, z = r[t, s, 0], r[t, s, 1], r[t, s, 2]
            total = sight_runs(x, y, z, cos_cap[t, s], row, runs)
            for k in range(total):
                for j in range(runs[k, 0], runs[k, 1]):
                    counts[j if j < m else j - m] += 1
        for j in range(m):
            if counts[j] < fold:
                state[RUN, j] += 1.0
            elif math.isnan(state[FIRST, j]):
                state[FIRST, j], state[RUN, j] = state[RUN, j], 0.0
            elif state[RUN, j] > 0.0:
                close_gap(state[:, j], state[RUN, j])
                state[RUN, j] = 0.0


@kernel
def close_gap(column, length):
    """Count a gap that is over."""
    column[LONGEST] = max(column[LONGEST], length)
    column[NUMBER] += 1.0
    column[LENGTH] += length
    column[SQUARES] += length * length


@kernel
def finish_gaps(state, epochs, ring, gaps):
    """Figures of the gaps of a row, in epochs.

    Parameters
    ----------
    state
        After the last epoch; used up.
    epochs
        How many there were.
    ring
        Whether the end of the span goes on at its start. Otherwise it begins and ends there.
    gaps
        Filled; shape (3, column): longest and mean gap, mean response time: the expected wait
        until `fold` are in view from a random moment, ``sum g^2 / (2 epochs)``. In a span that
        does not go on, moments whose wait it does not see the end of are left out. All infinite
        where `fold` are never in view.
    """
    for j in range(state.shape[1]):
        column = state[:, j]
        if math.isnan(column[FIRST]):
            gaps[:, j] = math.inf
            continue
        last = 0.0 if ring else column[RUN]
        if ring:
            column[RUN] += column[FIRST]
        elif column[FIRST] > 0.0:
            close_gap(column, column[FIRST])
        if column[RUN] > 0.0:
            close_gap(column, column[RUN])
        gaps[0, j] = column[LONGEST]
        gaps[1, j] = column[LENGTH] / column[NUMBER] if column[NUMBER] > 0.0 else 0.0
        gaps[2, j] = (column[SQUARES] - last * last) / (2.0 * (epochs - last))


def new_state(columns: int) -> np.ndarray:
    """State of a row before the first epoch."""
    state = np.zeros((STATES, columns))
    state[FIRST] = math.nan
    return state

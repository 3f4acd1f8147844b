"""One pass over a latitude row and all epochs: everything a coverage map says of its cells."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.dop import dop_row, row_scratch
from compass.core.jit import kernel
from compass.core.ranking import BINS, add_to_histogram


class Cells(NamedTuple):
    """What a map says of the cells of one row, over time.

    Smallest, mean and largest count (column,); share of time with at least 1, 2, ... k in view
    (k, column), and with a PDOP that counts as available (column,).
    """

    count_min: NDArray[np.int16]
    count_mean: NDArray[np.float32]
    count_max: NDArray[np.int16]
    share: NDArray[np.float32]
    availability: NDArray[np.float32]


class Tallies(NamedTuple):
    """What a map adds up over its rows.

    Histograms of the DOPs (5, BINS + 1) and of the counts (satellite + 1,); by epoch the smallest,
    the weighted sum and the largest count (3, epoch).
    """

    dop: NDArray[np.float64]
    counts: NDArray[np.float64]
    by_epoch: NDArray[np.float64]


@kernel
def map_row(r, cos_cap, row, threshold, weight, cells, dop, tallies):
    """Statistics over time of one row.

    Parameters
    ----------
    r, cos_cap, row
        As in `dop_row`, the first two with a leading epoch axis.
    threshold
        Largest PDOP that counts as available.
    weight
        Weight of a cell at an epoch in the histograms.
    cells
        Filled.
    dop
        Filled; shape (5, column, epoch): for order statistics over time.
    tallies
        Added to.
    """
    epochs, m = r.shape[0], row.cos_lon.size
    scratch = row_scratch(r.shape[1], row)
    dilutions, counts = np.empty((5, m)), np.empty(m, np.int16)
    count_min, count_max, share, by_epoch = (
        cells.count_min, cells.count_max, cells.share, tallies.by_epoch,
    )  # fmt: skip
    count_min[:], count_max[:] = r.shape[1], 0
    # sums of whole numbers, exact in single precision only up to 2^24
    total, good, at_least = np.zeros(m), np.zeros(m), np.zeros((share.shape[0], m))
    for t in range(epochs):
        dop_row(r[t], cos_cap[t], row, scratch, counts, dilutions)
        low, high, seen = counts[0], counts[0], 0
        for j in range(m):
            n = counts[j]
            low, high, seen = min(low, n), max(high, n), seen + n
            count_min[j], count_max[j] = min(count_min[j], n), max(count_max[j], n)
            total[j] += n
            good[j] += 1.0 if dilutions[1, j] <= threshold else 0.0
            tallies.counts[n] += weight
        for k in range(share.shape[0]):
            for j in range(m):
                at_least[k, j] += 1.0 if counts[j] > k else 0.0
        for d in range(5):
            for j in range(m):
                dop[d, j, t] = dilutions[d, j]
            add_to_histogram(dilutions[d], weight, tallies.dop[d])
        by_epoch[0, t] = min(by_epoch[0, t], low)
        by_epoch[1, t] += weight * seen
        by_epoch[2, t] = max(by_epoch[2, t], high)
    for j in range(m):
        cells.count_mean[j], cells.availability[j] = total[j] / epochs, good[j] / epochs
        for k in range(share.shape[0]):
            share[k, j] = at_least[k, j] / epochs


def empty_tallies(satellites: int, epochs: int) -> Tallies:
    """Tallies ready to be added to."""
    by_epoch = np.zeros((3, epochs))
    by_epoch[0] = math.inf
    return Tallies(np.zeros((5, BINS + 1)), np.zeros(satellites + 1), by_epoch)

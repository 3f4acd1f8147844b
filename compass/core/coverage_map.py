"""One pass over a latitude row and all epochs: everything a coverage map says of its cells."""

import math

import numpy as np

from compass.core.dop import dop_row, row_scratch
from compass.core.jit import kernel
from compass.core.ranking import BINS, add_to_histogram


@kernel
def map_row(
    r,
    cos_cap,
    azimuths,
    elevations,
    place,
    cos_lon,
    sin_lon,
    lon0,
    threshold,
    weight,
    count_min,
    count_mean,
    count_max,
    share,
    availability,
    dop,
    histogram,
    count_histogram,
    epoch_counts,
):
    """Statistics over time of one row.

    Parameters
    ----------
    r, cos_cap
        As in `dop_row`, with a leading epoch axis.
    azimuths, elevations, place, cos_lon, sin_lon, lon0
        As in `dop_row`.
    threshold
        Largest PDOP that counts as available.
    weight
        Weight of a cell at an epoch in the histograms.
    count_min, count_mean, count_max, availability
        Filled; shape (column,).
    share
        Filled; shape (k, column): share of time with at least 1, 2, ... k in view.
    dop
        Filled; shape (5, column, epoch): for order statistics over time.
    histogram
        Added to; shape (5, BINS + 1).
    count_histogram
        Added to; shape (satellite + 1,).
    epoch_counts
        Updated; shape (3, epoch): smallest, weighted sum and largest count.
    """
    epochs, m = r.shape[0], cos_lon.size
    tile, runs, owners = row_scratch(r.shape[1], m, azimuths.size)
    row, counts = np.empty((5, m)), np.empty(m, np.int16)
    count_min[:], count_max[:] = r.shape[1], 0
    # sums of whole numbers, exact in single precision only up to 2^24
    total, good, at_least = np.zeros(m), np.zeros(m), np.zeros((share.shape[0], m))
    for t in range(epochs):
        dop_row(
            r[t], cos_cap[t], azimuths, elevations, place, cos_lon, sin_lon, lon0,
            tile, runs, owners, counts, row,
        )  # fmt: skip
        low, high, seen = counts[0], counts[0], 0
        for j in range(m):
            n = counts[j]
            low, high, seen = min(low, n), max(high, n), seen + n
            count_min[j], count_max[j] = min(count_min[j], n), max(count_max[j], n)
            total[j] += n
            good[j] += 1.0 if row[1, j] <= threshold else 0.0
            count_histogram[n] += weight
        for k in range(share.shape[0]):
            for j in range(m):
                at_least[k, j] += 1.0 if counts[j] > k else 0.0
        for d in range(5):
            for j in range(m):
                dop[d, j, t] = row[d, j]
            add_to_histogram(row[d], weight, histogram[d])
        epoch_counts[0, t] = min(epoch_counts[0, t], low)
        epoch_counts[1, t] += weight * seen
        epoch_counts[2, t] = max(epoch_counts[2, t], high)
    for j in range(m):
        count_mean[j], availability[j] = total[j] / epochs, good[j] / epochs
        for k in range(share.shape[0]):
            share[k, j] = at_least[k, j] / epochs


def empty_histograms(satellites: int, epochs: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """DOP histogram, count histogram and counts by epoch, ready to be added to."""
    epoch_counts = np.zeros((3, epochs))
    epoch_counts[0] = math.inf
    return np.zeros((5, BINS + 1)), np.zeros(satellites + 1), epoch_counts

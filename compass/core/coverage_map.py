"""One pass over a latitude row and all epochs: everything a coverage map says of its cells."""

import math

import numpy as np

from compass.core.dop import dop_row, row_scratch
from compass.core.jit import kernel
from compass.core.ranking import BINS, add_to_histogram, select


@kernel
def map_row(
    r,
    cos_cap,
    azimuths,
    elevations,
    sin_lat,
    cos_lat,
    cos_lon,
    sin_lon,
    lon0,
    fold,
    threshold,
    ranks,
    weight,
    count_min,
    count_mean,
    count_max,
    share,
    percentiles,
    availability,
    gaps,
    histogram,
    count_histogram,
    epoch_counts,
):
    """Statistics over time of one row.

    Parameters
    ----------
    r, cos_cap
        As in `dop_row`, with a leading epoch axis.
    azimuths, elevations, sin_lat, cos_lat, cos_lon, sin_lon, lon0
        As in `dop_row`.
    fold
        Satellites wanted, for the gaps.
    threshold
        Largest PDOP that counts as available.
    ranks
        Which order statistics of the DOPs to keep, shape (q,).
    weight
        Weight of a cell at an epoch in the histograms.
    count_min, count_mean, count_max, availability
        Filled; shape (column,).
    share
        Filled; shape (k, column): share of time with at least 1, 2, ... k in view.
    percentiles
        Filled; shape (5, q, column).
    gaps
        Filled; shape (3, column): longest and mean gap, mean response time, in epochs.
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
    series = np.empty((m, epochs), np.int16)
    dop = np.empty((5, m, epochs))
    for t in range(epochs):
        dop_row(
            r[t], cos_cap[t], azimuths, elevations, sin_lat, cos_lat, cos_lon, sin_lon, lon0,
            tile, runs, owners, counts, row,
        )  # fmt: skip
        low, high, total = counts[0], counts[0], 0
        for j in range(m):
            n = counts[j]
            series[j, t] = n
            low, high, total = min(low, n), max(high, n), total + n
            count_histogram[n] += weight
            for d in range(5):
                dop[d, j, t] = row[d, j]
        for d in range(5):
            add_to_histogram(row[d], weight, histogram[d])
        epoch_counts[0, t] = min(epoch_counts[0, t], low)
        epoch_counts[1, t] += weight * total
        epoch_counts[2, t] = max(epoch_counts[2, t], high)
    for j in range(m):
        column_statistics(series[j], share[:, j], gaps[:, j], fold)
        low, high, total, good = series[j, 0], series[j, 0], 0, 0
        for t in range(epochs):
            n = series[j, t]
            low, high, total = min(low, n), max(high, n), total + n
            if dop[1, j, t] <= threshold:
                good += 1
        count_min[j], count_max[j] = low, high
        count_mean[j] = total / epochs
        availability[j] = good / epochs
        for d in range(5):
            for q in range(ranks.size):
                percentiles[d, q, j] = select(dop[d, j], ranks[q])


@kernel
def column_statistics(series, share, gaps, fold):
    """Shares of time with at least k in view, and the gaps of one cell, epochs periodic.

    Parameters
    ----------
    series
        Count at each epoch, shape (epoch,).
    share
        Filled; shape (k,).
    gaps
        Filled; shape (3,), in epochs: longest gap, mean gap, and mean response time, the
        expected wait until `fold` are in view from a random moment, ``sum g^2 / (2 epochs)``.
        All infinite where `fold` are never in view.
    fold
        Satellites wanted.
    """
    epochs = series.size
    share[:] = 0.0
    start = -1
    for t in range(epochs):
        n = series[t]
        for k in range(min(n, share.size)):
            share[k] += 1.0
        if n >= fold and start < 0:
            start = t
    for k in range(share.size):
        share[k] /= epochs
    if start < 0:
        gaps[:] = math.inf
        return
    longest, number, length, squares, run = 0, 0, 0, 0.0, 0
    for step in range(1, epochs + 1):
        if series[(start + step) % epochs] < fold:
            run += 1
        elif run:
            longest, number, length = max(longest, run), number + 1, length + run
            squares += run * run
            run = 0
    gaps[0] = longest
    gaps[1] = length / number if number else 0.0
    gaps[2] = squares / (2.0 * epochs)


def empty_histograms(satellites: int, epochs: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """DOP histogram, count histogram and counts by epoch, ready to be added to."""
    epoch_counts = np.zeros((3, epochs))
    epoch_counts[0] = math.inf
    return np.zeros((5, BINS + 1)), np.zeros(satellites + 1), epoch_counts

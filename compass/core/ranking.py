"""Order statistics: selection in small samples, and weighted histograms on a log scale."""

import math

import numpy as np

from compass.core.jit import kernel

#: Histogram bins an octave: a bin is 1/2048 of an octave's lower end wide, so a quantile is
#: known to a relative 4.9e-4 at worst and, with values spread evenly inside a bin, far better.
BITS = 11
#: Octaves from 2^-8 to 2^24, infinity has a bin of its own. No dilution of precision lies outside:
#: each is at least ``1/sqrt(n)``, and n satellites are fewer than 2^16; and near PDOP 4e6, below
#: 2^22, geometry counts as singular (`compass.core.dop.dops`).
LOWEST, HIGHEST = -8, 24
BINS = (HIGHEST - LOWEST) << BITS


@kernel
def select(values, k):
    """Return the k-th smallest (from 0) of `values`, which is reordered (Hoare's quickselect).

    Infinities are values like any other; there must be no nan.
    """
    low, high = 0, values.size - 1
    while low < high:
        pivot = values[(low + high) // 2]
        i, j = low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if k <= j:
            high = j
        elif k >= i:
            low = i
        else:
            break
    return values[k]


@kernel
def nearest_rank(size, percent):
    """Place, from 0, of the smallest of `size` values that `percent` of them do not exceed."""
    return max(-(-percent * size // 100), 1) - 1


@kernel
def add_to_histogram(values, weight, histogram):
    """Add positive values, each of one weight, to a log-scale histogram.

    The leading bits of a floating-point number are its octave and its place in it, so the bin
    is a shift of the number's bits.

    Parameters
    ----------
    values
        Positive, shape (n,); inf goes into the last bin.
    weight
        Weight of each.
    histogram
        Added to; shape (BINS + 1,).
    """
    bits = values.view(np.int64)
    origin = (1023 + LOWEST) << BITS
    for k in range(values.size):
        if values[k] == math.inf:
            histogram[BINS] += weight
        else:
            b = (bits[k] >> (52 - BITS)) - origin
            histogram[min(max(b, 0), BINS - 1)] += weight


def histogram_quantile(histogram: np.ndarray, q: float) -> float:
    """Value below which a share q of the weight lies; inf where the finite values do not reach.

    Linear inside a bin. nan for an empty histogram.
    """
    total = histogram.sum()
    if not total > 0:
        return math.nan
    cumulative = np.cumsum(histogram)
    target = q * total
    b = int(np.searchsorted(cumulative, target * (1 - 1e-12)))
    if b >= BINS:
        return math.inf
    below = cumulative[b - 1] if b else 0.0
    inside = min(max((target - below) / histogram[b], 0.0), 1.0)
    octave, place = divmod(b, 1 << BITS)
    return math.ldexp(1.0 + (place + inside) / (1 << BITS), octave + LOWEST)

"""Percentiles of what was drawn, with the bounds that so few draws leave them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: With this probability the bounds hold what endless draws would give.
CONFIDENCE = 0.95


def percentiles(
    values: NDArray[np.float64], percents: tuple[int, ...] = (50, 95)
) -> dict[str, Any]:
    """Median and 95th percentile of independent draws, with their bounds, ``p95_interval``."""
    found: dict[str, Any] = {}
    for percent in (50, 95):
        found[f"p{percent}"] = float(np.percentile(values, percent))
        found[f"p{percent}_interval"] = list(quantile_bounds(values, percent))
    return found


def quantile_bounds(values: NDArray[np.float64], percent: float) -> tuple[float, float]:
    """Bounds of a percentile whatever the distribution, at least `CONFIDENCE` to hold.

    How many of n draws lie below the percentile is binomial, so that it lies between the order
    statistics of ranks that the binomial's quantiles give. An end that no draw can bound is
    infinite.

    References
    ----------
    David and Nagaraja 2003, Order Statistics, 3rd edition, section 7.1.
    """
    from scipy.stats import binom

    n, order = values.size, np.sort(values)
    tail = 0.5 * (1.0 - CONFIDENCE)
    # fewer than `low` lie below with less than the tail's probability, and so above
    low = int(binom.ppf(tail, n, percent / 100))
    high = int(binom.ppf(1.0 - tail, n, percent / 100)) + 1
    return (
        float(order[low - 1]) if low >= 1 else -np.inf,
        float(order[high - 1]) if high <= n else np.inf,
    )

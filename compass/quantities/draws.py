"""Percentiles of what was drawn, with the bounds that so few draws leave them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.quantities.percentile import percentile

#: With this probability the bounds hold what endless draws would give.
CONFIDENCE = 0.95


def percentiles(values: NDArray[np.float64]) -> dict[str, Any]:
    """Median and 95th percentile of independent draws, with their bounds, ``p95_interval``."""
    found: dict[str, Any] = {}
    for percent in (50, 95):
        found[f"p{percent}"] = float(percentile(values, percent))
        found[f"p{percent}_interval"] = list(quantile_bounds(values, percent))
    return found


def share_bounds(share: float, draws: int) -> tuple[float, float]:
    """Bounds of a probability by the share of independent draws that had it, as `CONFIDENCE` says.

    By Clopper and Pearson: the probabilities at which so many or more, and so many or fewer, would
    be as rare as either tail. Of draws that have it in part the bounds are wider than they need be.

    References
    ----------
    Clopper and Pearson 1934, Biometrika 26, 404-413.
    """
    from scipy.special import betaincinv  # statistics load much more than they need

    hits, tail = share * draws, 0.5 * (1.0 - CONFIDENCE)
    return (
        float(betaincinv(hits, draws - hits + 1, tail)) if hits > 0 else 0.0,
        float(betaincinv(hits + 1, draws - hits, 1.0 - tail)) if hits < draws else 1.0,
    )


def quantile_bounds(values: NDArray[np.float64], percent: float) -> tuple[float, float]:
    """Bounds of a percentile whatever the distribution, at least `CONFIDENCE` to hold.

    How many of n draws lie below the percentile is binomial, so that it lies between the order
    statistics of ranks that the binomial's quantiles give. An end that no draw can bound is
    infinite.

    References
    ----------
    David and Nagaraja 2003, Order Statistics, 3rd edition, section 7.1.
    """
    from scipy.special import bdtr

    n, order = values.size, np.sort(values)
    tail = 0.5 * (1.0 - CONFIDENCE)
    # fewer than `low` lie below with less than the tail's probability, and so above
    below = bdtr(np.arange(n + 1), n, percent / 100)
    low, high = (int(np.searchsorted(below, share)) for share in (tail, 1.0 - tail))
    high += 1
    return (
        float(order[low - 1]) if low >= 1 else -np.inf,
        float(order[high - 1]) if high <= n else np.inf,
    )

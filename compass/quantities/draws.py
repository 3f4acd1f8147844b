"""Percentiles and shares of what was drawn, with the bounds that so few draws leave them."""

from collections.abc import Sequence
from math import ceil, inf, log, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.quantities.percentile import percentile

#: With this probability the bounds hold what endless draws would give.
CONFIDENCE = 0.95


def percentiles(
    values: NDArray[np.float64], percents: Sequence[float] = (50, 95)
) -> dict[str, Any]:
    """Percentiles of independent draws, ``p95``, with their bounds, ``p95_interval``."""
    by_name: dict[str, Any] = {}
    order = np.sort(values)  # once: what is in order already is sorted at once
    for percent in percents:
        by_name[f"p{percent}"] = float(percentile(order, percent))
        by_name[f"p{percent}_interval"] = list(quantile_bounds(order, percent))
    return by_name


def share_of(name: str, hits: NDArray[np.bool_], several: int = 1) -> dict[str, Any]:
    """Share of independent draws that had something, by its name, with its bounds beside it.

    Of `several` shares the bounds of all hold at once.
    """
    share, tail = float(hits.mean()), 0.5 * (1.0 - CONFIDENCE) / several
    return {name: share, f"{name}_interval": list(share_bounds(share, hits.size, tail))}


def mean_of(name: str, values: NDArray[Any], most: float) -> dict[str, Any]:
    """Mean of independent draws from 0 to `most`, by its name, with its bounds beside it.

    By the empirical Bernstein inequality, whatever the distribution.

    References
    ----------
    Maurer and Pontil 2009, COLT 22, Theorem 4.
    """
    n, mean = values.size, float(values.mean())
    told = log(4.0 / (1.0 - CONFIDENCE))  # either side is wrong in half of the cases left
    spread = float(values.var(ddof=1)) if n > 1 else inf
    off = sqrt(2.0 * spread * told / n) + 7.0 * most * told / (3.0 * max(n - 1, 1))
    return {name: mean, f"{name}_interval": [max(mean - off, 0.0), min(mean + off, most)]}


def median_of(
    name: str, counts: NDArray[np.int64], draws: int, longest: int
) -> dict[str, float | list[float]]:
    """Median of a number over all moments of the draws, by its name, with its bounds beside it."""
    ends = median_bounds(counts, draws, longest)
    return {name: float(median_number(counts)), f"{name}_interval": list(ends)}


def median_number(counts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Median (nearest rank) of a number that occurs ``counts[..., number]`` times, shape (...)."""
    up_to = counts.cumsum(axis=-1)
    return np.asarray((2 * up_to < up_to[..., -1:]).sum(axis=-1), dtype=np.float64)


def median_bounds(counts: NDArray[np.int64], draws: int, longest: int) -> tuple[float, float]:
    """Bounds of the median of a number over the moments of independent draws.

    Moments of one draw tell of each other. A number is the median or more exactly if up to it lie,
    in the mean over draws, half of a draw's moments or more: their excess over half, as a part of
    the moments of the longest draw, is between -1/2 and 1/2, and so 1/2 more a share that draws
    have in part (`share_bounds`).

    Parameters
    ----------
    counts
        How often 0, 1, ... up to the most possible occur, over all draws, shape (n + 1,).
    draws
        How many.
    longest
        Moments that a draw has at most.
    """
    up_to = counts.cumsum()
    shares = 0.5 + (up_to - 0.5 * up_to[-1]) / (draws * longest)
    low, high = np.array([share_bounds(share, draws) for share in shares]).T
    below, sure = high < 0.5, low[:-1] >= 0.5  # all are up to the most possible
    return float(below.sum()), float(sure.size - sure.sum())


def share_bounds(
    share: float, draws: int, tail: float = 0.5 * (1.0 - CONFIDENCE)
) -> tuple[float, float]:
    """Bounds of a probability by the share of independent draws that had it.

    Either is wrong in a share `tail` of all cases at most.

    By Clopper and Pearson: the probabilities at which so many or more, and so many or fewer, would
    be as rare as either tail. Of draws that have it in part the bounds are wider than they need be.

    References
    ----------
    Clopper and Pearson 1934, Biometrika 26, 404-413.
    """
    from scipy.special import betaincinv  # statistics load much more than they need

    hits = share * draws
    return (
        float(betaincinv(hits, draws - hits + 1, tail)) if hits > 0 else 0.0,
        float(betaincinv(hits + 1, draws - hits, 1.0 - tail)) if hits < draws else 1.0,
    )


def quantile_bounds(
    values: NDArray[np.float64], percent: float, tail: float = 0.5 * (1.0 - CONFIDENCE)
) -> tuple[float, float]:
    """Bounds of a percentile whatever the distribution, either wrong in a share `tail` at most.

    How many of n draws lie below the percentile is binomial, so that it lies between the order
    statistics of ranks that the binomial's quantiles give. An end that no draw can bound is
    infinite.

    References
    ----------
    David and Nagaraja 2003, Order Statistics, 3rd edition, section 7.1.
    """
    n, order = values.size, np.sort(values)
    # fewer than `low` lie below with less than the tail's probability, and so above
    low, high = (_binomial_quantile(q, n, percent / 100) for q in (tail, 1.0 - tail))
    high += 1
    return (
        float(order[low - 1]) if low >= 1 else -np.inf,
        float(order[high - 1]) if high <= n else np.inf,
    )


def _binomial_quantile(probability: float, draws: int, share: float) -> int:
    """Fewest hits that so many draws do not exceed with at least a probability."""
    from scipy.special import bdtr, bdtrik

    hits = max(ceil(bdtrik(probability, draws, share)), 0)
    # rounding may take the inverse to the next
    return hits - 1 if hits and bdtr(hits - 1, draws, share) >= probability else hits

"""Gaps between spans: how many, how long, and how long one waits for the next span."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.contacts.spans import Spans, outside, total
from compass.quantities.percentile import percentile


@dataclass(frozen=True)
class GapStatistics:
    """What the gaps of a set come to over its span; the span's ends are treated as ends.

    Attributes
    ----------
    count, cut
        Gaps, and how many of them the span's ends cut off: these are longer than they look.
    share
        Share of the time covered.
    longest, mean, p95
        Length of gaps, seconds, the last the least that 95 of 100 do not exceed; 0 without gaps.
    time_average
        Length of the gap that a random moment of the span lies in, 0 outside gaps, on average:
        ``sum L^2 / T``, seconds.
    response
        Mean wait for coverage from a random moment on, ``sum L^2 / (2 T)``, seconds.
    age
        Mean time since coverage at a random moment, the age of data: each gap is looked back on
        as it is waited in, so the same.
    """

    count: int
    cut: int
    share: float
    longest: float
    mean: float
    p95: float
    time_average: float
    response: float

    @property
    def age(self) -> float:
        """Mean age of data."""
        return self.response


def gap_statistics(spans: Spans, duration: float) -> GapStatistics:
    """Return what the gaps of `spans` over ``0 <= t <= duration`` (seconds) come to."""
    gaps = outside(spans, duration)
    length = gaps[:, 1] - gaps[:, 0]
    squares = float((length**2).sum()) / duration
    return GapStatistics(
        count=len(gaps),
        cut=int(((gaps[:, 0] <= 0.0) | (gaps[:, 1] >= duration)).sum()),
        share=total(spans) / duration,
        longest=float(length.max(initial=0.0)),
        mean=float(length.mean()) if len(gaps) else 0.0,
        p95=float(percentile(length, 95)) if len(gaps) else 0.0,
        time_average=squares,
        response=0.5 * squares,
    )


def ages(spans: Spans, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Age of data at moments: seconds since the last of `spans`, 0 inside, nan before the first."""
    last = np.searchsorted(spans[:, 0], times, side="right") - 1
    ends = np.append(spans[:, 1], np.nan)[last]  # -1 is the last one
    return np.asarray(np.where(np.isnan(ends), np.nan, np.maximum(times - ends, 0.0)))

"""Figures of merit of a set of windows."""

from dataclasses import dataclass

from compass.bodies import SOLAR_DAY
from compass.contacts.spans import Spans, outside, total


@dataclass(frozen=True)
class Statistics:
    """What a set of windows comes to over its span.

    Attributes
    ----------
    count
        Number of windows, those cut at the ends of the span included.
    share
        Share of the time covered.
    mean_duration, shortest, longest
        Of the windows, seconds; 0 if there are none.
    longest_gap, mean_gap
        Of the times not covered, those at the ends of the span included, seconds; 0 if none.
    passes_per_sol
        Windows a mean solar day.
    """

    count: int
    share: float
    mean_duration: float
    shortest: float
    longest: float
    longest_gap: float
    mean_gap: float
    passes_per_sol: float


def statistics(spans: Spans, duration: float) -> Statistics:
    """Return the figures of merit of `spans` over ``0 <= t <= duration`` (seconds)."""
    lengths = spans[:, 1] - spans[:, 0]
    gaps = outside(spans, duration)
    gap_lengths = gaps[:, 1] - gaps[:, 0]
    return Statistics(
        count=len(spans),
        share=total(spans) / duration,
        mean_duration=float(lengths.mean()) if len(lengths) else 0.0,
        shortest=float(lengths.min(initial=duration)) if len(lengths) else 0.0,
        longest=float(lengths.max(initial=0.0)),
        longest_gap=float(gap_lengths.max(initial=0.0)),
        mean_gap=float(gap_lengths.mean()) if len(gaps) else 0.0,
        passes_per_sol=len(spans) * SOLAR_DAY.value / duration,
    )

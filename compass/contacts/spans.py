"""Sets of time spans: any of, all of, at least k of, none of.

A set is an array of starts and ends, shape (n, 2), seconds, in order and not overlapping.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Spans = NDArray[np.float64]


def at_least(k: int, sets: Sequence[Spans]) -> Spans:
    """Return the times covered by at least k of the sets; spans that touch become one."""
    if k <= 0:
        raise ValueError(f"k = {k}: at least 1 set must be asked for")
    times, covered = _counted(sets)
    if not times.size:
        return np.empty((0, 2))
    inside = covered >= k
    begins = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    ends = np.flatnonzero(~inside & np.concatenate([[False], inside[:-1]]))
    spans = np.stack([times[begins], times[ends]], axis=1)
    return spans[spans[:, 1] > spans[:, 0]]


def fewest(sets: Sequence[Spans], duration: float) -> int:
    """Return how many of the sets cover every moment from 0 to `duration` at least."""
    times, covered = _counted(sets)
    lasts = np.diff(times, prepend=0.0, append=duration) > 0.0
    return int(np.append(0, covered)[lasts].min())


def _counted(sets: Sequence[Spans]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """When spans begin and end, and how many of the sets cover the time from then on."""
    times = np.concatenate([np.empty(0), *(s.T.ravel() for s in sets)])
    steps = np.concatenate([np.empty(0, int), *(np.repeat([1, -1], len(s)) for s in sets)])
    order = np.lexsort((-steps, times))  # at one time, what begins comes before what ends
    return times[order], np.cumsum(steps[order])


def any_of(sets: Sequence[Spans]) -> Spans:
    """Return the times covered by any of the sets."""
    return at_least(1, sets)


def all_of(sets: Sequence[Spans]) -> Spans:
    """Return the times covered by all of the sets: a chain of links is up when each link is."""
    return at_least(len(sets), sets)


def outside(spans: Spans, duration: float) -> Spans:
    """Return the times from 0 to `duration` that a set does not cover: its gaps."""
    edges = np.concatenate([[0.0], spans.ravel(), [duration]]).reshape(-1, 2)
    return edges[edges[:, 1] > edges[:, 0]]


def total(spans: Spans) -> float:
    """Return the time that a set covers, seconds."""
    return float((spans[:, 1] - spans[:, 0]).sum())

"""Pareto fronts: which candidates no other beats in every objective."""

from bisect import bisect_left

import numpy as np
from numpy.typing import NDArray


def fronts(
    values: NDArray[np.float64], high: NDArray[np.float64] | None = None
) -> NDArray[np.int64]:
    """Front of each point: 0 for those that none dominates, 1 for the next once they are gone ...

    A point dominates another if it is nowhere larger and somewhere smaller; of brackets, if it is
    so wherever in them both lie: its upper bounds and the other's lower ones. Sorted first, a
    point can be dominated only by those before it, and it belongs to the first front of which
    no member dominates it, found by bisection: a point that a front dominates, those before it
    dominate too (efficient non-dominated sort).

    Parameters
    ----------
    values
        To be minimised, shape (n, m), no nan.
    high
        Upper bounds where `values` are lower ones.

    References
    ----------
    Zhang et al. 2015, An Efficient Approach to Nondominated Sorting for Evolutionary
    Multiobjective Optimization, IEEE Trans. Evol. Comput. 19(2):201-213.
    """
    upper = values if high is None else high
    rank = np.zeros(len(values), dtype=np.int64)
    members: list[NDArray[np.float64]] = []
    for k in np.lexsort(values.T[::-1]):
        point = values[k]
        front = bisect_left(members, True, key=lambda others: not _dominated(point, others))
        if front == len(members):
            members.append(np.empty((0, point.size)))
        members[front] = np.vstack([members[front], upper[k]])
        rank[k] = front
    return rank


def _dominated(point: NDArray[np.float64], others: NDArray[np.float64]) -> bool:
    return bool(np.any(np.all(others <= point, axis=1) & np.any(others < point, axis=1)))


def crowding(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far apart each point's neighbours are, summed over objectives; infinite at the ends.

    An infinite value counts as the finite one next to it.

    References
    ----------
    Deb et al. 2002, A Fast and Elitist Multiobjective Genetic Algorithm: NSGA-II, IEEE Trans.
    Evol. Comput. 6(2):182-197, section III-B.
    """
    distance = np.zeros(len(values))
    for objective in values.T:
        finite = objective[np.isfinite(objective)]
        column = (
            np.clip(objective, finite.min(), finite.max()) if finite.size else np.zeros(len(values))
        )
        order = np.argsort(column, kind="stable")
        width = column[order[-1]] - column[order[0]]
        distance[order[[0, -1]]] = np.inf
        if width > 0:
            distance[order[1:-1]] += (column[order[2:]] - column[order[:-2]]) / width
    return distance


def best(values: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Places of the `count` best points: front by front, of the last the least crowded."""
    rank = fronts(values)
    apart = np.zeros(len(values))
    for front in range(int(rank.max(initial=-1)) + 1):
        chosen = np.flatnonzero(rank == front)
        apart[chosen] = crowding(values[chosen])
    order = np.lexsort((np.arange(len(values)), -apart, rank))
    return np.sort(order[:count])

"""Store and forward: when a message left at a node reaches another, interval by interval."""

import math

import numpy as np

from compass.core.jit import kernel


@kernel
def earliest_arrivals(labels, begins, target):
    """Earliest time at which a message held by each node as an interval begins is at `target`.

    Within an interval the links stand still, and a message spreads at once to its component.
    Going back from the last interval, ``A_k[n] = t_k`` if n is connected to the target, else
    the least ``A_(k+1)`` over the nodes connected to n, which may store it.

    Parameters
    ----------
    labels
        Component of each node in each interval, shape (k, n); any whole numbers.
    begins
        Begin of each interval, seconds, shape (k,).
    target
        Index of the receiving node.

    Returns
    -------
    array, shape (k, n)
        Seconds; infinite where the message does not arrive within the span.
    """
    count, n = labels.shape
    arrivals = np.full((count, n), math.inf)
    least = np.empty(n)
    groups = np.empty(n, dtype=np.int64)  # first node of each node's component
    for k in range(count - 1, -1, -1):
        for node in range(n):
            groups[node] = 0
            while labels[k, groups[node]] != labels[k, node]:
                groups[node] += 1
        least[:] = math.inf
        if k + 1 < count:
            for node in range(n):
                group = groups[node]
                least[group] = min(least[group], arrivals[k + 1, node])
        for node in range(n):
            connected = groups[node] == groups[target]
            arrivals[k, node] = begins[k] if connected else least[groups[node]]
    return arrivals

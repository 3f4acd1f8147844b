"""Relaying: which nodes are joined when, through how many hops, and how long messages wait.

Between the begins and ends of windows the graph of links stands still, so every figure here is
exact for the windows given; it is no sample. Light time is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.contacts.spans import Spans, any_of
from compass.contacts.windows import Windows
from compass.core.relay import earliest_arrivals
from compass.errors import ArgumentError, meant


@dataclass(frozen=True)
class Contacts:
    """The graph of links over time.

    Attributes
    ----------
    names
        Nodes.
    edges
        Begins of the k intervals in which the graph stands still, and the end: shape (k + 1,).
    links
        Links that are up, shape (l, 3): interval and the two nodes' indices.
    """

    names: tuple[str, ...]
    edges: NDArray[np.float64]
    links: NDArray[np.intp]

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Lengths of the intervals, seconds, shape (k,)."""
        return np.diff(self.edges)

    @cached_property
    def adjacency(self) -> Any:
        """Sparse adjacency of all intervals side by side: node j of interval k is row k n + j."""
        from scipy.sparse import csr_array

        n, k = len(self.names), len(self.lengths)
        rows = self.links[:, 0] * n + self.links[:, 1]
        columns = self.links[:, 0] * n + self.links[:, 2]
        return csr_array((np.ones(len(rows)), (rows, columns)), shape=(k * n, k * n))

    @cached_property
    def components(self) -> NDArray[np.int32]:
        """Label of the connected component of each node in each interval, shape (k, n)."""
        from scipy.sparse.csgraph import connected_components

        labels = connected_components(self.adjacency, directed=False)[1]
        groups: NDArray[np.int32] = labels.reshape(len(self.lengths), len(self.names))
        return groups


def contacts(spans: Sequence[Windows]) -> Contacts:
    """Cut the span of some windows (all of one duration) where any begins or ends.

    Raises
    ------
    ArgumentError
        There are no pairs.
    """
    if not spans:
        raise ArgumentError("relay: there are no links; ask for stations, moons or the Earth")
    names = tuple(dict.fromkeys(name for w in spans for name in (w.first, w.second)))
    index = {name: k for k, name in enumerate(names)}
    edges = np.unique(np.concatenate([[0.0, spans[0].duration], *(w.spans.ravel() for w in spans)]))
    parts = []
    for w in spans:
        first, last = np.searchsorted(edges, w.start), np.searchsorted(edges, w.end)
        interval = np.concatenate(
            [np.arange(a, b) for a, b in zip(first, last, strict=True)] or [np.empty(0, int)]
        )
        pair = np.broadcast_to([index[w.first], index[w.second]], (len(interval), 2))
        parts.append(np.column_stack([interval, pair]))
    return Contacts(names, edges, np.concatenate(parts).astype(np.intp))


def hops(graph: Contacts, source: str, target: str) -> NDArray[np.float64]:
    """Fewest links from source to target in each interval, shape (k,); inf where there is no path.

    Breadth-first search (SciPy's csgraph) through all intervals at once.
    """
    from scipy.sparse.csgraph import dijkstra

    n, k = len(graph.names), len(graph.lengths)
    starts = np.arange(k) * n + _index(graph, source)
    distance = dijkstra(
        graph.adjacency, directed=False, unweighted=True, indices=starts, min_only=True
    )
    counts: NDArray[np.float64] = distance.reshape(k, n)[:, _index(graph, target)]
    return counts


@dataclass(frozen=True)
class Reach:
    """How well a node reaches another through the network.

    Attributes
    ----------
    source, target
        Names.
    share
        Share of the time with a path.
    by_hops
        Share of the time for each fewest number of links.
    spans
        When there is a path, shape (n, 2), seconds.
    """

    source: str
    target: str
    share: float
    by_hops: dict[int, float]
    spans: Spans


def reach(graph: Contacts, source: str, target: str) -> Reach:
    """Share of the time that source reaches target at once, and through how many links."""
    count = hops(graph, source, target)
    whole = graph.edges[-1] - graph.edges[0]
    joined = np.isfinite(count)
    shares = {
        int(h): float(graph.lengths[count == h].sum() / whole) for h in np.unique(count[joined])
    }
    spans = np.stack([graph.edges[:-1], graph.edges[1:]], axis=1)[joined]
    return Reach(source, target, sum(shares.values()), shares, any_of([spans]))


@dataclass(frozen=True)
class Latency:
    """How long a message from source waits before target has it, by store and forward.

    Attributes
    ----------
    source, target
        Names.
    mean, longest
        Over all times of departure from which it arrives within the span, seconds.
    at_once
        Share of the departures that need not wait.
    undelivered
        Share of the departures from which it does not arrive within the span.
    """

    source: str
    target: str
    mean: float
    longest: float
    at_once: float
    undelivered: float


def latency(graph: Contacts, source: str, target: str) -> Latency:
    """Find the waiting times of messages that any node may store until its next link."""
    labels = graph.components
    s, t = _index(graph, source), _index(graph, target)
    arrivals = earliest_arrivals(labels, graph.edges[:-1], t)[:, s]
    begins, lengths = graph.edges[:-1], graph.lengths
    joined = labels[:, s] == labels[:, t]
    delivered = np.isfinite(arrivals)
    waits = delivered & ~joined
    # departures are spread evenly; while waiting, the wait falls as fast as time goes by
    longest = (arrivals - begins)[waits]
    waited = (longest - 0.5 * lengths[waits]) * lengths[waits]
    arriving = lengths[delivered].sum()
    whole = lengths.sum()
    return Latency(
        source,
        target,
        mean=float(waited.sum() / arriving) if arriving else np.nan,
        longest=float(longest.max(initial=0.0)) if arriving else np.nan,
        at_once=float(lengths[joined].sum() / whole),
        undelivered=float(lengths[~delivered].sum() / whole),
    )


def _index(graph: Contacts, name: str) -> int:
    if name not in graph.names:
        guess = meant(name, graph.names)
        raise ArgumentError(f"node {name!r}: unknown; {guess}there are {', '.join(graph.names)}")
    return graph.names.index(name)

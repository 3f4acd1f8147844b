"""Relaying on random contact plans against step-by-step flooding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.contacts.relay import contacts, hops, latency, reach
from compass.contacts.windows import Windows
from compass.errors import ArgumentError

NAMES = ("A", "B", "C", "D", "E")
DURATION = 20.0


def link(first, second, spans):
    edges = np.array(spans, dtype=float).reshape(-1, 2)
    nothing = np.full(len(edges), np.nan)
    return Windows(first, second, edges[:, 0], edges[:, 1], nothing, nothing, DURATION)


@st.composite
def plans(draw):
    plan = [link("A", "B", [])]
    for i in range(5):
        for j in range(i + 1, 5):
            edges = sorted(draw(st.sets(st.integers(0, 20), max_size=4)))
            plan.append(link(NAMES[i], NAMES[j], edges[: len(edges) // 2 * 2]))
    return plan


def joined(plan, t):
    """Adjacency at a time."""
    links = {name: set() for name in NAMES}
    for w in plan:
        if np.any((w.start < t) & (t < w.end)):
            links[w.first].add(w.second)
            links[w.second].add(w.first)
    return links


def distances(links, source):
    found, frontier = {source: 0}, [source]
    while frontier:
        following = []
        for name in frontier:
            for other in links[name] - set(found):
                found[other] = found[name] + 1
                following.append(other)
        frontier = following
    return found


@settings(deadline=None, max_examples=40)
@given(plans())
def test_paths_and_waits_equal_flooding(plan):
    """All windows begin and end at whole seconds, so half seconds stand for their cells."""
    graph = contacts(plan)
    halves = np.arange(0.5, DURATION)
    count = hops(graph, "A", "D")
    interval = np.searchsorted(graph.edges, halves) - 1
    expected = [distances(joined(plan, t), "A").get("D", np.inf) for t in halves]
    np.testing.assert_array_equal(count[interval], expected)

    through = reach(graph, "A", "D")
    assert through.share == pytest.approx(np.isfinite(expected).mean())
    assert sum(through.by_hops.values()) == pytest.approx(through.share)

    waits, lost = [], 0
    for departure in halves:
        holders = {"A"}
        for t in halves[halves >= departure]:
            for name in list(holders):
                holders |= set(distances(joined(plan, t), name))
            if "D" in holders:
                # a departure spread over its cell waits t - departure on average, or not at all
                waits.append(t - 0.5 - departure if t > departure else 0.0)
                break
        else:
            lost += 1
    found = latency(graph, "A", "D")
    assert found.undelivered == pytest.approx(lost / DURATION)
    assert found.at_once == pytest.approx(through.share)
    if waits:
        assert found.mean == pytest.approx(np.mean(waits))
        late = [w + 0.5 for w in waits if w > 0]
        assert found.longest == pytest.approx(max(late, default=0.0))
    else:
        assert np.isnan(found.mean)
        assert np.isnan(found.longest)


def test_a_message_is_carried_on():
    """A meets B, later B meets D: 8 s on from the end of the first meeting."""
    graph = contacts([link("A", "B", [0, 2]), link("B", "D", [10, 12])])
    found = latency(graph, "A", "D")
    assert found.longest == pytest.approx(10.0)
    assert found.mean == pytest.approx(9.0)
    assert found.undelivered == pytest.approx(0.9)
    assert reach(graph, "A", "D").share == 0


def test_unknown_nodes_and_empty_plans_are_refused():
    with pytest.raises(ArgumentError, match="there are no links"):
        contacts([])
    graph = contacts([link("A", "B", [0, 2])])
    with pytest.raises(ArgumentError, match="node 'Z': unknown; there are A, B"):
        hops(graph, "A", "Z")

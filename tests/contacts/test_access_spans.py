"""Interval algebra against sets of whole seconds, and figures of merit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.bodies import SOLAR_DAY
from compass.contacts.spans import all_of, any_of, at_least, fewest, outside, total
from compass.contacts.statistics import statistics

N = 40


@st.composite
def span_sets(draw):
    edges = sorted(draw(st.sets(st.integers(0, N), max_size=12)))
    return np.array(edges[: len(edges) // 2 * 2], dtype=float).reshape(-1, 2)


def cells(spans):
    """Which unit cells the spans cover."""
    covered = np.zeros(N, dtype=int)
    for a, b in spans.astype(int):
        covered[a:b] = 1
    return covered


@settings(deadline=None, max_examples=100)
@given(st.lists(span_sets(), min_size=1, max_size=5), st.integers(1, 5))
def test_counts_of_sets_are_counts_of_cells(sets, k):
    counts = sum(cells(s) for s in sets)
    np.testing.assert_array_equal(cells(at_least(k, sets)), counts >= k)
    np.testing.assert_array_equal(cells(any_of(sets)), counts >= 1)
    np.testing.assert_array_equal(cells(all_of(sets)), counts == len(sets))
    merged = any_of(sets)
    assert np.all(merged[1:, 0] > merged[:-1, 1])  # what touches is one span
    assert total(merged) == (counts >= 1).sum()
    np.testing.assert_array_equal(cells(outside(merged, float(N))), counts == 0)
    assert fewest(sets, float(N)) == counts.min()


def test_nothing_is_covered_by_nothing():
    assert any_of([]).shape == (0, 2)
    np.testing.assert_array_equal(outside(np.empty((0, 2)), 5.0), [[0.0, 5.0]])
    assert fewest([], 5.0) == 0
    with pytest.raises(ValueError, match="at least 1 set"):
        at_least(0, [])


def test_figures_of_merit():
    sol = SOLAR_DAY.value
    found = statistics(np.array([[0.0, 10.0], [30.0, 50.0]]), 2 * sol)
    assert (found.count, found.shortest, found.longest, found.mean_duration) == (2, 10, 20, 15)
    assert found.share == pytest.approx(30 / (2 * sol))
    assert found.longest_gap == pytest.approx(2 * sol - 50)
    assert found.mean_gap == pytest.approx((2 * sol - 30) / 2)
    assert found.passes_per_sol == pytest.approx(1.0)
    never = statistics(np.empty((0, 2)), 7.0)
    assert (never.count, never.share, never.longest_gap, never.longest) == (0, 0, 7, 0)
    always = statistics(np.array([[0.0, 7.0]]), 7.0)
    assert (always.share, always.longest_gap, always.mean_gap) == (1, 0, 0)

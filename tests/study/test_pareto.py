"""Fronts against the definition, crowding and choice against hand counts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from compass.study import pareto
from compass.study.pareto import best, crowding, fronts

pointsets = st.integers(1, 3).flatmap(
    lambda m: arrays(float, st.tuples(st.integers(1, 30), st.just(m)), elements=st.integers(0, 5))
)


def dominates(a, b):
    return np.all(a <= b) and np.any(a < b)


@given(pointsets)
def test_fronts_by_peeling(values):
    rank, left, front = np.full(len(values), -1), set(range(len(values))), 0
    while left:
        now = {k for k in left if not any(dominates(values[j], values[k]) for j in left)}
        rank[list(now)] = front
        left -= now
        front += 1
    assert fronts(values).tolist() == rank.tolist()


def test_fronts_agree_with_pymoo():
    sorting = pytest.importorskip("pymoo.util.nds.non_dominated_sorting")
    values = np.random.default_rng(1).random((200, 3))
    theirs = np.empty(200, int)
    for k, members in enumerate(sorting.NonDominatedSorting().do(values)):
        theirs[members] = k
    assert np.array_equal(fronts(values), theirs)


def test_fronts_of_a_long_chain_are_found_by_bisection(monkeypatch):
    asked, honest = [], pareto._dominated
    monkeypatch.setattr(pareto, "_dominated", lambda *a: asked.append(1) or honest(*a))
    values = np.random.default_rng(3).permutation(512)[:, np.newaxis].astype(float)
    assert np.array_equal(fronts(values), values[:, 0])
    assert len(asked) <= 512 * 10


def test_crowding():
    values = np.array([[0.0, 4.0], [1.0, 2.0], [4.0, 0.0], [2.0, 1.0]])
    assert crowding(values).tolist() == [np.inf, 2 / 4 + 3 / 4, np.inf, 3 / 4 + 2 / 4]
    values[2, 0] = np.inf  # as good as 2, the largest finite
    assert crowding(values)[1] == (2 - 0) / 2 + 3 / 4
    assert crowding(np.ones((3, 1))).tolist() == [np.inf, 0.0, np.inf]
    assert crowding(np.full((3, 1), np.inf)).tolist() == [np.inf, 0.0, np.inf]


def test_crowding_next_to_an_infinite_value_of_either_sign():
    column = np.array([-9.0, -7.0, -6.0, -5.0])
    for infinite, finite in ((np.inf, -5.0), (-np.inf, -9.0)):
        with_one, with_other = (np.append(column, x)[:, np.newaxis] for x in (infinite, finite))
        assert crowding(with_one).tolist() == crowding(with_other).tolist()


def test_best_takes_whole_fronts_then_the_least_crowded():
    values = np.array([[9.0, 9.0], [0.0, 4.0], [4.0, 0.0], [2.0, 2.0], [1.9, 2.1], [5.0, 5.0]])
    assert best(values, 2).tolist() == [1, 2]
    assert best(values, 5).tolist() == [1, 2, 3, 4, 5]
    assert best(values, 99).tolist() == list(range(6))
    assert best(np.empty((0, 2)), 3).tolist() == []

"""Greatest k-th nearest distance at a moment, against all its candidates in NumPy."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.nearest import FEW, _coarse_bound, covering_radius


def directions(seed, n):
    u = np.random.default_rng(seed).normal(size=(n, 3))
    return u / np.linalg.norm(u, axis=1, keepdims=True)


def twin(u, k):
    """Local maxima are equally far from three, far midpoints of two, or antipodes of one."""
    points = [-one for one in u]
    points += [-(a + b) / np.linalg.norm(a + b) for a, b in combinations(u, 2)]
    for a, b, c in combinations(u, 3):
        p = np.cross(b - a, c - a)
        points += [p / np.linalg.norm(p), -p / np.linalg.norm(p)]
    far = np.sort(np.arccos(np.clip(np.array(points) @ u.T, -1, 1)), axis=1)
    return far[:, k - 1].max()


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.integers(3, 9), st.integers(1, 4), st.floats(0, 0.3))
def test_covering_radius_and_what_is_known_about_it(seed, n, k, more):
    u, point = directions(seed, n), np.empty(3)
    found = covering_radius(u, k, 0.0, np.pi, point)
    if n < k:
        assert found == np.inf
        return
    # arc cosines near pi are good to 1e-8
    assert found == pytest.approx(twin(u, k), abs=1e-7)
    assert np.sort(np.arccos(np.clip(u @ point, -1, 1)))[k - 1] == pytest.approx(found, abs=1e-7)
    # bounds spare work and change nothing, to the last bit
    for most in (found, found + more):
        assert covering_radius(u, k, 0.0, most, point) == found
        assert covering_radius(u, k, found - 1e-3 - more, most, point) == found
    assert covering_radius(u, k, found + more + 1e-9, np.pi, point) == found + more + 1e-9


@pytest.mark.parametrize("k", [1, 3])
def test_of_many_only_those_near_one_another_are_looked_at(k):
    u, point = directions(k, FEW + 5), np.empty(3)
    assert covering_radius(u, k, 0.0, np.pi, point) == pytest.approx(twin(u, k), abs=1e-12)
    assert _coarse_bound(u, k) >= twin(u, k)

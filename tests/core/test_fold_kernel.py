"""Exact fold against the vertices of the arrangement, samples, and cases with a known answer."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.fold import (
    EVERYTHING,
    NOTHING,
    WELL,
    Sides,
    azimuth_of,
    cap_cosine,
    circle_frame,
    diamond,
    extreme_fold,
    thin_circle,
)
from compass.coverage.fold import fold_extremes


def random_caps(seed, n, equal=True):
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(n, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    radius = np.full(n, rng.uniform(0.2, 2.8)) if equal else rng.uniform(0.1, 3.0, n)
    return u, radius


def vertex_extremes(u, radius):
    """The textbook way: caps that strictly contain each vertex; a lone circle by one point."""
    c, n = np.cos(radius), len(u)
    low, high = [], []
    alone = np.ones(n, dtype=bool)
    for i, j in itertools.combinations(range(n), 2):
        g = u[i] @ u[j]
        alpha, beta = (c[i] - g * c[j]) / (1 - g * g), (c[j] - g * c[i]) / (1 - g * g)
        rest = 1 - alpha**2 - beta**2 - 2 * alpha * beta * g
        if rest <= 0:
            continue
        alone[[i, j]] = False
        for sign in (1, -1):
            step = sign * np.sqrt(rest / (1 - g * g)) * np.cross(u[i], u[j])
            p = alpha * u[i] + beta * u[j] + step
            inside = u @ p > c
            inside[[i, j]] = False
            low.append(inside.sum())
            high.append(inside.sum() + 2)
    for i in np.flatnonzero(alone):
        side = np.cross(u[i], [0.3, 0.5, 0.8])
        p = c[i] * u[i] + np.sin(radius[i]) * side / np.linalg.norm(side)
        inside = u @ p > c
        inside[i] = False
        low.append(inside.sum())
        high.append(inside.sum() + 1)
    return min(low), max(high)


def samples(n=4000, seed=0):
    p = np.random.default_rng(seed).normal(size=(n, 3))
    return p / np.linalg.norm(p, axis=1, keepdims=True)


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_equals_the_vertices(seed, equal):
    u, radius = random_caps(seed, 7, equal)
    found = fold_extremes(u, radius)
    assert (found.least, found.greatest) == (found.least_reached, found.greatest_reached)
    assert (found.least, found.greatest) == vertex_extremes(u, radius)


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 8), equal=st.booleans())
def test_no_sample_is_beyond_the_extremes(seed, n, equal):
    u, radius = random_caps(seed, n, equal)
    found = fold_extremes(u, radius)
    fold = (samples() @ u.T >= np.cos(radius)).sum(axis=1)
    assert found.least <= fold.min()
    assert found.greatest >= fold.max()


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 8))
def test_the_extremes_are_taken_on_where_they_say(seed, n):
    u, radius = random_caps(seed, n, equal=False)
    found = fold_extremes(u, radius)
    for place, fold in (
        (found.least_place, found.least),
        (found.greatest_place, found.greatest),
    ):
        assert (u @ place >= np.cos(radius)).sum() == fold


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 8))
def test_invariant_under_rotation_and_relabelling(seed, n):
    u, radius = random_caps(seed, n, equal=False)
    rng = np.random.default_rng(seed + 1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    order = rng.permutation(n)
    one, other = fold_extremes(u, radius), fold_extremes(u[order] @ turn, radius[order])
    assert (one.least, one.greatest) == (other.least, other.greatest)


def test_no_satellites():
    found = fold_extremes(np.empty((0, 3)), 1.0)
    assert (found.least, found.least_reached, found.greatest, found.greatest_reached) == (0,) * 4


@pytest.mark.parametrize(
    ("vectors", "radius", "least", "greatest"),
    [
        pytest.param([[0, 0, 1]], 1.0, 0, 1, id="one cap"),
        pytest.param([[0, 0, 1], [0, 0, -1]], 1.0, 0, 1, id="circles that do not meet"),
        pytest.param([[0, 0, 1], [0, 0, 1]], [0.5, 1.0], 0, 2, id="one cap inside another"),
        pytest.param([[0, 0, 1], [0, 0, -1]], 2.0, 1, 2, id="caps that cover the sphere"),
        pytest.param([[0, 0, 1], [0, 0, -1]], [2.0, 0.5], 0, 1, id="a complement contained"),
        pytest.param([[0, 0, 1], [0, 0, -1]], [2.5, 1.0], 1, 2, id="a complement covered"),
        pytest.param([[0, 0, 1], [1, 0, 0]], [3.2, 1.0], 1, 2, id="a cap of everything"),
        pytest.param([[0, 0, 1], [1, 0, 0]], [0.0, 1.0], 0, 1, id="an empty cap"),
        pytest.param([[0, 0, 1]], 4.0, 1, 1, id="everything, no circle"),
    ],
)
def test_known_answers(vectors, radius, least, greatest):
    found = fold_extremes(np.array(vectors, dtype=float), np.array(radius))
    assert (found.least, found.greatest) == (least, greatest)
    assert (found.least, found.greatest) == (found.least_reached, found.greatest_reached)


def test_coincident_circles():
    u = np.array([[0, 0, 1.0], [0, 0, 1.0], [1.0, 0, 0]])
    found = fold_extremes(u, np.array([1.0, 1.0, 0.4]))
    assert (found.least, found.least_reached) == (0, 0)
    assert (found.greatest, found.greatest_reached) == (2, 2)


def test_three_circles_through_one_point_err_to_the_safe_side():
    # centres at 60 deg from the pole with radius 60 deg: all three rims meet at the pole
    azimuth = np.radians([0.0, 120.0, 240.0])
    s, c = np.sin(np.pi / 3), np.cos(np.pi / 3)
    u = np.stack([s * np.cos(azimuth), s * np.sin(azimuth), np.full(3, c)], axis=1)
    found = fold_extremes(u, np.pi / 3)
    # true extremes: 0 below, 2 where two caps overlap; 3 only at the pole itself
    assert found.least == found.least_reached == 0
    assert found.greatest_reached == 2
    assert found.greatest in (2, 3)
    # a hair smaller or larger settles it
    assert fold_extremes(u, np.pi / 3 - 1e-9).greatest == 2
    assert fold_extremes(u, np.pi / 3 + 1e-9).greatest == 3


def test_bounds_enclose_the_truth_when_rims_of_a_ring_touch():
    # four caps on the equator of radius 90 deg: all rims pass through both poles
    u = np.array([[1.0, 0, 0], [0, 1.0, 0], [-1.0, 0, 0], [0, -1.0, 0]])
    found = fold_extremes(u, np.pi / 2)
    assert found.least <= 2 <= found.least_reached
    assert found.greatest_reached <= 2 <= found.greatest


def test_early_stop_is_below_the_threshold():
    u, radius = random_caps(3, 7)
    nothing = Sides(np.empty((0, 3)), np.empty(0))
    least = fold_extremes(u, radius).least
    stopped = extreme_fold(u, np.cos(radius), nothing, True, True, least + 2)[0]
    assert least <= stopped < least + 2


@pytest.mark.parametrize("parts", [0, 1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_a_thin_circle_is_one_where_the_least_fold_is_too_low(seed, parts):
    u, radius = random_caps(seed, 9, equal=False)
    cosines = np.cos(radius)
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]])[:parts]
    region = Sides(normals, np.full(2, 0.3)[:parts])
    least = extreme_fold(u, cosines, region, True, True, -1)[0]
    for k in range(least - 1, least + 3):
        for first in (WELL, -2, -1, 0, 8):
            thin = thin_circle(u, cosines, region, k, first)
            assert (thin == WELL) == (least >= k)
            if thin != WELL:
                assert -parts <= thin < 9
                assert thin_circle(u, cosines, region, k, thin) == thin


def test_caps_without_a_rim_cover_everything_or_nothing():
    u, _ = random_caps(0, 2)
    nothing, full = Sides(np.empty((0, 3)), np.empty(0)), np.full(2, EVERYTHING)
    assert thin_circle(u, full, nothing, 2, WELL) == WELL
    assert thin_circle(u, full, nothing, 3, WELL) == 2  # no circle: everywhere
    assert thin_circle(u, np.full(2, NOTHING), nothing, 1, WELL) == 2
    nowhere = Sides(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]), np.full(2, 0.5))
    assert thin_circle(u, full, nowhere, 3, WELL) == WELL


def test_shrunk_and_grown_caps():
    assert cap_cosine(0.1, -0.2) == NOTHING
    assert cap_cosine(3.0, 0.2) == EVERYTHING
    assert cap_cosine(1.0, 0.25) == pytest.approx(np.cos(1.25), abs=1e-16)


@pytest.mark.parametrize("u", [[0, 0, 1.0], [1.0, 0, 0], [0, 1.0, 0], [0.6, 0, 0.8]])
def test_frame_is_orthonormal(u):
    a, b = circle_frame(np.array(u))
    assert np.stack([a, b, u]) @ np.stack([a, b, u]).T == pytest.approx(np.eye(3), abs=1e-15)


def test_diamond_angles_rise_with_the_angle_and_come_back():
    angle = np.linspace(-np.pi, np.pi, 400)[1:]
    place = np.array([diamond(np.cos(x), np.sin(x)) for x in angle])
    slope = np.diff(place) / np.diff(angle)
    assert slope.min() > 0.49
    assert slope.max() < 1.01
    assert [azimuth_of(x) for x in place] == pytest.approx(angle, abs=1e-14)


def test_many_circles_sorted_the_other_way():
    u, radius = random_caps(11, 40)
    assert (fold_extremes(u, radius).least, fold_extremes(u, radius).greatest) == vertex_extremes(
        u, radius
    )


@pytest.mark.parametrize("gap", [1e-7, 1e-9, 1e-12, -1e-12, -1e-9, -1e-7])
def test_circles_that_barely_meet(gap):
    """Two caps that overlap or miss by a hair: the overlap counts exactly when it is there."""
    angle = 1.3 - gap
    u = np.array([[0.0, 0.0, 1.0], [np.sin(angle), 0.0, np.cos(angle)]])
    found = fold_extremes(u, 0.65)
    assert found.least == 0
    assert found.greatest_reached <= (2 if gap > 0 else 1) <= found.greatest

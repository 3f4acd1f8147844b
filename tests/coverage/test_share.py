"""Areas by fold: exact identities, known areas, samples, and the seed design's mean fold."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.area import areas_by_fold, corner
from compass.coverage.quadrature import integrate
from compass.coverage.share import fold_shares, mean_fold_shares
from compass.coverage.symmetry import Span
from compass.orbits import walker_delta


def random_caps(seed, n):
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(n, 3))
    return u / np.linalg.norm(u, axis=1, keepdims=True), rng.uniform(0.1, 3.0, n)


def test_an_octant_is_an_eighth():
    assert 2 * np.angle(corner(*np.eye(3))) == pytest.approx(np.pi / 2)
    assert 2 * np.angle(corner(*np.eye(3)[::-1])) == pytest.approx(-np.pi / 2)


def at_once(u, radius):
    """Shares at one moment."""
    u = np.reshape(u, (-1, 3))
    return fold_shares(u[None], np.broadcast_to(radius, (1, len(u))))[0]


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10**6), n=st.integers(0, 9))
def test_shares_sum_to_one_and_to_the_caps(seed, n):
    u, radius = random_caps(seed, n)
    share = at_once(u, radius)
    assert share.sum() == pytest.approx(1.0, abs=1e-12)
    assert share.min() >= -1e-12
    # every place counts each cap that covers it once: the mean fold is the caps' total area
    total = ((1 - np.cos(radius)) / 2).sum()
    assert share @ np.arange(n + 1) == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_against_samples(seed):
    u, radius = random_caps(seed, 6)
    p = np.random.default_rng(9).normal(size=(40000, 3))
    p /= np.linalg.norm(p, axis=1, keepdims=True)
    fold = (p @ u.T >= np.cos(radius)).sum(axis=1)
    # five standard deviations of a share of at most one half
    assert at_once(u, radius) == pytest.approx(
        np.bincount(fold, minlength=7) / fold.size, abs=5 * 0.5 / 200
    )


def test_known_areas():
    assert at_once([[0, 0, 1.0], [0, 0, -1.0]], np.pi / 3) == pytest.approx([0.5, 0.5, 0.0])
    # three right angles: the octants of three hemispheres
    assert at_once(np.eye(3), np.pi / 2) == pytest.approx([1 / 8, 3 / 8, 3 / 8, 1 / 8])
    assert at_once([[0, 0, 1.0], [1.0, 0, 0]], [4.0, 0.0]) == pytest.approx([0, 1.0, 0])


@pytest.mark.parametrize("apart", [0.0, 1e-16, 1e-13, 1e-12])
def test_caps_that_coincide_count_each(apart):
    # three satellites in one place and one elsewhere, whose rims cross
    u = np.array([[0, 0, 1.0], [apart, 0, 1.0], [0.8, 0, 0.6], [0, -apart, 1.0]])
    one = at_once(u[[0, 2]], 0.7)
    both = 1 - np.cos(0.7) - one[1:].sum()  # inclusion and exclusion: two caps less their union
    assert one[2] == pytest.approx(both, abs=1e-12)
    single = (1 - np.cos(0.7)) / 2 - both
    expected = [one[0], single, 0, single, both]
    assert at_once(u, 0.7) == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("width", [1e-7, 1e-10, 0.0])
def test_a_hole_that_rounds_to_nothing_leaves_the_rest_whole(width):
    # three great circles cut the sphere in octants, a fourth cap covers all but a speck of it
    u = np.array([*np.eye(3), [0.6, 0.48, 0.64]])
    areas = areas_by_fold(u, np.array([0.0, 0.0, 0.0, -np.cos(width)]))
    eighth = np.pi / 2
    full = 4 * np.pi
    assert areas == pytest.approx([full, full, 7 * eighth, 4 * eighth, eighth], abs=1e-11)


def test_the_quadrature_is_exact_for_polynomials_and_finds_bends():
    powers = np.arange(23)
    share, error = integrate(lambda t: t[:, np.newaxis] ** powers, 1e-12)
    assert share == pytest.approx(1 / (powers + 1), abs=1e-15)
    assert error < 1e-12
    bends = np.array([0.1, 0.37, 1 / 3])
    share, error = integrate(lambda t: np.sqrt(np.abs(t[:, np.newaxis] - bends)), 1e-7)
    exact = 2 / 3 * (bends**1.5 + (1 - bends) ** 1.5)
    assert np.abs(share - exact).max() < error < 1e-7


@pytest.mark.slow
def test_mean_fold_of_the_seed_design():
    # 15 caps of 41.687 % (specification, section 1)
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    found = mean_fold_shares(c, sphere_radius=3396.2e3)
    assert found.share @ np.arange(16) == pytest.approx(15 * 0.416870, abs=2e-5)
    assert found.share.nonzero()[0].tolist() == [4, 5, 6, 7, 8, 9]
    assert found.error < 2e-6
    times = np.linspace(0, 88642.0, 301)[:-1]
    sampled = np.mean(
        [
            mean_fold_shares(c, sphere_radius=3396.2e3, span=Span(t, t, False, "")).share
            for t in times
        ],
        axis=0,
    )
    assert found.share == pytest.approx(sampled, abs=2e-4)


def test_shares_over_time_sum_to_one():
    c = walker_delta(4, 2, 1, inclination_deg=57.3, radius_km=20428)
    found = mean_fold_shares(c, sphere_radius=3396.2e3, tolerance=1e-2)
    assert found.share.sum() == pytest.approx(1.0, abs=1e-9)
    cap = np.arccos(3396.2 / 20428)
    assert found.share @ np.arange(5) == pytest.approx(4 * (1 - np.cos(cap)) / 2, abs=1e-9)

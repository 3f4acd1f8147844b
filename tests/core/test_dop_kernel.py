import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core import dop, gdop
from compass.core.dop import dop_over_time, dop_series
from compass.core.gdop import dops_over
from compass.core.runs import ALL_AROUND, Row

EPS = np.finfo(float).eps


def twin(sights, up):
    """Dilution of precision by inverting the normal matrix of [u, 1]."""
    g = np.column_stack([sights, np.ones(len(sights))])
    q = np.linalg.inv(g.T @ g)
    position = q[:3, :3]
    v2 = up @ position @ up
    p2 = np.trace(position)
    return np.sqrt([p2 + q[3, 3], p2, p2 - v2, v2, q[3, 3]])


def series(sights, up=(0.0, 0.0, 1.0), visible=None):
    n = len(sights)
    counts, out = np.empty(1, np.int16), np.empty((5, 1))
    seen = np.ones((n, 1), bool) if visible is None else visible
    dop_series(np.ascontiguousarray(sights[:, None, :]), seen, np.array(up), counts, out)
    return int(counts[0]), out[:, 0]


def random_sights(seed, n):
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(n, 3))
    return u / np.linalg.norm(u, axis=1, keepdims=True)


@settings(max_examples=200)
@given(st.integers(0, 10**6), st.integers(4, 12))
def test_closed_form_equals_matrix_inverse(seed, n):
    sights, up = random_sights(seed, n), random_sights(seed + 1, 1)[0]
    count, found = series(sights, up)
    expected = twin(sights, up)
    assert count == n
    # both lose digits like the condition number, about PDOP^2 n
    np.testing.assert_allclose(found, expected, rtol=1e-13 * n * max(expected[0], 1) ** 2)


@settings(max_examples=50)
@given(st.integers(0, 10**6), st.integers(0, 10**6))
def test_gdop_does_not_depend_on_the_frame_and_more_satellites_help(seed, turn):
    sights = random_sights(seed, 7)
    q, _ = np.linalg.qr(np.random.default_rng(turn).normal(size=(3, 3)))
    _, found = series(sights)
    _, turned = series(sights @ q.T)
    _, fewer = series(sights[:6])
    np.testing.assert_allclose(turned[[0, 1, 4]], found[[0, 1, 4]], rtol=1e-9)
    assert np.all(fewer[[0, 1, 4]] >= found[[0, 1, 4]] * (1 - 1e-9))


def test_regular_tetrahedron_has_the_least_gdop_of_four():
    u = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    _, found = series(u)
    # S = (4/3) I, s = 0: PDOP^2 = 9/4, TDOP^2 = 1/4
    np.testing.assert_allclose(found, np.sqrt([2.5, 2.25, 1.5, 0.75, 0.25]), rtol=1e-14)


def test_fewer_than_four_is_infinite():
    count, found = series(random_sights(3, 3))
    assert count == 3
    assert np.all(np.isinf(found))


def test_satellites_on_a_cone_are_singular_and_give_infinity_without_a_warning():
    azimuth = np.linspace(0, 2 * np.pi, 7)[:-1]
    for height in (0.0, 0.3, 0.8):
        flat = np.sqrt(1 - height**2)
        cone = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.full(6, height)])
        assert np.all(np.isinf(series(cone)[1]))


def test_satellites_out_of_view_do_not_count():
    sights = random_sights(5, 8)
    seen = np.array([True] * 5 + [False] * 3)[:, None]
    count, found = series(sights, visible=seen)
    assert count == 5
    np.testing.assert_allclose(found, twin(sights[:5], np.array([0, 0, 1.0])), rtol=1e-10)


def test_limit_of_singularity_is_far_from_useful_geometry():
    # four satellites nearly on a cone: PDOP grows like 1/height until it is called infinite
    for height, expected_inf in ((1e-4, False), (1e-9, True)):
        azimuth = np.array([0, 0.5, 1.0, 1.5]) * np.pi
        u = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(4)])
        u[0, 2], u[2, 2] = height, height
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        pdop = series(u)[1][1]
        assert np.isinf(pdop) == expected_inf
        if not expected_inf:
            assert pdop == pytest.approx(twin(u, np.array([0, 0, 1.0]))[1], rel=1e-4)


def exact_gdop(sights):
    """GDOP in forty digits."""
    from mpmath import mp, mpf, sqrt

    with mp.workdps(40):
        g = mp.matrix([[*map(mpf, u), 1] for u in sights.tolist()])
        q = (g.T * g) ** -1
        return float(sqrt(sum(q[k, k] for k in range(4))))


@pytest.mark.parametrize("height", [1e-1, 1e-3, 1e-5, 3e-6])
def test_rounding_stays_below_what_is_claimed_of_it(height):
    """The relative error is at most about ``eps PDOP^2 n``, up to the edge of singularity."""
    turn = np.radians([3, 80, 160, 250, 310])
    for k in range(20):
        u = np.column_stack([np.cos(turn + k), np.sin(turn + k), np.full(5, 0.3)])
        u[:, 2] += height * np.random.default_rng(k).normal(size=5)
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        _, found = series(u)
        assert found[0] == pytest.approx(exact_gdop(u), rel=10 * EPS * found[1] ** 2 * 5)


@pytest.mark.parametrize("satellites", [4, 9])
def test_row_and_scattered_places_round_as_little(satellites):
    """Two kernels with moments summed in different ways agree to the rounding of their input.

    A sight of a user at the surface is off by ``2 eps``, which S turns into ``eps PDOP^2 n``.
    """
    rng = np.random.default_rng(satellites)
    r = rng.normal(size=(3, satellites, 3))
    r[..., 0] = np.abs(r[..., 0]) + 2.0
    lon = 2 * np.pi * np.arange(14) / 14 - np.pi
    place = np.column_stack([np.cos(lon), np.sin(lon), np.zeros(14)])
    cos_cap = 1.0 / np.linalg.norm(r, axis=-1)  # no mask
    counts, out = np.empty((3, 14), np.int16), np.empty((3, 5, 14))
    one, stand = np.zeros(1), np.array([1.0, 0.0, 1.0, 0.0, 1.0])
    row = Row(one, one, stand, np.cos(lon), np.sin(lon), lon[0], ALL_AROUND)
    dop_over_time(r, cos_cap, row, counts, out)
    fold, found, pdop = np.empty((3, 14), np.int64), np.empty((3, 14)), np.empty((3, 14))
    dops_over(r, place, 1.0, 0.0, fold, found, pdop)
    np.testing.assert_array_equal(fold, counts)
    finite = np.isfinite(found)
    assert finite.sum() > 6
    np.testing.assert_array_equal(finite, np.isfinite(out[:, 0]))
    error = np.abs(found[finite] / out[:, 0][finite] - 1)
    assert np.all(error <= 10 * EPS * satellites * pdop[finite] ** 2)


def test_no_sum_is_reordered_where_rounding_is_accounted_for():
    for module in (dop, gdop):
        for name, compiled in vars(module).items():
            options = getattr(compiled, "targetoptions", {})
            assert options.get("fastmath", False) in (False, {"contract"}), name

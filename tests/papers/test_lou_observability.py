"""Observability with accelerometers: check values, and exact rank 7 in extended precision."""

import mpmath
import numpy as np
import pytest

from compass.entry.views import cartesian_of, spherical_jacobian
from compass.papers import lou2019_case as paper
from compass.papers.lou_observability import (
    imu_range_matrix,
    observability_degree,
    rotation_about_beacon,
    singular_values,
)

CASE = paper.case()
STILL = np.zeros((4, 3))


@pytest.mark.parametrize(("k", "expected"), [(0, 2.65087354e-10), (100, 1.68318104e-7)])
def test_degree_of_all_measurements(k, expected):
    # the check values take rho0 itself as state and hold the beacons still
    matrix = imu_range_matrix(CASE.truth, CASE.nominal[k], CASE.beacons.r[k], STILL)
    matrix[:, 6] /= paper.DENSITY
    assert observability_degree(matrix) == pytest.approx(expected, rel=2e-9)


@pytest.mark.parametrize("k", [0, 60, 150])
def test_a_lone_beacon_cannot_see_the_turn_about_it(k):
    for i in range(2):
        beacon = CASE.beacons.r[k, i]
        matrix = imu_range_matrix(CASE.truth, CASE.nominal[k], beacon[None], STILL[:1], bank=0.4)
        turn = rotation_about_beacon(CASE.nominal[k], beacon)
        # rows are gradients in axes, read in angles: their rounding is that of the axes
        view = np.eye(8)
        view[:6, :6] = spherical_jacobian(cartesian_of(CASE.nominal[k]))
        size = np.abs(matrix @ np.linalg.inv(view)) @ np.abs(view) @ np.abs(turn)
        assert np.all(np.abs(matrix @ turn) <= 1e-12 * size)


def test_two_beacons_see_everything():
    matrix = imu_range_matrix(CASE.truth, CASE.nominal[100], CASE.beacons.r[100, :2], STILL[:2])
    values, _ = singular_values(matrix * 1.0)
    lone, _ = singular_values(
        imu_range_matrix(CASE.truth, CASE.nominal[100], CASE.beacons.r[100, :1], STILL[:1])
    )
    assert values[-1] > 1e6 * lone[-1]


def test_an_orbiting_beacon_is_carried_along_its_orbit():
    still = imu_range_matrix(CASE.truth, CASE.nominal[0], CASE.beacons.r[0, 2:3], STILL[:1])
    moving = imu_range_matrix(
        CASE.truth, CASE.nominal[0], CASE.beacons.r[0, 2:3], CASE.beacons.v[0, 2:3]
    )
    assert np.array_equal(still[:4], moving[:4])
    assert not np.allclose(still[7], moving[7])


# Truncated Taylor series with gradients in extended precision: a list of rows, each the
# coefficient and its eight partial derivatives.


def _product(a, b, k):
    """Row k of a b."""
    out = [mpmath.mpf(0)] * 9
    for i in range(k + 1):
        left, right = a[i], b[k - i]
        out[0] += left[0] * right[0]
        for q in range(1, 9):
            out[q] += left[0] * right[q] + left[q] * right[0]
    return out


def _scaled(row, factor):
    return [factor * value for value in row]


def _sum(*rows):
    return [sum(values) for values in zip(*rows, strict=True)]


def _sine_cosine(a, s, c, k):
    """Append row k of sin a and cos a."""
    if k == 0:
        value = a[0][0]
        s.append([mpmath.sin(value)] + [mpmath.cos(value) * d for d in a[0][1:]])
        c.append([mpmath.cos(value)] + [-mpmath.sin(value) * d for d in a[0][1:]])
        return
    weighted = [_scaled(a[j], mpmath.mpf(j) / k) for j in range(k + 1)]
    s.append(_sum(*(_one(weighted[j], c[k - j]) for j in range(1, k + 1))))
    c.append(_scaled(_sum(*(_one(weighted[j], s[k - j]) for j in range(1, k + 1))), -1))


def _one(left, right):
    """Product of two rows as dual numbers."""
    return [left[0] * right[0]] + [left[0] * right[q] + left[q] * right[0] for q in range(1, 9)]


def _exponential(a, out, k):
    if k == 0:
        value = mpmath.exp(a[0][0])
        out.append([value] + [value * d for d in a[0][1:]])
        return
    out.append(_sum(*(_scaled(_one(a[j], out[k - j]), mpmath.mpf(j) / k) for j in range(1, k + 1))))


def _inverse(a, out, k):
    """Append row k of 1/a."""
    total = [mpmath.mpf(1 if k == 0 else 0)] + [mpmath.mpf(0)] * 8
    for i in range(1, k + 1):
        total = _sum(total, _scaled(_one(a[i], out[k - i]), -1))
    value = total[0] / a[0][0]
    out.append([value] + [(total[q] - value * a[0][q]) / a[0][0] for q in range(1, 9)])


def _root(a, out, k):
    """Append row k of sqrt(a)."""
    if k == 0:
        value = mpmath.sqrt(a[0][0])
        out.append([value] + [d / (2 * value) for d in a[0][1:]])
        return
    total = a[k]
    for i in range(1, k):
        total = _sum(total, _scaled(_one(out[i], out[k - i]), -1))
    value = total[0] / (2 * out[0][0])
    out.append([value] + [(total[q] / 2 - value * out[0][q]) / out[0][0] for q in range(1, 9)])


def extended_matrix(x0, beacon, orders, bank):
    """The observability matrix of drag, side force, lift and one range, in mpmath."""
    mu, r0, h, b = map(mpmath.mpf, ("4.282829e13", "3437.2e3", "7500", "0.016"))
    x = [
        [[mpmath.mpf(float(value))] + [mpmath.mpf(int(i == q)) for q in range(8)]]
        for i, value in enumerate(x0)
    ]
    r, lon, lat, v, gamma, psi, ln_rho, kappa = x
    names = "slon clon slat clat sg cg sp cp log rho drag lift ir iv icl icg px py pz sq range"
    w = {name: [] for name in names.split()}
    cb, sb = mpmath.cos(bank), mpmath.sin(bank)
    products = {}

    def grown(name, a, c, k):
        """Row k of the product a c, kept for later products."""
        products.setdefault(name, []).append(_product(a, c, k))
        return products[name]

    for k in range(orders + 1):
        _sine_cosine(lon, w["slon"], w["clon"], k)
        _sine_cosine(lat, w["slat"], w["clat"], k)
        rcl = grown("rcl", r, w["clat"], k)
        w["px"].append(_product(rcl, w["clon"], k))
        w["py"].append(_product(rcl, w["slon"], k))
        w["pz"].append(_product(r, w["slat"], k))
        for name, value in zip(("px", "py", "pz"), beacon, strict=True):
            if k == 0:
                w[name][0][0] -= mpmath.mpf(float(value))
        w["sq"].append(_sum(*(_product(w[n], w[n], k) for n in ("px", "py", "pz"))))
        _root(w["sq"], w["range"], k)
        if k == orders:
            break
        _sine_cosine(gamma, w["sg"], w["cg"], k)
        _sine_cosine(psi, w["sp"], w["cp"], k)
        w["log"].append(_sum(ln_rho[k], _scaled(r[k], -1 / h)))
        if k == 0:
            w["log"][0][0] += r0 / h
        _exponential(w["log"], w["rho"], k)
        vv = grown("vv", v, v, k)
        w["drag"].append(_scaled(_product(w["rho"], vv, k), b / 2))
        w["lift"].append(_product(kappa, w["drag"], k))
        _inverse(r, w["ir"], k)
        _inverse(v, w["iv"], k)
        _inverse(w["clat"], w["icl"], k)
        _inverse(w["cg"], w["icg"], k)
        vr = grown("vr", v, w["ir"], k)
        irr = grown("irr", w["ir"], w["ir"], k)
        cgsp = grown("cgsp", w["cg"], w["sp"], k)
        cgcp = grown("cgcp", w["cg"], w["cp"], k)
        vrcgsp = grown("vrcgsp", vr, cgsp, k)
        tan = grown("tan", w["slat"], w["icl"], k)
        gv = grown("gv", irr, w["iv"], k)
        turn = products.setdefault("turn", [])
        turn.append(_sum(vr[k], _scaled(gv[k], -mu)))
        lv = grown("lv", w["lift"], w["iv"], k)
        rates = [
            _product(v, w["sg"], k),
            _product(vrcgsp, w["icl"], k),
            _product(vr, cgcp, k),
            _sum(_scaled(w["drag"][k], -1), _scaled(_product(irr, w["sg"], k), -mu)),
            _sum(_product(turn, w["cg"], k), _scaled(lv[k], cb)),
            _sum(_product(vrcgsp, tan, k), _scaled(_product(lv, w["icg"], k), sb)),
            [mpmath.mpf(0)] * 9,
            [mpmath.mpf(0)] * 9,
        ]
        for state, rate in zip(x, rates, strict=True):
            state.append(_scaled(rate, mpmath.mpf(1) / (k + 1)))
    rows = []
    for k in range(orders):
        f = mpmath.factorial(k)
        rows.append(_scaled(w["drag"][k][1:], -f))
        rows.append(_scaled(w["lift"][k][1:], -f * sb))
        rows.append(_scaled(w["lift"][k][1:], f * cb))
        rows.append(_scaled(w["range"][k][1:], f))
    return mpmath.matrix(rows)


@pytest.mark.parametrize("bank", [0.0, 0.3])
def test_a_lone_beacon_gives_rank_exactly_seven(bank):
    state, beacon = CASE.nominal[100], CASE.beacons.r[100, 0]
    with mpmath.workdps(60):
        matrix = extended_matrix(state, beacon, 8, mpmath.mpf(bank))
        # the same matrix as in double precision
        double = imu_range_matrix(CASE.truth, state, beacon[None], STILL[:1], bank=bank)
        shown = np.array(matrix.tolist(), dtype=float)
        scale = np.abs(double).max(axis=1, keepdims=True) + 1e-300
        assert np.abs((shown - double) / scale).max() < 1e-8
        units = [1e3, 3e-4, 3e-4, 10.0, 3e-3, 3e-3, 0.1, 0.02]
        scaled = matrix * mpmath.diag([mpmath.mpf(u) for u in units])
        values = mpmath.svd_r(scaled, compute_uv=False)
        assert values[7] / values[0] < mpmath.mpf(10) ** -50
        assert values[6] / values[0] > mpmath.mpf(10) ** -15
        # null vector: solve by the smallest eigenvector of the normal matrix, by one inverse step
        normal = scaled.T * scaled + mpmath.mpf(10) ** -70 * mpmath.eye(8)
        null = mpmath.lu_solve(normal, mpmath.matrix([1] * 8))
        found = np.array([float(null[i] / mpmath.norm(null) * units[i]) for i in range(8)])
    turn = rotation_about_beacon(state, beacon)
    found *= turn[1] / found[1]
    np.testing.assert_allclose(found, turn, rtol=1e-10, atol=1e-10)

"""What a lander measures, against the check values and against differences."""

import numpy as np
import pytest

from compass.core.papers.lou_measurement import predict_measurements, surface_density
from compass.core.papers.spherical import DRAG, rk4_step
from compass.papers import lou2019_case as paper
from compass.papers.spherical import spherical_parameters

X = np.array([3450e3, 0.1, 0.2, 5000.0, -0.2, 0.3, np.log(2e-4), 0.156, 0.01, -0.02, 0.03])
P = np.array([4.282829e13, 3437.2e3, 7500.0, 0.016, 0.3, 0.0, 0.0])
BEACONS = np.array([[3300e3, 420e3, 1350e3], [7855.7e3, -461.8e3, 749.82e3]])


def measure(x, n, linear=False, p=P, beacons=BEACONS):
    h, slopes = np.empty(3 + len(beacons)), np.empty((3 + len(beacons), n))
    predict_measurements(x, n, p, linear, beacons, h, slopes)
    return h, slopes


def test_range_of_the_check_case():
    assert measure(X, 8)[0][3] == pytest.approx(672767.920257521, rel=1e-14)


def test_drag_is_what_slows_the_lander():
    h, _ = measure(X, 8)
    drag = 0.5 * 2e-4 * np.exp((3437.2e3 - 3450e3) / 7500) * 0.016 * 5000.0**2
    assert h[0] == pytest.approx(-drag, rel=1e-13)
    np.testing.assert_allclose(
        h[1:3], 0.156 * drag * np.array([-np.sin(0.3), np.cos(0.3)]), rtol=1e-13
    )


def test_measurements_one_second_after_entry():
    case = paper.case()
    x = np.empty(8)
    rk4_step(case.nominal[0], spherical_parameters(case.truth), 1.0, x)
    h, _ = measure(x, 8, p=spherical_parameters(case.truth), beacons=case.beacons.r[1])
    # half a unit of the last printed digit (1e-5 m); the orbiters move as two bodies do
    assert -h[0] == pytest.approx(0.00115374015396, rel=1e-11)
    expected = [1425175.20592, 968423.149838, 4426006.24234, 3665089.10536]
    np.testing.assert_allclose(h[3:], expected, rtol=0, atol=5.1e-6)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("n", [6, 8, 11])
def test_derivatives_are_those_of_the_measurements(n, linear):
    x = X.copy() if n == 11 else X[:8].copy()
    if linear:
        x[6] = 2e-4
    h, slopes = measure(x, n, linear)
    # central differences: truncation (3.45 m / 7500 m)^2 / 6 = 4e-8 at most, rounding below 1e-8
    for j in range(n):
        step = 1e-6 * max(abs(x[j]), 1e-2) if not (linear and j == 6) else 1e-9
        ahead, behind = x.copy(), x.copy()
        ahead[j] += step
        behind[j] -= step
        difference = (measure(ahead, n, linear)[0] - measure(behind, n, linear)[0]) / (2 * step)
        size = np.abs(slopes[:, j]) + 1e-9 * np.abs(h) / max(abs(x[j]), 1e-2)
        assert np.all(np.abs(slopes[:, j] - difference) <= 1e-7 * size + 1e-12)


def test_only_biased_filters_see_a_bias():
    np.testing.assert_allclose(measure(X, 11)[0][:3] - measure(X[:8], 8)[0][:3], X[8:], atol=1e-15)
    np.testing.assert_array_equal(measure(X, 11)[1][:3, 8:], np.eye(3))


def test_density_is_carried_either_way():
    assert surface_density(X, False) == pytest.approx(2e-4)
    assert surface_density(np.full(8, 3e-4), True) == 3e-4
    assert P[DRAG] == 0.016

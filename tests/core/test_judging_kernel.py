import numpy as np
import pytest

from compass.core.judging import between, sight
from compass.entry.beacons import orbiting_beacons
from compass.orbits import from_elements, states_mci

R = 3396.19e3


@pytest.mark.parametrize("radius", [3696e3, 20428e3])
def test_interpolation_is_as_good_as_its_docstring_says(radius):
    c = from_elements(radius, 0.0, 0.7, 0.4, 0.0, 1.0)
    step, times = 30.0, np.linspace(0.0, 90.0, 37)
    omega = 7.0882e-5

    def fixed(t):
        b = orbiting_beacons(*states_mci(c, t), t, omega=omega, angle=0.3, planet_radius=R)
        return np.concatenate([b.r[:, 0], b.v[:, 0]], axis=1)

    node, exact = fixed(step * np.arange(4)), fixed(times)
    found = np.empty((times.size, 6))
    for k, t in enumerate(times):
        between(node, t, step, found[k])
    rate = c.mean_motion[0] + omega  # the turning axes add theirs
    limit = (step * rate) ** 4 * radius / 384
    # rounding of coordinates of 2e7 m and of their interpolation
    assert np.abs(found[:, :3] - exact[:, :3]).max() <= limit + 1e-7
    # the derivative of the interpolation error: h^3 f''''/(72 sqrt 3), doubled for good measure
    assert np.abs(found[:, 3:] - exact[:, 3:]).max() <= 2 * limit * 384 / (72 * 3**0.5 * step)
    assert found[[0, 12, 24], :3] == pytest.approx(exact[[0, 12, 24], :3], abs=1e-7)


@pytest.mark.parametrize("mask_deg", [0.0, 10.0])
def test_in_view_at_the_mask_above_the_limb(mask_deg):
    lander, mask = np.zeros(6), np.radians(mask_deg)
    lander[0] = R + 100e3
    dip = np.arccos(R / lander[0])
    line = np.empty(5)
    for over in (-1e-6, 1e-6):
        elevation = mask - dip + over
        satellite = np.zeros(6)
        satellite[:3] = lander[:3] + 1.7e7 * np.array([np.sin(elevation), np.cos(elevation), 0])
        assert sight(lander, satellite, R, np.sin(mask), np.cos(mask), line) == (over > 0)
        assert line[3] == pytest.approx(1.7e7)

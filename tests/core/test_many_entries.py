import numpy as np
import pytest

from compass.core.entry.information import hermite, horizon
from compass.entry.beacons import orbiting_beacons
from compass.orbits import keplerian, states_mci

R = 3396.19e3


@pytest.mark.parametrize("radius", [3696e3, 20428e3])
def test_interpolation_is_as_good_as_its_docstring_says(radius):
    c = keplerian(radius, 0.0, 0.7, 0.4, 0.0, 1.0)
    step, times = 30.0, np.linspace(0.0, 90.0, 37)
    omega = 7.0882e-5

    def fixed(t):
        b = orbiting_beacons(*states_mci(c, t), t, omega=omega, angle=0.3, planet_radius=R)
        return np.concatenate([b.r[:, 0], b.v[:, 0]], axis=1)

    node, exact = fixed(step * np.arange(4)), fixed(times)
    found, w = np.empty((times.size, 6)), np.empty(6)
    for k, t in enumerate(times):
        left = min(int(t / step), 2)
        a, b = node[left], node[left + 1]
        hermite(t / step - left, step, w)
        found[k, :3] = a[:3] + w[0] * (b - a)[:3] + w[1] * a[3:] + w[2] * b[3:]
        found[k, 3:] = w[3] * (b - a)[:3] + w[4] * a[3:] + w[5] * b[3:]
    rate = c.mean_motion[0] + omega  # the turning axes add theirs
    limit = (step * rate) ** 4 * radius / 384
    # rounding of coordinates of 2e7 m and of their interpolation
    assert np.abs(found[:, :3] - exact[:, :3]).max() <= limit + 1e-7
    # the derivative of the interpolation error: h^3 f''''/(72 sqrt 3), doubled for good measure
    assert np.abs(found[:, 3:] - exact[:, 3:]).max() <= 2 * limit * 384 / (72 * 3**0.5 * step)
    assert found[[0, 12, 24], :3] == pytest.approx(exact[[0, 12, 24], :3], abs=1e-7)


@pytest.mark.parametrize("height", [0.0, 100e3])
def test_horizon_of_a_lander_touches_the_sphere(height):
    lander = (0.0, R + height, 0.0)
    high, lowest = horizon(*lander, R, 0.0, 1.0)
    assert high == R + height
    # the line of sight at that elevation passes at distance r cos(elevation) = R
    assert high * np.sqrt(1 - lowest**2) == pytest.approx(R, rel=1e-12)
    mask = np.radians(10)
    _, raised = horizon(*lander, R, np.sin(mask), np.cos(mask))
    assert np.arcsin(raised) == pytest.approx(np.arcsin(lowest) + mask)

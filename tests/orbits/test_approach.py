"""Closest approaches to the moons against brute force, and where they are known."""

import numpy as np
import pytest

from compass.core.motion import states
from compass.moons import moon_row
from compass.orbits.approach import GOOD, closest_approaches
from compass.orbits.constellation import keplerian
from compass.orbits.motion import Motion

DAY = 86400.0


def two():
    return keplerian(
        [2.0e7, 2.4e7], [0.0, 0.02], [0.8, 0.3], [0.1, 1.0], 0.0, [0.0, 2.0], epoch=9e8
    )


@pytest.mark.slow
def test_they_are_the_least_of_a_fine_sampling():
    path = Motion().trajectory(two(), 0.0, 3 * DAY)
    times = np.arange(0.5 * DAY, 3 * DAY, 10.0)
    r = path.states(times)[0]
    for found in closest_approaches(path, 0.5 * DAY, 3 * DAY):
        row = moon_row(found.moon, path.epoch, 1.75 * DAY)
        apart = np.linalg.norm(r - states(row, np.zeros((1, 6)), times)[:, :3], axis=-1)
        # in ten seconds a distance changes by less than 40 km at 4 km/s, at its least by far less
        assert found.distance == pytest.approx(apart.min(), abs=GOOD + 50.0)
        assert found.satellite == path.satellite_names[int(apart.min(axis=1).argmin())]
        there = path.states([found.time])[0][path.satellite_names.index(found.satellite), 0]
        moon = states(row, np.zeros((1, 6)), np.array([found.time]))[0, :3]
        assert np.linalg.norm(there - moon) == pytest.approx(found.distance, abs=1e-3)


def test_a_satellite_that_follows_a_moon_meets_it_at_the_moons_own_distance():
    """A satellite where Deimos will be, on its ellipse: its distance there is next to nothing."""
    from compass.orbits.states import from_states

    row = moon_row("deimos", 9e8, 0.5 * DAY)
    there = states(row, np.zeros((1, 6)), np.array([0.4 * DAY]))[0]
    c = from_states(there[None, :3], 1.02 * there[None, 3:], epoch=9e8 + 0.4 * DAY)
    path = Motion().trajectory(c, -0.4 * DAY, 0.4 * DAY)
    _, deimos = closest_approaches(path, -0.4 * DAY, 0.4 * DAY)
    assert deimos.moon == "deimos"
    assert (
        deimos.distance < 60e3
    )  # the row is fitted to another middle, the pole's frame to another epoch
    assert abs(deimos.time) < 600.0

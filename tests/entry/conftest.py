"""The chapter's world (Yu et al. 2018) and its two flights, shared by the entry tests."""

import numpy as np
import pytest

from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import orbiting_beacons, surface_beacons
from compass.entry.model import EntryModel
from compass.entry.state import state_from_cartesian
from compass.entry.trajectory import fly
from compass.entry.vehicle import Vehicle
from compass.orbits import keplerian, states_mci

GM, RADIUS, OMEGA = 4.282829e13, 3397.2e3, 7.088218e-5


@pytest.fixture(scope="session")
def world():
    """Make the chapter's model with any terms of the rotation."""

    def make(rotation="coriolis", **vehicle):
        craft = Vehicle(0.016, 0.156, **vehicle)
        return EntryModel(craft, Atmosphere(2e-4, 3437.2e3, 7500.0), rotation, GM, RADIUS, OMEGA)

    return make


@pytest.fixture(scope="session")
def table2():
    """Start of Table 2, heading turned from east to north."""
    lon, lat, gamma, heading = np.radians([-89.872, -28.02, -11.8, 5.156])
    return np.array([3518.2e3, lon, lat, 5515.0, gamma, np.pi / 2 - heading])


@pytest.fixture(scope="session")
def table5():
    return state_from_cartesian(
        np.array([-3.92, -3103.37, -1665.41]) * 1e3, [5775.31, 1124.27, 1175.48]
    )


@pytest.fixture(scope="session")
def ground_flight(world, table2):
    return fly(world(), table2, np.arange(241.0))


@pytest.fixture(scope="session")
def ground_beacons(ground_flight):
    lat, lon = np.radians([[-25.8, -82.7], [-28.6, -82.2], [-25.6, -73.4]]).T
    return surface_beacons(lat, lon, ground_flight.times, planet_radius=RADIUS)


@pytest.fixture(scope="session")
def orbiter_flight(world, table5):
    return fly(world(), table5, np.arange(241.0))


@pytest.fixture(scope="session")
def orbiter_beacons():
    """Make Table 6's orbiters over 240 s under a planet turning at `omega`."""
    node, inclination, anomaly = np.radians(
        [[49.329, 16.136, 36.562], [24.209, 35.889, 18.901], [240.219, 256.141, 229.294]]
    )

    def make(omega=OMEGA):
        times = np.arange(241.0)
        orbits = keplerian(RADIUS + 725e3, 0, inclination, node, 0, anomaly, gm=GM)
        r, v = states_mci(orbits, times)
        return orbiting_beacons(r, v, times, omega=omega, planet_radius=RADIUS)

    return make

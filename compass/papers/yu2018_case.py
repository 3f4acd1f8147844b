"""What Yu et al. 2018 fly and by what: their world, both flights, their beacons."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import Beacons, orbiting_beacons, surface_beacons
from compass.entry.model import EntryModel, Rotation
from compass.entry.state import state_from_cartesian
from compass.entry.trajectory import Trajectory, fly
from compass.entry.vehicle import Vehicle
from compass.orbits import keplerian, states_mci

GM, RADIUS, OMEGA = 4.282829e13, 3397.2e3, 7.088218e-5
ALTITUDE = 725e3
TIMES = np.arange(241.0)
RUNS = 500

#: Beacons that follow the chapter's words on Figure 4, which prints no numbers, degrees.
WORDS_OF_FIGURE_4 = ((-25.8, -82.7), (-28.6, -82.2), (-25.6, -73.4))

TABLE_6 = np.radians(
    [[49.329, 24.209, 240.219], [16.136, 35.889, 256.141], [36.562, 18.901, 229.294]]
)
NOT_PRINTED = "the chapter prints neither C_D S/m nor L/D; those of its companion papers are used"


def at(seconds: float) -> int:
    """Index of a time."""
    return int(np.searchsorted(TIMES, seconds))


def model(rotation: Rotation = "coriolis", lift_to_drag: float = 0.156) -> EntryModel:
    """Return the chapter's world; what it does not print is from Lou et al. 2019."""
    air = Atmosphere(2e-4, 3437.2e3, 7500.0)
    return EntryModel(
        vehicle=Vehicle(0.016, lift_to_drag),
        atmosphere=air,
        rotation=rotation,
        gm=GM,
        planet_radius=RADIUS,
        rotation_rate=OMEGA,
    )


def table_2() -> NDArray[np.float64]:
    """Start of the ground case, heading turned from east to north."""
    lon, lat, gamma, heading = np.radians([-89.872, -28.02, -11.8, 5.156])
    return np.array([3518.2e3, lon, lat, 5515.0, gamma, np.pi / 2 - heading])


def table_5() -> NDArray[np.float64]:
    """Start of the orbiter case."""
    position = np.array([-3.92, -3103.37, -1665.41]) * 1e3
    return state_from_cartesian(position, [5775.31, 1124.27, 1175.48])


@cache
def ground_flight() -> Trajectory:
    """Return the flight of Table 2."""
    return fly(model(), table_2(), TIMES)


@cache
def orbiter_flight() -> Trajectory:
    """Return the flight of Table 5."""
    return fly(model(), table_5(), TIMES)


def ground_beacons(places: NDArray[np.float64] | None = None) -> Beacons:
    """Beacons at latitudes and longitudes (rad, (n, 2)); by default those of Figure 4's words."""
    lat, lon = (np.radians(WORDS_OF_FIGURE_4) if places is None else places).T
    return surface_beacons(lat, lon, TIMES, planet_radius=RADIUS)


def orbiters(angles: NDArray[np.float64] = TABLE_6) -> Beacons:
    """Orbiters at node, inclination and argument of latitude (rad, (n, 3)); by default Table 6."""
    node, inclination, argument = angles.T
    orbits = keplerian(RADIUS + ALTITUDE, 0.0, inclination, node, 0.0, argument, gm=GM)
    r, v = states_mci(orbits, TIMES)
    return orbiting_beacons(r, v, TIMES, omega=OMEGA, planet_radius=RADIUS)

"""How high the satellite stands that a fold hangs on, at one place and moment, without boxes."""

import numpy as np

from compass.coverage.clearance_layout import Moving
from compass.coverage.users import Users
from compass.orbits import positions_mcmf
from compass.orbits.constellation import Constellation
from compass.sites import Site


def ranked(
    moving: Moving, users: Users, time: float, latitude: float, longitude: float
) -> list[tuple[str, float]]:
    """Names of satellites and their elevations, radians; who clears the horizon by most is first.

    Parameters
    ----------
    moving
        Orbits in two-body motion, or paths.
    users
        Their figure, height, horizon, and the beam of the antennas that they see: the room to its
        edge counts where that is less than what is above the horizon.
    time, latitude, longitude
        Seconds after the epoch; planetocentric and Mars-fixed, radians.
    """
    if isinstance(moving, Constellation):
        r = positions_mcmf(moving, [time])[:, 0]
    else:
        r = moving.positions_mcmf([time])[:, 0]
    place = Site("", latitude, longitude, users.height, users.mask, users.figure)
    elevation, azimuth = place.elevation_azimuth(r)
    clearance = elevation - users.mask.at(azimuth)
    if users.beam is not None:
        down, away = -r, place.r_mcmf - r
        lengths = np.linalg.norm(down, axis=1) * np.linalg.norm(away, axis=1)
        off_nadir = np.arccos(np.clip((down * away).sum(axis=1) / lengths, -1.0, 1.0))
        clearance = np.minimum(clearance, users.beam - off_nadir)
    best = np.argsort(-clearance)
    return [(moving.satellite_names[s], float(elevation[s])) for s in best]


def nth_elevation(
    moving: Moving, users: Users, fold: int, time: float, latitude: float, longitude: float
) -> float | None:
    """Elevation of the satellite that is the `fold`-th of `ranked`; None with fewer."""
    known = ranked(moving, users, time, latitude, longitude)
    return known[fold - 1][1] if len(known) >= fold else None

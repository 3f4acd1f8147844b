"""How high the satellite stands that a fold hangs on, at one place and moment, without boxes."""

import numpy as np

from compass.coverage.clearance_layout import Moving
from compass.coverage.users import Users
from compass.orbits import positions_mcmf
from compass.orbits.constellation import Constellation
from compass.sites import Site


def nth_elevation(
    moving: Moving, users: Users, fold: int, time: float, latitude: float, longitude: float
) -> float | None:
    """Elevation of the satellite that is the `fold`-th best above the horizon, radians.

    Parameters
    ----------
    moving
        Orbits in two-body motion, or paths.
    users
        Their figure, height, horizon, and the beam of the antennas that they see.
    fold
        1 for the satellite that clears the horizon by most, or the edge of its beam.
    time, latitude, longitude
        Seconds after the epoch; planetocentric and Mars-fixed, radians.

    Returns
    -------
    elevation
        None with fewer satellites.
    """
    if moving.size < fold:
        return None
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
    return float(elevation[np.argsort(-clearance)[fold - 1]])

"""Positions and velocities over time, whatever the motion."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.conventions import dated, epoch_text
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits.constellation import Constellation
from compass.orbits.motion import AnyMotion, as_motion

if TYPE_CHECKING:
    import xarray as xr


def states_mci(
    constellation: Constellation, times: ArrayLike, model: AnyMotion = "two-body"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inertial positions (m) and velocities (m/s), each of shape (satellite, time, 3).

    Parameters
    ----------
    constellation
        The orbits.
    times
        Seconds after the constellation's epoch, shape (t,); any order, may be negative.
    model
        How they move: a `Motion`, or the name of one: ``two-body``; ``j2``: mean elements
        drifting at J2's secular rates; ``numerical``: under the default forces, elements taken as
        osculating.

    Raises
    ------
    ArgumentError
        The model is unknown, or a time is outside what it knows.
    """
    return as_motion(model).states(constellation, times)


def positions_mci(
    constellation: Constellation, times: ArrayLike, model: AnyMotion = "two-body"
) -> NDArray[np.float64]:
    """Inertial positions, metres, shape (satellite, time, 3); see `states_mci`."""
    return states_mci(constellation, times, model)[0]


def positions_mcmf(
    constellation: Constellation, times: ArrayLike, model: AnyMotion = "two-body"
) -> NDArray[np.float64]:
    """Mars-fixed positions, metres, shape (satellite, time, 3); see `states_mci`."""
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    angle = prime_meridian_angle(constellation.epoch, seconds)
    return mcmf_from_mci(positions_mci(constellation, seconds, model), angle)


@checked
def ephemeris(
    constellation: Constellation, times: ArrayLike, model: AnyMotion = "two-body"
) -> "xr.Dataset":
    """Positions and velocities as a dataset over (satellite, time, axis).

    Variables ``r_mci`` (m), ``v_mci`` (m/s) and ``r_mcmf`` (m); see `states_mci`.

    Examples
    --------
    >>> import compass
    >>> design = compass.read_design("designs/compass-15-5-1.toml")
    >>> compass.ephemeris(design.constellation, [0, 3600]).r_mci.shape
    (15, 2, 3)
    """
    import xarray as xr

    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r, v = states_mci(constellation, seconds, model)
    fixed = mcmf_from_mci(r, prime_meridian_angle(constellation.epoch, seconds))
    dims = ("satellite", "time", "axis")
    made = xr.Dataset(
        {
            "r_mci": (dims, r, {"units": "m", "long_name": "position, Mars-centred inertial"}),
            "v_mci": (dims, v, {"units": "m s-1", "long_name": "velocity, Mars-centred inertial"}),
            "r_mcmf": (dims, fixed, {"units": "m", "long_name": "position, Mars-fixed"}),
        },
        coords={
            "satellite": list(constellation.satellite_names),
            "time": ("time", seconds, {"units": "s", "long_name": "time after the epoch"}),
            "axis": ["x", "y", "z"],
        },
        attrs={"constellation": constellation.name, "epoch_tdb": epoch_text(constellation.epoch)},
    )
    return dated(made)

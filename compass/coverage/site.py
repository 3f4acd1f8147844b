"""Satellite counts and dilution of precision over time at one site."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from compass.core.dop import dop_series
from compass.coverage.maps import DOPS, LONG_NAMES
from compass.orbits import Constellation, positions_mcmf
from compass.orbits.motion import AnyMotion
from compass.sites import Site

if TYPE_CHECKING:
    import xarray as xr


def site_coverage(
    constellation: Constellation,
    site: Site,
    times: ArrayLike,
    model: AnyMotion = "two-body",
    beacons: Sequence[Site] = (),
) -> "xr.Dataset":
    """What a site sees: on its figure's ellipsoid, at its height, over its own horizon.

    Parameters
    ----------
    constellation
        The orbits.
    site
        Where, and what its mask hides.
    times
        Seconds after the constellation's epoch, shape (t,).
    model
        As in `compass.orbits.states_mci`.
    beacons
        On the ground, which are ranged to as satellites are and counted with them.

    Returns
    -------
    xarray.Dataset
        ``elevation`` and ``azimuth`` (degrees) and ``visible`` over (satellite, time);
        ``count`` and ``gdop`` ... ``tdop`` over time, inf with fewer than four in view.
    """
    import xarray as xr

    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r = positions_mcmf(constellation, seconds, model)
    ground = np.reshape([beacon.r_mcmf for beacon in beacons], (-1, 1, 3))
    r = np.concatenate([r, np.broadcast_to(ground, (len(beacons), seconds.size, 3))])
    sights = r - site.r_mcmf
    sights /= np.linalg.norm(sights, axis=-1, keepdims=True)
    elevation, azimuth = site.elevation_azimuth(r)
    visible = elevation >= site.mask.at(azimuth)
    counts, dops = np.empty(seconds.size, np.int16), np.empty((len(DOPS), seconds.size))
    dop_series(sights, visible, site.enu_mcmf[2], counts, dops)
    each = ("satellite", "time")
    data: dict[str, tuple] = {
        "elevation": (each, np.degrees(elevation), {"units": "degrees"}),
        "azimuth": (each, np.degrees(azimuth), {"units": "degrees"}),
        "visible": (each, visible),
        "count": ("time", counts, {"units": "1", "long_name": "satellites in view"}),
    }
    for name, values in zip(DOPS, dops, strict=True):
        data[name] = ("time", values, {"units": "1", "long_name": LONG_NAMES[name]})
    return xr.Dataset(
        data,
        {
            "satellite": [*constellation.satellite_names, *(beacon.name for beacon in beacons)],
            "time": ("time", seconds, {"units": "s", "long_name": "time after the epoch"}),
        },
        {"site": site.name},
    )

"""The relief of Mars, quietly shaded, to lie under maps and on the globe.

Elevations over the areoid by cells of 2 degrees, from the spherical harmonics of Mars's shape to
degree 90: PDS product GTM090AA of Mars Global Surveyor's laser altimeter (Smith et al. 2001,
J. Geophys. Res. 106:23689). For the eye only: no result depends on it.
"""

from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

#: Radius taken for slopes, m; how much steeper they are drawn; height of the light, degrees.
RADIUS, STEEPER, LIGHT_DEG = 3.39e6, 12.0, 45.0


@cache
def elevation() -> NDArray[np.float64]:
    """Metres over the areoid by cell, shape (90, 180): north to south, 0 to 360 degrees east."""
    with (files("compass.data") / "mars-topography-2deg.npz").open("rb") as file:
        values = np.load(file)["elevation_m"].astype(float)
    values.flags.writeable = False
    return values


@cache
def shade() -> NDArray[np.float64]:
    """Brightness by cell under light from the north-west, from 0 to 1; flat ground has 0.7.

    The cosine of the angle between the ground's vertical and the light (Lambert).
    """
    height = elevation()
    latitude = np.radians(89.0 - 2.0 * np.arange(90))[:, np.newaxis]
    cell = RADIUS * np.radians(2.0)
    around = np.pad(height, ((0, 0), (1, 1)), mode="wrap")
    east = (around[:, 2:] - around[:, :-2]) / (2 * cell * np.maximum(np.cos(latitude), 0.2))
    north = -np.gradient(height, cell, axis=0)
    x, y = STEEPER * east, STEEPER * north
    low, high = np.cos(np.radians(LIGHT_DEG)), np.sin(np.radians(LIGHT_DEG))
    light = (low * (x - y) / np.sqrt(2) + high) / np.sqrt(1 + x**2 + y**2)
    return np.clip(light, 0.0, 1.0)


def finer_shade(times: int) -> NDArray[np.float64]:
    """`shade` on cells so many times finer each way, linear between those it is known at."""
    wide = np.pad(np.pad(shade(), ((1, 1), (0, 0)), mode="edge"), ((0, 0), (1, 1)), mode="wrap")
    return _between(_between(wide, times).T, times).T


def _between(rows: NDArray[np.float64], times: int) -> NDArray[np.float64]:
    """Rows so many times closer, the outer two left out, linear between those given."""
    at = 1 + (np.arange((len(rows) - 2) * times) + 0.5) / times - 0.5
    low = np.floor(at).astype(int)
    share = (at - low)[:, np.newaxis]
    return rows[low] * (1 - share) + rows[low + 1] * share

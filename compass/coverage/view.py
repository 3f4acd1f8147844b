"""What kernels need to know of a constellation over time: directions, distances, caps, mask."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.coverage.cap import cap_radius
from compass.orbits import Constellation, positions_mcmf
from compass.orbits.motion import AnyMotion
from compass.sites import Mask


@dataclass(frozen=True)
class View:
    """A constellation over Mars at some epochs.

    Attributes
    ----------
    times
        Seconds after the constellation's epoch, shape (epoch,).
    r
        Mars-fixed positions in units of the equatorial radius, shape (epoch, satellite, 3).
    cos_cap
        Cosines of the cap radii on the sphere of that radius under the lowest mask elevation,
        shape (epoch, satellite).
    azimuths, elevations
        The mask; one pair if it is constant.
    """

    times: NDArray[np.float64]
    r: NDArray[np.float64]
    cos_cap: NDArray[np.float64]
    azimuths: NDArray[np.float64]
    elevations: NDArray[np.float64]

    @property
    def directions(self) -> NDArray[np.float64]:
        """Unit vectors to the satellites, shape (epoch, satellite, 3)."""
        return self.r / np.linalg.norm(self.r, axis=-1, keepdims=True)


def view(
    constellation: Constellation,
    times: ArrayLike,
    sphere_radius: float,
    mask: Mask | None = None,
    model: AnyMotion = "two-body",
) -> View:
    """Put a constellation over Mars, `sphere_radius` metres at the equator, at `times` seconds.

    Raises
    ------
    ArgumentError
        A satellite is not above the sphere at one of the times.
    """
    mask = mask or Mask()
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    positions = positions_mcmf(constellation, seconds, model) / sphere_radius
    r = np.ascontiguousarray(np.moveaxis(positions, 0, 1))
    caps = cap_radius(np.linalg.norm(r, axis=-1) * sphere_radius, sphere_radius, mask.lowest)
    constant = mask.is_constant
    return View(
        seconds,
        r,
        np.cos(caps),
        np.array(mask.azimuth[:1] if constant else mask.azimuth),
        np.array(mask.elevation[:1] if constant else mask.elevation),
    )

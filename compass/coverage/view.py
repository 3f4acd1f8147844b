"""What kernels need to know of a constellation over time: directions, distances, caps, mask."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.coverage.cap import cap_radius
from compass.coverage.grid import Grid
from compass.orbits import Constellation, positions_mcmf
from compass.orbits.motion import AnyMotion, Motion, as_motion
from compass.sites import Mask

if TYPE_CHECKING:
    from compass.core.runs import Row

#: Satellite positions that are worked out at once: what is made on the way to them takes some
#: 120 bytes each.
PIECE = 400_000


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
    height
        Of the users above the ground, in units of the equatorial radius.
    beam
        Half angle of the satellites' antennas about the way down, radians; None all around.
    """

    times: NDArray[np.float64]
    r: NDArray[np.float64]
    cos_cap: NDArray[np.float64]
    azimuths: NDArray[np.float64]
    elevations: NDArray[np.float64]
    height: float = 0.0
    beam: float | None = None

    def rows(self, grid: Grid) -> list["Row"]:
        """The users of each row of a grid, under the mask, as kernels take them."""
        from compass.core.runs import ALL_AROUND, Row

        longitude = grid.longitude
        columns = np.cos(longitude), np.sin(longitude), float(longitude[0])
        reach = ALL_AROUND if self.beam is None else float(np.cos(self.beam))
        return [
            Row(self.azimuths, self.elevations, place, *columns, reach)
            for place in raised(grid.places, self.height)
        ]

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
    *,
    height: float = 0.0,
    beam: float | None = None,
) -> View:
    """Put a constellation over Mars, `sphere_radius` metres at the equator, at `times` seconds.

    Over users at a height, metres, who are seen in antennas of a half angle `beam`, radians.

    Raises
    ------
    ArgumentError
        A satellite is not above the sphere at one of the times.
    """
    mask = mask or Mask()
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r = np.empty((seconds.size, constellation.size, 3))
    cos_cap = np.empty(r.shape[:2])
    for part in _pieces(seconds.size, constellation.size, as_motion(model)):
        r[part] = np.moveaxis(positions_mcmf(constellation, seconds[part], model), 0, 1)
        r[part] /= sphere_radius
        distance = np.linalg.norm(r[part], axis=-1) * sphere_radius
        cos_cap[part] = np.cos(cap_radius(distance, sphere_radius, mask.lowest))
    constant = mask.is_constant
    return View(
        seconds,
        r,
        cos_cap,
        np.array(mask.azimuth[:1] if constant else mask.azimuth),
        np.array(mask.elevation[:1] if constant else mask.elevation),
        height / sphere_radius,
        beam,
    )


def raised(places: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """How users stand so high above those of rows, in units of the equatorial radius."""
    from compass.core.runs import HIGH, OUT, SQUARE, UP_OUT, UP_Z

    if height == 0:
        return places
    up = places.copy()
    up[:, OUT] += height * up[:, UP_OUT]
    up[:, HIGH] += height * up[:, UP_Z]
    up[:, SQUARE] = up[:, OUT] ** 2 + up[:, HIGH] ** 2
    return up


def _pieces(epochs: int, satellites: int, motion: Motion) -> Iterator[slice]:
    """Runs of epochs, so that little is held beside the positions.

    All at once where forces are integrated, which begins at the epoch every time.
    """
    step = max(1, PIECE // max(satellites, 1)) if motion.is_closed_form else epochs
    for first in range(0, epochs, max(step, 1)):
        yield slice(first, first + step)

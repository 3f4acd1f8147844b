"""Where, along which azimuth and when landers arrive: spread evenly, and reproducible."""

from dataclasses import dataclass
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError

Array = NDArray[np.float64]

#: Most entries of a campaign: they are kept in memory, 0.1 MB each.
MOST_SAMPLES = 1 << 13


@dataclass(frozen=True)
class Arrivals:
    """Where, along which azimuth and when landers arrive.

    Attributes
    ----------
    latitude, longitude, azimuth
        At entry, radians, shape (m,); azimuth clockwise from north.
    phase
        Time of arrival as a part of some period, in [0, 1), shape (m,).
    """

    latitude: Array
    longitude: Array
    azimuth: Array
    phase: Array

    def part(self, chosen: slice) -> "Arrivals":
        """Return some of them."""
        return Arrivals(*(values[chosen] for values in vars(self).values()))


def draw_arrivals(count: int, seed: int) -> Arrivals:
    """Spread arrivals evenly over the sphere's area, all azimuths and a period.

    Scrambled Sobol points in four dimensions: reproducible from the seed, and independent
    of everything else.

    Raises
    ------
    ArgumentError
        A count outside 1 to `MOST_SAMPLES`, or a seed below 0.
    """
    from scipy.stats import qmc

    if not 1 <= count <= MOST_SAMPLES:
        raise ArgumentError(f"samples = {count}: allowed 1 to {MOST_SAMPLES}")
    if seed < 0:
        raise ArgumentError(f"seed = {seed}: must be 0 or more")
    points = qmc.Sobol(4, scramble=True, seed=seed).random_base2(ceil(log2(count)))[:count]
    return Arrivals(
        np.arcsin(2.0 * points[:, 0] - 1.0),
        2.0 * np.pi * points[:, 1] - np.pi,
        2.0 * np.pi * points[:, 2],
        points[:, 3],
    )

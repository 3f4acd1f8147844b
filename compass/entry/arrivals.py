"""Where, along which azimuth and when landers arrive: spread evenly, and reproducible."""

from dataclasses import dataclass
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from compass.allowed import check_all_allowed

Array = NDArray[np.float64]


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
        A count or a seed outside what is allowed.
    """
    from scipy.stats import qmc

    check_all_allowed(samples=count, seed=seed)
    points = qmc.Sobol(4, scramble=True, seed=seed).random_base2(ceil(log2(count)))[:count]
    return Arrivals(
        np.arcsin(2.0 * points[:, 0] - 1.0),
        2.0 * np.pi * points[:, 1] - np.pi,
        2.0 * np.pi * points[:, 2],
        points[:, 3],
    )

"""A span in stretches: between two of them ^C is heard and a bar moves on."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from compass.orbits import Constellation

#: Satellites that make one stretch more of a span, up to so many stretches.
CROWD, MOST_OF_A_CROWD = 50, 32


def revolutions(
    constellation: Constellation, start: float, stop: float
) -> list[tuple[float, float]]:
    """Equal stretches of a span, s, none above a revolution of the fastest satellite.

    Of many satellites, each of which costs time, there are more.
    """
    fastest = float(constellation.mean_motion.max(initial=0.0))
    turns = int(np.ceil(fastest * (stop - start) / (2.0 * np.pi)))
    number = max(1, turns, min(constellation.size // CROWD, MOST_OF_A_CROWD))
    edges = np.linspace(start, stop, number + 1).tolist()
    return list(pairwise(edges))


def between_breaks(
    breaks: NDArray[np.float64], start: float, stop: float, longest: float
) -> list[tuple[float, float]]:
    """Stretches of a span about `longest` seconds long whose inner ends are breaks of its paths."""
    wanted = np.arange(start + longest, stop, longest)
    inner = breaks[np.searchsorted(breaks, wanted).clip(max=len(breaks) - 1)]
    edges = [start, *np.unique(inner[(inner > start) & (inner < stop)]).tolist(), stop]
    return list(pairwise(edges))

"""A span in stretches: between two of them ^C is heard and a bar moves on."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError
from compass.orbits import Constellation

#: Satellites that make one stretch more of a span, up to so many stretches.
CROWD, MOST_OF_A_CROWD = 50, 32

#: Pairs of circles that one proof may have to compare at the least: some ten seconds of work, and
#: what is asked of a claim takes dozens of proofs.
MOST_PAIRS = 30_000_000


def check_pairs(satellites: int, moments: int) -> None:
    """Refuse a proof that compares every two circles at so many moments, before it is begun.

    Raises
    ------
    ArgumentError
        That is more than `MOST_PAIRS`.
    """
    pairs = moments * satellites**2
    if pairs > MOST_PAIRS:
        raise ArgumentError(
            f"satellites = {satellites}: a proof compares every two of their circles at {moments} "
            f"moments or more, {pairs:.3g} pairs; allowed up to {MOST_PAIRS:.3g}, which is "
            f"{int((MOST_PAIRS / moments) ** 0.5)} satellites at as many; prove it for fewer, or "
            "sample it with a map"
        )


def revolutions(
    constellation: Constellation, start: float, stop: float
) -> list[tuple[float, float]]:
    """Equal stretches of a span, s, none above a revolution of the fastest satellite.

    Of many satellites, each of which costs time, there are more. A proof looks at every stretch
    at least once, and each look compares every two circles.

    Raises
    ------
    ArgumentError
        As `check_pairs`.
    """
    fastest = float(constellation.mean_motion.max(initial=0.0))
    turns = int(np.ceil(fastest * (stop - start) / (2.0 * np.pi)))
    number = max(1, turns, min(constellation.size // CROWD, MOST_OF_A_CROWD))
    check_pairs(constellation.size, number)
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

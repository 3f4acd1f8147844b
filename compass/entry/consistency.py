"""Whether a filter's claims hold: chi-square bounds of the NEES, error ellipses."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError


def nees_bounds(states: int, runs: int, level: float = 0.95) -> tuple[float, float]:
    """Two-sided bounds of the mean NEES of a consistent filter.

    ``runs * mean`` is chi-square with ``runs * states`` degrees of freedom.

    Parameters
    ----------
    states, runs
        Dimension of the error and number of independent runs.
    level
        Probability of lying within the bounds.

    References
    ----------
    Bar-Shalom, Li and Kirubarajan 2001, Estimation with Applications to Tracking and
    Navigation, section 5.4.2.
    """
    from scipy.stats import chi2

    if runs < 1 or not 0 < level < 1:
        raise ArgumentError(f"runs = {runs}, level = {level}: at least 1, and between 0 and 1")
    low, high = chi2.ppf([(1 - level) / 2, (1 + level) / 2], runs * states) / runs
    return float(low), float(high)


@dataclass(frozen=True)
class Ellipse:
    """Horizontal error ellipse.

    Attributes
    ----------
    east, north
        Centre, metres from the true point.
    semi_major, semi_minor
        Metres.
    azimuth
        Of the major axis, clockwise from north, radians in [0, pi).
    level
        Probability inside, for Gaussian errors.
    """

    east: float
    north: float
    semi_major: float
    semi_minor: float
    azimuth: float
    level: float

    def outline(self, points: int = 181) -> NDArray[np.float64]:
        """East and north of points around the ellipse, metres, shape (points, 2)."""
        angle = np.linspace(0, 2 * np.pi, points)
        along, across = self.semi_major * np.cos(angle), self.semi_minor * np.sin(angle)
        s, c = np.sin(self.azimuth), np.cos(self.azimuth)
        return np.stack(
            [self.east + along * s + across * c, self.north + along * c - across * s], axis=-1
        )


def error_ellipse(
    mean: NDArray[np.float64], covariance: NDArray[np.float64], level: float = 0.95
) -> Ellipse:
    """Ellipse of east and north errors that holds `level` of a Gaussian distribution.

    Parameters
    ----------
    mean
        East and north, metres, shape (2,).
    covariance
        Shape (2, 2), m^2.
    level
        Probability inside: radius ``sqrt(-2 ln(1 - level))`` sigma.
    """
    values, vectors = np.linalg.eigh(covariance)
    radius = np.sqrt(-2 * np.log(1 - level))
    major, minor = radius * np.sqrt(np.maximum(values[::-1], 0.0))
    azimuth = float(np.mod(np.arctan2(vectors[0, 1], vectors[1, 1]), np.pi))
    return Ellipse(float(mean[0]), float(mean[1]), float(major), float(minor), azimuth, level)

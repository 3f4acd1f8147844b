"""Where on the surface a lander is in view from, at one time or all the way down."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from compass.entry.trajectory import Trajectory
from compass.entry.views import cartesian_of, local_axes
from compass.errors import ArgumentError

#: Beacons are placed this fraction of the way to the edge at most, to be strictly in view.
INSIDE = 1.0 - 1e-9


class VisibleArea:
    """The places from which the lander is above the horizon throughout a flight (eq. 53's Omega).

    An intersection of caps, one an epoch, of half-angle ``acos(R/r)``: convex on the sphere, so
    seen from a point inside it every direction leads to its edge once.

    Parameters
    ----------
    flight
        The trajectory.

    Raises
    ------
    ArgumentError
        No place sees the lander throughout.
    """

    def __init__(self, flight: Trajectory) -> None:
        position = cartesian_of(flight.states)[:, :3]
        distance = np.linalg.norm(position, axis=1)
        self._up = position / distance[:, None]
        self._cosine = np.minimum(1.0, flight.model.planet_radius / distance)
        cap = np.arccos(self._cosine)

        def excess(x: NDArray) -> float:
            centre = x / np.linalg.norm(x)
            return float((np.arccos(np.clip(self._up @ centre, -1, 1)) - cap).max())

        first = self._up[0] + self._up[-1]
        minimum = minimize(
            excess, first / np.linalg.norm(first), method="Nelder-Mead", options={"xatol": 1e-9}
        )
        if minimum.fun >= 0:
            raise ArgumentError(
                "no place on the surface sees the lander throughout: the entry is too long or too "
                "low; shorten duration_s or use orbiters"
            )
        self.centre: NDArray[np.float64] = minimum.x / np.linalg.norm(minimum.x)
        east, north, _ = local_axes(self.centre)
        self._axes = np.array([north, east])

    def points(self, polar: ArrayLike) -> NDArray[np.float64]:
        """Return unit vectors, shape (n, 3), inside the area.

        Parameters
        ----------
        polar
            Shape (n, 2): azimuth from the area's centre, clockwise from north, radians, and the
            fraction, 0 to 1, of the way to the edge.
        """
        azimuth, fraction = np.asarray(polar, dtype=float).reshape(-1, 2).T
        tangent = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1) @ self._axes
        a, b = self._up @ self.centre, self._up @ tangent.T
        size = np.hypot(a[:, None], b)
        edge = np.arctan2(b, a[:, None]) + np.arccos(np.minimum(1.0, self._cosine[:, None] / size))
        angle = (np.clip(fraction, 0.0, 1.0) * INSIDE * edge.min(axis=0))[:, None]
        return np.cos(angle) * self.centre + np.sin(angle) * tangent

    def outline(self, count: int = 721) -> NDArray[np.float64]:
        """Return unit vectors of the edge, closed, shape (count, 3)."""
        azimuth = np.linspace(0.0, 2 * np.pi, count)
        return self.points(np.stack([azimuth, np.ones(count)], axis=1))


def horizon(flight: Trajectory, epoch: int, count: int = 181) -> NDArray[np.float64]:
    """Rim of what sees the lander at one epoch: unit vectors, closed, shape (count, 3)."""
    position = cartesian_of(flight.states[epoch])[:3]
    distance = float(np.linalg.norm(position))
    up = position / distance
    cap = np.arccos(min(1.0, flight.model.planet_radius / distance))
    east, north, _ = local_axes(up)
    angle = np.linspace(0.0, 2 * np.pi, count)[:, None]
    around = np.cos(angle) * north + np.sin(angle) * east
    return np.cos(cap) * up + np.sin(cap) * around

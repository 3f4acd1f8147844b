"""The entry state at the border: both heading conventions, and Cartesian vectors."""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.entry.views import spherical_of
from compass.errors import ArgumentError

HeadingFrom = Literal["north", "east"]


def azimuth_from_heading(heading: ArrayLike, heading_from: HeadingFrom) -> NDArray[np.float64]:
    """Azimuth clockwise from north, radians in (-pi, pi], of a heading as a source counts it.

    Parameters
    ----------
    heading
        Radians: clockwise from north, or from east, positive to the north.
    heading_from
        ``north`` or ``east``. The conversion is its own inverse.

    Raises
    ------
    ArgumentError
        The convention is neither.
    """
    angle = np.asarray(heading, dtype=float)
    if heading_from == "east":
        angle = np.pi / 2 - angle
    elif heading_from != "north":
        allowed = ", ".join(get_args(HeadingFrom))
        raise ArgumentError(f"heading_from = {heading_from!r}: allowed {allowed}")
    return np.pi - np.mod(np.pi - angle, 2 * np.pi)


def longitude_degrees(longitude: ArrayLike) -> NDArray[np.float64]:
    """East longitude to show, degrees in [-180, 180), of one in radians that flights count on."""
    return np.mod(np.degrees(longitude) + 180.0, 360.0) - 180.0


def state_from_cartesian(r: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
    """State ``[r, lon, lat, V, gamma, psi]``, shape (6,), SI, psi clockwise from north.

    Parameters
    ----------
    r, v
        Mars-fixed position, m, and velocity relative to the rotating planet, m/s, shape (3,).

    Raises
    ------
    ArgumentError
        A vehicle at the centre, or without velocity.
    """
    position, velocity = np.asarray(r, dtype=float), np.asarray(v, dtype=float)
    if not (position.any() and velocity.any()):
        raise ArgumentError(
            f"position {position.tolist()} m, velocity {velocity.tolist()} m/s: place or direction "
            "is undefined; use a point off the centre and a speed above 0"
        )
    return spherical_of(np.concatenate([position, velocity]))

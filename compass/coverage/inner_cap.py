"""The largest cap, seen from the centre, in which all users on an ellipsoid see one satellite."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.figure import inner_caps
from compass.coverage.cap import cap_radius


def inner_cap_radius(
    orbit_radius: ArrayLike,
    latitude: ArrayLike,
    sphere_radius: float,
    mask: float = 0.0,
    stretch: float = 1.0,
) -> NDArray[np.float64]:
    """Largest cap about satellites in which all users on an ellipsoid see them, radians.

    Proven (`compass.core.figure.inner_cap`), and short of the largest by some 0.02 degree.

    Parameters
    ----------
    orbit_radius, latitude
        Distance from Mars's centre, m, and planetocentric latitude of the satellites, radians.
    sphere_radius, mask
        Equatorial radius, m; elevation over the ellipsoid's normal, radians.
    stretch
        Ratio of the equatorial radius to the polar one: 1 for a sphere, where caps are those of
        `cap_radius`.

    Raises
    ------
    ArgumentError
        As `cap_radius`.
    """
    r, angle = np.broadcast_arrays(np.asarray(orbit_radius, float), np.asarray(latitude, float))
    on_sphere = cap_radius(r, sphere_radius, mask)
    if stretch == 1.0:
        return on_sphere
    heights = r * np.sin(angle)
    radii = inner_caps(r.ravel(), heights.ravel(), float(sphere_radius), stretch, float(mask))
    return np.asarray(radii).reshape(r.shape)

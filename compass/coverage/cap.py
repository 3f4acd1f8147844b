"""The cap of the sphere that sees one satellite."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError


def cap_radius(
    orbit_radius: ArrayLike, sphere_radius: float, mask: ArrayLike = 0.0
) -> NDArray[np.float64]:
    """Body-central half angle of the cap, ``lambda = acos(R cos(e) / r) - e``, radians.

    Parameters
    ----------
    orbit_radius
        Distance r of the satellite from Mars's centre, metres.
    sphere_radius
        Radius R of the sphere, metres.
    mask
        Elevation mask e, radians.

    Raises
    ------
    ArgumentError
        A satellite that is not above the surface.
    """
    r = np.asarray(orbit_radius, dtype=float)
    if np.any(r <= sphere_radius):
        raise ArgumentError(
            f"orbit radius {float(np.min(r)) / 1e3:g} km: must be above the surface, "
            f"{sphere_radius / 1e3:g} km"
        )
    return np.arccos(sphere_radius * np.cos(mask) / r) - mask


def mask_for_cap(
    cap: ArrayLike, orbit_radius: ArrayLike, sphere_radius: float
) -> NDArray[np.float64]:
    """Elevation at the rim of a cap: ``tan e = (cos lambda - R/r) / sin lambda``, radians.

    The inverse of `cap_radius` in the mask; negative where the cap reaches past the limb.
    """
    lam = np.asarray(cap, dtype=float)
    return np.arctan2(np.cos(lam) - sphere_radius / np.asarray(orbit_radius), np.sin(lam))


@dataclass(frozen=True)
class Cap:
    """Geometry of the cap that one satellite serves.

    Angles in radians, lengths in metres, areas in square metres.

    Attributes
    ----------
    half_cone
        Nadir angle of the rim at the satellite, ``asin(R cos(e) / r)``.
    half_arc
        Body-central half angle lambda.
    tangent
        Distance from the satellite to the rim.
    radius
        Radius of the rim circle, ``R sin(lambda)``.
    depth
        Height of the cap, ``R (1 - cos(lambda))``.
    arc
        Half arc length on the surface, ``R lambda``.
    area
        ``2 pi R depth``.
    sphere_radius
        R.
    """

    half_cone: float
    half_arc: float
    tangent: float
    radius: float
    depth: float
    arc: float
    area: float
    sphere_radius: float

    @property
    def fraction(self) -> float:
        """Share of the sphere inside the cap, ``(1 - cos(lambda)) / 2``."""
        return self.depth / (2 * self.sphere_radius)


def cap(orbit_radius: float, sphere_radius: float, mask: float = 0.0) -> Cap:
    """Analytic geometry of the cap seen above a mask from a satellite at `orbit_radius`.

    Parameters and errors as in `cap_radius`.

    References
    ----------
    Kelly and Bevilacqua 2018, eqs. 1 to 3 and 5 (mask 0); eq. 4 is `published_cap_area`.
    """
    lam = float(cap_radius(orbit_radius, sphere_radius, mask))
    # 2 sin^2(lambda/2) and the law of cosines in its half-angle form: exact for low orbits too
    versine = 2 * np.sin(lam / 2) ** 2
    depth = sphere_radius * versine
    height = orbit_radius - sphere_radius
    tangent = np.sqrt(height**2 + 2 * orbit_radius * sphere_radius * versine)
    return Cap(
        half_cone=float(np.arcsin(sphere_radius * np.cos(mask) / orbit_radius)),
        half_arc=lam,
        tangent=float(tangent),
        radius=float(sphere_radius * np.sin(lam)),
        depth=float(depth),
        arc=sphere_radius * lam,
        area=float(2 * np.pi * sphere_radius * depth),
        sphere_radius=sphere_radius,
    )


def published_cap_area(geometry: Cap) -> float:
    """Cap area as Kelly and Bevilacqua 2018 print it (eq. 4), m^2; wrong, kept for comparison.

    ``pi (R^2 - d^2) + 2 pi R d``: the first term belongs to no cap; a cap is ``2 pi R d``.
    """
    r, d = geometry.sphere_radius, geometry.depth
    return float(np.pi * (r**2 - d**2) + 2 * np.pi * r * d)

"""What an orbit error comes to on average over all who see the satellite."""

from dataclasses import dataclass

import numpy as np

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Weights:
    """Share of a radial, and of an along- or cross-track, error in the range of the average user.

    With independent errors ``sigma^2 = radial^2 R^2 + across2 (A^2 + C^2) + T^2``. For the average
    user only: one user's share goes by his own line of sight.

    Attributes
    ----------
    radial
        w_R.
    across2
        w_AC^2.
    """

    radial: float
    across2: float


def average_weights(orbit_radius: float, sphere_radius: float, mask: float = 0.0) -> Weights:
    """Weights of the average over the area that sees a satellite above a mask (rad).

    With the angle at the satellite between Mars's centre and the user, eta:
    ``w_R^2 = mean cos^2(eta)``, ``w_AC^2 = mean sin^2(eta) / 2``. Gauss-Legendre over the cosine of
    the central angle, in which area is length; exact to rounding for any satellite that is not
    within metres of the surface.

    References
    ----------
    Montenbruck, Steigenberger and Hauschild 2018, Multi-GNSS signal-in-space range error
    assessment, Advances in Space Research 61:3020.

    Raises
    ------
    ArgumentError
        A satellite that is not above the surface.
    """
    r, p = orbit_radius, sphere_radius
    if r <= p:
        raise ArgumentError(
            f"orbit radius {r / 1e3:g} km: must be above the surface, {p / 1e3:g} km"
        )
    rim = np.cos(np.arccos(p * np.cos(mask) / r) - mask)
    nodes, share = np.polynomial.legendre.leggauss(64)
    cosine = rim + 0.5 * (1.0 - rim) * (nodes + 1.0)
    squared = (r - p * cosine) ** 2 / (r * r + p * p - 2.0 * r * p * cosine)
    mean = 0.5 * float(share @ squared)
    return Weights(mean**0.5, 0.5 * (1.0 - mean))


def off_nadir(orbit_radius: float, sphere_radius: float, elevation: float) -> float:
    """Angle at a satellite between Mars's centre and a user who sees it at an elevation, rad."""
    return float(np.arcsin(sphere_radius * np.cos(elevation) / orbit_radius))

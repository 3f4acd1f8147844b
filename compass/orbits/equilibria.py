"""Where an areostationary satellite stands still over Mars, and how it swings about there."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from compass.bodies import MARS_ROTATION_RATE
from compass.core.gravity import field_acceleration
from compass.orbits.gravity import GravityField

_terms = lru_cache(maxsize=4)(GravityField.terms)


@dataclass(frozen=True)
class Equilibrium:
    """A longitude over the equator at which the field does not push along the track.

    Attributes
    ----------
    longitude
        East, radians.
    radius
        At which the satellite keeps pace with Mars there, m.
    period
        Of a small swing about it, s; None where it is unstable.
    """

    longitude: float
    radius: float
    period: float | None

    @property
    def stable(self) -> bool:
        """Whether a satellite that is moved a little comes back."""
        return self.period is not None


def synchronous_radius(field: GravityField, longitude: float) -> float:
    """Radius over the equator where attraction and rotation balance: ``g_r = omega^2 r``, m."""
    omega = MARS_ROTATION_RATE.value

    def excess(r: float) -> float:
        return -_pull(field, r, longitude)[0] - omega * omega * r

    kepler = (field.gm / omega**2) ** (1.0 / 3.0)
    return float(brentq(excess, 0.999 * kepler, 1.001 * kepler, xtol=1e-4, rtol=1e-14))


def longitude_acceleration(field: GravityField, longitude: float) -> float:
    """Acceleration of the longitude of a satellite that keeps pace with Mars, rad/s^2.

    ``lambda'' = -3 g_east / r``: a push forwards raises the orbit, which then falls behind.
    """
    r = synchronous_radius(field, longitude)
    return -3.0 * _pull(field, r, longitude)[1] / r


def equilibria(field: GravityField) -> list[Equilibrium]:
    """All equilibria over the equator, by longitude.

    Out-of-plane forces are left out: odd zonals hold a satellite some metres beside the equator.
    """
    grid = np.linspace(0.0, 2 * np.pi, 361)
    values = np.array([longitude_acceleration(field, x) for x in grid])
    points = []
    for k in np.flatnonzero(values[1:] * values[:-1] < 0.0):
        x = float(
            brentq(lambda x: longitude_acceleration(field, x), grid[k], grid[k + 1], xtol=1e-12)
        )
        h = 1e-4
        slope = longitude_acceleration(field, x + h) - longitude_acceleration(field, x - h)
        slope /= 2 * h
        period = float(2 * np.pi / np.sqrt(-slope)) if slope < 0.0 else None
        points.append(Equilibrium(x, synchronous_radius(field, x), period))
    return points


def largest_acceleration(field: GravityField) -> tuple[float, float]:
    """Longitude, radians, where that acceleration is largest in size, and its size, rad/s^2."""
    grid = np.radians(np.arange(0.0, 360.0, 2.0))
    best = grid[np.abs([longitude_acceleration(field, x) for x in grid]).argmax()]
    maximum = minimize_scalar(
        lambda x: -abs(longitude_acceleration(field, x)),
        bounds=(best - 0.04, best + 0.04),
        method="bounded",
    )
    return float(np.mod(maximum.x, 2 * np.pi)), float(-maximum.fun)


def _pull(field: GravityField, r: float, longitude: float) -> NDArray[np.float64]:
    """Acceleration outwards and eastwards at a place over the equator, m/s^2."""
    angle = longitude - field.meridian
    c, s = np.cos(angle), np.sin(angle)
    scale = field.gm / field.radius**2
    terms, highest = _terms(field), field.degree + 1
    x, y, _ = field_acceleration(r * c, r * s, 0.0, terms, highest, field.radius, scale)
    return np.array([c * x + s * y - field.gm / r**2, c * y - s * x])

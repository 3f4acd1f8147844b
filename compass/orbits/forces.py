"""The forces on a satellite: which count, and where Sun, moons and meridian stand meanwhile."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from compass.bodies import (
    ASTRONOMICAL_UNIT,
    DEIMOS_GM,
    MARS_EQUATORIAL_RADIUS,
    MARS_ROTATION_RATE,
    PHOBOS_GM,
    SPEED_OF_LIGHT,
    SUN_GM,
    SUN_IRRADIANCE,
    SUN_RADIUS,
)
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, prime_meridian_angle
from compass.moons import moon_row
from compass.orbits.gravity import GravityField, built_in_field
from compass.planets import sun_earth_mci

if TYPE_CHECKING:
    from compass.core.forces import Forces as Tables


Shadow = Literal["none", "cylinder", "cone"]
SHADOWS: tuple[Shadow, ...] = ("none", "cylinder", "cone")

#: Pieces of the sky's series, s, and their degree: the Sun's place is good to a metre, and the
#: periodic terms of the meridian, months long, to rounding.
PIECE, DEGREE = 20.0 * SECONDS_PER_DAY, 9

Times = NDArray[np.float64]


@dataclass(frozen=True)
class Sky:
    """Where the prime meridian, the Sun and the moons are, at seconds after an epoch.

    Attributes
    ----------
    meridian
        Angle W of seconds (t,), radians.
    sun
        Inertial position of seconds (t,), metres, shape (t, 3).
    moons
        Rows of the moons for `compass.core.motion`, shape (m, 20).
    moon_gms
        Their GM, m^3/s^2.
    sun_gm
        That of the Sun, m^3/s^2.
    """

    meridian: Callable[[Times], Times]
    sun: Callable[[Times], NDArray[np.float64]]
    moons: NDArray[np.float64]
    moon_gms: tuple[float, ...]
    sun_gm: float = SUN_GM.value


def sky_of(epoch: float, middle: float) -> Sky:
    """Sky of an epoch from the program's own rotation, planets and moons.

    Mars's pole stays where it is at the epoch, as in `frames`; its precession, 0.0006 degrees a
    year, turns all orbits alike.
    """
    return Sky(
        lambda t: prime_meridian_angle(epoch, t),
        lambda t: sun_earth_mci(epoch, t)[0][:, :3],
        np.array([moon_row(name, epoch, middle) for name in ("phobos", "deimos")]),
        (PHOBOS_GM.value, DEIMOS_GM.value),
    )


@dataclass(frozen=True)
class ForceModel:
    """Which forces act: the table ``[motion]`` of a design.

    Attributes
    ----------
    field
        Gravity of Mars.
    sun, moons
        Whether the Sun's and the moons' attraction count.
    radiation
        Reflectivity times area over mass, m^2/kg; 0 leaves sunlight out.
    shadow
        Whether Mars shades: not at all, as a cylinder, or with a penumbra.
    """

    field: GravityField = field(default_factory=lambda: built_in_field().truncated(8))
    sun: bool = True
    moons: bool = True
    radiation: float = 0.026
    shadow: Shadow = "cylinder"

    def __post_init__(self) -> None:
        """Refuse what no force can be."""
        if not 0.0 <= self.radiation < 1e3:
            raise ArgumentError(
                f"radiation_m2_kg = {self.radiation:g}: allowed 0 up to below 1000 m^2/kg"
            )
        if self.shadow not in SHADOWS:
            raise ArgumentError(f"shadow = {self.shadow!r}: allowed {', '.join(SHADOWS)}")

    @property
    def sunlight(self) -> float:
        """Acceleration by sunlight times the distance from the Sun squared, m^3/s^2."""
        pressure = SUN_IRRADIANCE.value / SPEED_OF_LIGHT.value * ASTRONOMICAL_UNIT.value**2
        return self.radiation * pressure

    def describe(self) -> str:
        """Return the forces as a reader wants them named."""
        parts = [f"{self.field.name} to degree {self.field.degree}"]
        parts += ["Sun"] * self.sun + ["Phobos and Deimos"] * self.moons
        if self.radiation:
            shade = "" if self.shadow == "none" else f", {self.shadow} shadow"
            parts.append(f"radiation on {self.radiation:g} m^2/kg{shade}")
        return ", ".join(parts)

    def tables(self, sky: Sky, start: float, stop: float) -> "Tables":
        """Arrays of `compass.core.forces` for a span.

        Parameters
        ----------
        sky
            Where Sun, moons and meridian are.
        start, stop
            Seconds after the epoch.
        """
        from compass.core import forces as places

        low, high = min(start, stop), max(start, stop)
        pieces = max(int(np.ceil((high - low) / PIECE)), 1)
        length = max(high - low, 1.0) / pieces
        spin = MARS_ROTATION_RATE.value
        zero = float(sky.meridian(np.array([0.0]))[0])

        def columns(t: Times) -> NDArray[np.float64]:
            turned = sky.meridian(t) - zero - spin * t
            return np.column_stack([turned, sky.sun(t)])

        constants = np.zeros(places.CONSTANTS)
        constants[places.GM], constants[places.RADIUS] = self.field.gm, self.field.radius
        constants[places.HIGHEST] = self.field.degree + 1
        constants[places.SUN_GM] = sky.sun_gm if self.sun else 0.0
        constants[places.SUNLIGHT] = self.sunlight
        constants[places.SHADOW] = SHADOWS.index(self.shadow)
        constants[places.MARS_RADIUS] = MARS_EQUATORIAL_RADIUS.value
        constants[places.SUN_RADIUS] = SUN_RADIUS.value
        constants[places.SKY_START], constants[places.SKY_LENGTH] = low, length
        # the field's x axis is turned from the prime meridian by what its frame says
        constants[places.MERIDIAN] = np.mod(zero + self.field.meridian, 2 * np.pi)
        constants[places.SPIN] = spin
        # all can be written to: one that cannot would be another type to the compiler
        moons = np.array(sky.moons if self.moons else np.zeros((0, sky.moons.shape[1])))
        gms = np.array(sky.moon_gms if self.moons else ())
        series = _series(columns, low, length, pieces)
        return places.Forces(constants, series, self.field.terms(), moons, gms)


def _series(
    columns: Callable[[Times], NDArray[np.float64]], start: float, length: float, pieces: int
) -> NDArray[np.float64]:
    """Chebyshev series of the columns of a function on equal pieces, shape (pieces, c, d + 1)."""
    from numpy.polynomial import chebyshev

    k = np.arange(DEGREE + 1)
    nodes = np.cos(np.pi * (k + 0.5) / (DEGREE + 1))
    times = start + length * (np.arange(pieces)[:, None] + 0.5 * (nodes + 1.0))
    values = columns(times.ravel()).reshape(pieces, DEGREE + 1, -1)
    to_series = chebyshev.chebvander(nodes, DEGREE).T * (2.0 / (DEGREE + 1))
    to_series[0] *= 0.5
    return np.ascontiguousarray(np.einsum("kn,pnc->pck", to_series, values))

"""The world of an entry: planet, rotation, atmosphere and vehicle, as the kernels want it."""

from dataclasses import dataclass, replace
from math import isfinite
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import (
    MARS_EQUATORIAL_RADIUS,
    MARS_GM,
    MARS_J2_RADIUS,
    MARS_ROTATION_RATE,
)
from compass.entry.atmosphere import Atmosphere
from compass.entry.vehicle import Vehicle
from compass.errors import ArgumentError

Rotation = Literal["none", "coriolis", "full", "published-coriolis"]


@dataclass(frozen=True)
class EntryModel:
    """Everything the equations of motion depend on but the state.

    Attributes
    ----------
    vehicle, atmosphere
        What flies, and in what.
    rotation
        ``none``: planet at rest; ``coriolis``: terms of first order in the rotation rate;
        ``full``: Coriolis and centrifugal; ``published-coriolis``: the Coriolis terms of the
        flight-path and heading rates exchanged, as Yu et al. 2018 print eq. 1 (wrong, kept for
        comparison).
    gm
        Gravitational parameter, m^3/s^2.
    planet_radius
        Radius of the sphere that blocks the view and ends the flight, metres.
    rotation_rate
        Rad/s; of no effect with ``none``.
    j2
        Second zonal of the gravity field, about `compass.bodies.MARS_J2_RADIUS`; 0 for a point.
    """

    vehicle: Vehicle
    atmosphere: Atmosphere
    rotation: Rotation = "full"
    gm: float = MARS_GM.value
    planet_radius: float = MARS_EQUATORIAL_RADIUS.value
    rotation_rate: float = MARS_ROTATION_RATE.value
    j2: float = 0.0

    def __post_init__(self) -> None:
        if self.rotation not in get_args(Rotation):
            allowed = ", ".join(get_args(Rotation))
            raise ArgumentError(f"rotation = {self.rotation!r}: allowed {allowed}")
        if self.atmosphere.winds and self.rotation == "published-coriolis":
            raise ArgumentError(
                'rotation = "published-coriolis": is of air that turns with the planet; leave the '
                "winds out"
            )
        for name in ("gm", "planet_radius"):
            if not 0 < getattr(self, name) < float("inf"):
                raise ArgumentError(f"{name} = {getattr(self, name)}: must be positive")
        if not isfinite(self.rotation_rate):
            raise ArgumentError(f"rotation_rate = {self.rotation_rate}: must be finite")

    @property
    def omega(self) -> float:
        """Rate at which the Mars-fixed axes turn, rad/s: zero for a planet at rest."""
        return 0.0 if self.rotation == "none" else self.rotation_rate

    @property
    def terms(self) -> float:
        """Number by which kernels know the terms of the rotation."""
        from compass.core.entry.rates import CENTRIFUGAL, CORIOLIS, SWAPPED

        return {"full": CENTRIFUGAL, "published-coriolis": SWAPPED}.get(self.rotation, CORIOLIS)

    def flight_parameters(self) -> NDArray[np.float64]:
        """Parameter array of `compass.core.entry.rates`."""
        air, craft = self.atmosphere, self.vehicle
        head = [
            self.gm,
            1.5 * self.j2 * self.gm * MARS_J2_RADIUS.value**2,
            self.omega,
            self.terms,
            air.log_reference_density,
            air.reference_radius,
            air.scale_height,
            craft.drag_area_per_mass,
            craft.lift_to_drag,
            len(air.winds),
        ]
        winds = np.array(air.winds, dtype=float).reshape(-1, 3)
        return np.concatenate([head, air.table_radius, np.log(air.table_density), winds.T.ravel()])

    def full_state(self, state: ArrayLike) -> NDArray[np.float64]:
        """State of eight: ``[r, lon, lat, V, gamma, psi]`` with ln rho0 and L/D put behind."""
        six = np.asarray(state, dtype=float)[..., :6]
        tail = [self.atmosphere.log_reference_density, self.vehicle.lift_to_drag]
        return np.concatenate([six, np.broadcast_to(tail, (*six.shape[:-1], 2))], axis=-1)

    def truth(self, density_bias: float = 0.0, scale_height_factor: float = 1.0) -> "EntryModel":
        """Return the model with the atmosphere as it might really be; see `Atmosphere.changed`."""
        changed = self.atmosphere.changed(
            density_bias=density_bias, scale_height_factor=scale_height_factor
        )
        return replace(self, atmosphere=changed)

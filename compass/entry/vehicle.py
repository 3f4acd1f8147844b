"""The entry vehicle: how it answers to the air, and how it is steered."""

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Vehicle:
    """A lander in its aeroshell.

    Attributes
    ----------
    drag_area_per_mass
        ``B = C_D S / m``, m^2/kg; its inverse is the ballistic coefficient.
    lift_to_drag
        ``kappa = L/D``.
    bank_times, bank_angles
        Bank commands: the angle (radians, positive turns the velocity clockwise) holds from
        its time (s, strictly increasing, the first holds before it too) to the next.
    nose_radius
        Effective radius for the stagnation-point heat flux, metres.
    """

    drag_area_per_mass: float
    lift_to_drag: float
    bank_times: tuple[float, ...] = (0.0,)
    bank_angles: tuple[float, ...] = (0.0,)
    nose_radius: float = 1.0

    def __post_init__(self) -> None:
        if not (isfinite(self.drag_area_per_mass) and self.drag_area_per_mass >= 0):
            raise ArgumentError(
                f"drag_area_per_mass = {self.drag_area_per_mass} m^2/kg: must be 0 or more"
            )
        if not isfinite(self.lift_to_drag):
            raise ArgumentError(f"lift_to_drag = {self.lift_to_drag}: must be a finite number")
        if not self.nose_radius > 0:
            raise ArgumentError(f"nose_radius = {self.nose_radius} m: must be positive")
        if len(self.bank_times) != len(self.bank_angles) or not self.bank_times:
            raise ArgumentError(
                f"bank: {len(self.bank_times)} times and {len(self.bank_angles)} angles; "
                "give as many of one as of the other, and at least one"
            )
        if np.any(np.diff(self.bank_times) <= 0):
            raise ArgumentError(f"bank: times {list(self.bank_times)} s must increase strictly")

    def bank_schedule(self) -> NDArray[np.float64]:
        """Times and angles as the flight's kernels take them, shape (k, 2)."""
        return np.column_stack([self.bank_times, self.bank_angles])

    def bank(self, times: ArrayLike) -> NDArray[np.float64]:
        """Bank angle in force at times (s, any shape), radians."""
        index = np.searchsorted(self.bank_times, np.asarray(times, dtype=float), side="right") - 1
        return np.asarray(self.bank_angles)[np.maximum(index, 0)]

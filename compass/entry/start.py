"""What a flight is asked for: a state it can start from, and what to notice on the way down."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from compass.entry.model import EntryModel
from compass.errors import ArgumentError


@dataclass(frozen=True)
class Trigger:
    """Something to be noticed on the way down: the first fall to a level.

    Attributes
    ----------
    name
        What to call it.
    quantity
        ``altitude`` (m over the planet's sphere), ``speed`` (m/s over the ground) or ``mach``
        (of the speed through the air).
    level
        In the quantity's unit.
    """

    name: str
    quantity: Literal["altitude", "speed", "mach"]
    level: float


def check_start(model: EntryModel, x: NDArray[np.float64]) -> None:
    """Raise `ArgumentError` unless a flight can start from state `x`, as said of `fly`."""
    if not np.isfinite(x).all():
        raise ArgumentError("entry state: every component must be a finite number")
    if x[0] <= model.planet_radius:
        raise ArgumentError(
            f"entry.radius_km = {x[0] / 1e3:g}: not above the ground; must be more than "
            f"{model.planet_radius / 1e3:g} km"
        )
    if x[3] <= 0:
        raise ArgumentError(f"entry.speed_m_s = {x[3]:g}: must be above 0")
    if abs(np.cos(x[4])) < 1e-6:
        raise ArgumentError(
            f"entry.flight_path_deg = {np.degrees(x[4]):g}: vertical, the heading is undefined; "
            "must be strictly between -90 and 90"
        )

"""Where the satellites are: patterns of orbits and their motion.

Names are loaded on first use: a constellation needs no compiled kernel, its motion does.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from compass.orbits.constellation import Constellation, keplerian
    from compass.orbits.pattern import Pattern
    from compass.orbits.patterns import from_elements, rosette, walker_delta, walker_star
    from compass.orbits.period import (
        RepeatPeriod,
        areosynchronous_radius,
        areosynchronous_radius_km,
        orbital_period,
        repeat_period,
    )
    from compass.orbits.positions import ephemeris, positions_mci, positions_mcmf, states_mci

__all__ = [
    "Constellation",
    "Pattern",
    "RepeatPeriod",
    "areosynchronous_radius",
    "areosynchronous_radius_km",
    "ephemeris",
    "from_elements",
    "keplerian",
    "orbital_period",
    "positions_mci",
    "positions_mcmf",
    "repeat_period",
    "rosette",
    "states_mci",
    "walker_delta",
    "walker_star",
]

_HOMES = {
    "constellation": ("Constellation", "keplerian"),
    "pattern": ("Pattern",),
    "patterns": ("from_elements", "rosette", "walker_delta", "walker_star"),
    "period": (
        "RepeatPeriod",
        "areosynchronous_radius",
        "areosynchronous_radius_km",
        "orbital_period",
        "repeat_period",
    ),
    "positions": ("ephemeris", "positions_mci", "positions_mcmf", "states_mci"),
}


def __getattr__(name: str) -> object:
    """Import a name from its file on first use (PEP 562)."""
    for home, names in _HOMES.items():
        if name in names:
            module = import_module(f"compass.orbits.{home}")
            for each in names:
                globals()[each] = getattr(module, each)
            return globals()[name]
    raise AttributeError(f"module 'compass.orbits' has no attribute {name!r}")

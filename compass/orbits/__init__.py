"""Where the satellites are: patterns of orbits and their motion."""

from compass.orbits.constellation import Constellation, keplerian
from compass.orbits.ephemeris import ephemeris, positions_mci, positions_mcmf, states_mci
from compass.orbits.pattern import Pattern
from compass.orbits.patterns import from_elements, rosette, walker_delta, walker_star
from compass.orbits.period import (
    RepeatPeriod,
    areosynchronous_radius,
    orbital_period,
    repeat_period,
)

__all__ = [
    "Constellation",
    "Pattern",
    "RepeatPeriod",
    "areosynchronous_radius",
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

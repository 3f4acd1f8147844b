"""Where the satellites are: patterns of orbits and their motion."""

from compass.orbits.constellation import Constellation, Pattern, from_elements
from compass.orbits.ephemeris import ephemeris, positions_mci, positions_mcmf, states_mci
from compass.orbits.period import (
    RepeatPeriod,
    areosynchronous_radius,
    orbital_period,
    repeat_period,
)
from compass.orbits.rosette import rosette
from compass.orbits.walker import walker_delta, walker_star

__all__ = [
    "Constellation",
    "Pattern",
    "RepeatPeriod",
    "areosynchronous_radius",
    "ephemeris",
    "from_elements",
    "orbital_period",
    "positions_mci",
    "positions_mcmf",
    "repeat_period",
    "rosette",
    "states_mci",
    "walker_delta",
    "walker_star",
]

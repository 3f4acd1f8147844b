"""Design navigation constellations around Mars: coverage, geometry, landing navigation.

The public names are loaded when first used, so ``import compass`` and ``compass --help``
cost milliseconds; numba, xarray and matplotlib come in with the first call that needs them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the same names for editors and type checkers
    from compass.api.fold import fold
    from compass.inputs import read_design
    from compass.orbits import (
        Constellation,
        areosynchronous_radius,
        ephemeris,
        from_elements,
        rosette,
        walker_delta,
        walker_star,
    )
    from compass.sites import Mask, Site
    from compass.study.mapping import MapOptions, make_map

__version__ = "0.1.0"

__all__ = [
    "Constellation",
    "MapOptions",
    "Mask",
    "Site",
    "__version__",
    "areosynchronous_radius",
    "ephemeris",
    "fold",
    "from_elements",
    "make_map",
    "read_design",
    "rosette",
    "walker_delta",
    "walker_star",
]

#: Where a public name lives: its command's file, or this.
_HOMES = {
    "fold": "compass.api.fold",
    "read_design": "compass.inputs",
    "MapOptions": "compass.study.mapping",
    "make_map": "compass.study.mapping",
    "Constellation": "compass.orbits",
    "walker_delta": "compass.orbits",
    "walker_star": "compass.orbits",
    "rosette": "compass.orbits",
    "from_elements": "compass.orbits",
    "ephemeris": "compass.orbits",
    "areosynchronous_radius": "compass.orbits",
    "Mask": "compass.sites",
    "Site": "compass.sites",
}


def __getattr__(name: str) -> object:
    """Import a public name from its home on first use (PEP 562)."""
    if name in _HOMES:
        found = globals()[name] = getattr(import_module(_HOMES[name]), name)
        return found
    raise AttributeError(f"module 'compass' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

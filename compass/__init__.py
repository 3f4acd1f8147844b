"""Design navigation constellations around Mars: coverage, geometry, landing navigation.

The public names are loaded when first used, so ``import compass`` and ``compass --help``
cost milliseconds; numba, xarray and matplotlib come in with the first call that needs them.
"""

from importlib import import_module

__version__ = "0.1.0"

_HOMES = {
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

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> object:
    """Import a public name from its home on first use (PEP 562)."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'compass' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

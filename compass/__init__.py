"""Design navigation constellations around Mars: coverage, geometry, landing navigation.

The public names are loaded when first used, so ``import compass`` and ``compass --help``
cost milliseconds; numba, xarray and matplotlib come in with the first call that needs them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the same names for editors and type checkers
    from compass.api.access import access
    from compass.api.check import check
    from compass.api.deploy import deploy
    from compass.api.determine import determine
    from compass.api.drift import drift
    from compass.api.export import export
    from compass.api.fold import fold
    from compass.api.horizon import horizon
    from compass.api.judge import judge
    from compass.api.keep import keep
    from compass.api.land import land
    from compass.api.locate import locate
    from compass.api.map import map
    from compass.api.new import new
    from compass.api.optimize import optimize
    from compass.api.reproduce import reproduce
    from compass.api.schema import schema
    from compass.api.search import search
    from compass.api.series import series
    from compass.api.show import show
    from compass.api.trade import trade
    from compass.api.version import version
    from compass.api.warm import warm
    from compass.design import Design
    from compass.entry.intersection import covariance_intersection, intersection_weights
    from compass.inputs import read_design
    from compass.inputs.scenario import read_scenario
    from compass.inputs.study import read_study
    from compass.orbits import (
        Constellation,
        areosynchronous_radius_km,
        ephemeris,
        from_elements,
        rosette,
        walker_delta,
        walker_star,
    )
    from compass.pages.report import report
    from compass.pages.view import view
    from compass.requirement import Requirement
    from compass.sites import Mask, Site

__version__ = "0.1.0"

__all__ = [
    "Constellation",
    "Design",
    "Mask",
    "Requirement",
    "Site",
    "__version__",
    "access",
    "areosynchronous_radius_km",
    "check",
    "covariance_intersection",
    "deploy",
    "determine",
    "drift",
    "ephemeris",
    "export",
    "fold",
    "from_elements",
    "horizon",
    "intersection_weights",
    "judge",
    "keep",
    "land",
    "locate",
    "map",
    "new",
    "optimize",
    "read_design",
    "read_scenario",
    "read_study",
    "report",
    "reproduce",
    "rosette",
    "schema",
    "search",
    "series",
    "show",
    "trade",
    "version",
    "view",
    "walker_delta",
    "walker_star",
    "warm",
]

#: The commands, each in the file of `compass.api` that has its name.
_COMMANDS = (
    "access",
    "check",
    "deploy",
    "determine",
    "drift",
    "export",
    "fold",
    "horizon",
    "judge",
    "keep",
    "land",
    "locate",
    "map",
    "new",
    "optimize",
    "reproduce",
    "schema",
    "search",
    "series",
    "show",
    "trade",
    "version",
    "warm",
)

#: Where the other public names live.
_HOMES = {
    "Constellation": "compass.orbits",
    "Design": "compass.design",
    "Mask": "compass.sites",
    "Requirement": "compass.requirement",
    "Site": "compass.sites",
    "areosynchronous_radius_km": "compass.orbits",
    "covariance_intersection": "compass.entry.intersection",
    "ephemeris": "compass.orbits",
    "from_elements": "compass.orbits",
    "intersection_weights": "compass.entry.intersection",
    "read_design": "compass.inputs",
    "read_scenario": "compass.inputs.scenario",
    "read_study": "compass.inputs.study",
    "report": "compass.pages.report",
    "rosette": "compass.orbits",
    "view": "compass.pages.view",
    "walker_delta": "compass.orbits",
    "walker_star": "compass.orbits",
} | {name: f"compass.api.{name}" for name in _COMMANDS}


def __getattr__(name: str) -> object:
    """Import a public name from its home on first use (PEP 562)."""
    if name in _HOMES:
        loaded = globals()[name] = getattr(import_module(_HOMES[name]), name)
        return loaded
    guesses: list[str] = []
    if not name.startswith("_"):  # as programs ask, not people
        from compass.errors import SHORT, near

        guesses = near(name, _HOMES, likeness=SHORT)
    meant = f"; did you mean compass.{guesses[0]}?" if guesses else ""
    raise AttributeError(f"module 'compass' has no attribute {name!r}{meant}")


def __dir__() -> list[str]:
    return sorted(__all__)

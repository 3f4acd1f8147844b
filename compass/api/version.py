"""Which version this is, and on what it runs: the first lines of a report of a fault."""

import platform
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from typing import Any

from compass import __version__
from compass.api.results import Result
from compass.document import Page, Table, Verdict

#: Packages whose version changes numbers or pictures.
PACKAGES = ("numpy", "scipy", "numba", "xarray", "shapely", "pyproj", "matplotlib", "pydantic",
            "h5netcdf", "dask", "pymoo")  # fmt: skip


@dataclass(frozen=True, repr=False)
class VersionResult(Result):
    """The version of compass, of Python, of the machine and of the packages that matter.

    Attributes
    ----------
    compass, python, machine
        As they name themselves.
    packages
        Version by name, of those that are installed.
    """

    compass: str
    python: str
    machine: str
    packages: Mapping[str, str]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "compass": self.compass,
            "python": self.python,
            "machine": self.machine,
            "packages": dict(self.packages),
        }

    def document(self) -> Page:
        """The version first, then what it runs on."""
        rows = [("Python", self.python), ("machine", self.machine), *self.packages.items()]
        return Page("compass", (Verdict("", self.compass), Table("Runs on", ("", ""), tuple(rows))))


def version() -> VersionResult:
    """Return the version of compass and of what it runs on; imports none of it.

    Examples
    --------
    >>> import compass
    >>> compass.version().compass == compass.__version__
    True
    """
    packages = {name: number for name in PACKAGES if (number := _version(name))}
    return VersionResult(__version__, platform.python_version(), platform.platform(), packages)


def _version(name: str) -> str:
    try:
        return version_of(name)
    except PackageNotFoundError:
        return ""

"""Files of requirements: what a constellation that is still looked for must do."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from compass.errors import DesignError
from compass.frames import FIGURES, Figure
from compass.inputs.design import mask_of, place_faults, read_design_text, site_of
from compass.inputs.models import CoverageTable, StationTable
from compass.inputs.reading import parse, read_text, tables_of
from compass.inputs.requirements import RequirementTable, requirement_faults, requirements_of
from compass.inputs.signal import SignalTable, signal_faults, signal_of_table
from compass.inputs.table import Table
from compass.ranging import Signal
from compass.requirement import Requirement
from compass.saving import readable
from compass.sites import Mask


@dataclass(frozen=True)
class Needs:
    """What is needed, of whatever constellation.

    Attributes
    ----------
    name
        What to call it.
    figure, mask, requirements, signal
        As of `compass.design.Design`.
    """

    name: str
    figure: Figure
    mask: Mask
    requirements: tuple[Requirement, ...]
    signal: Signal | None = None


class RequirementFile(Table):
    """A whole file of requirements."""

    name: str = Field("requirements", min_length=1, max_length=200, description="what to call it")
    source: str = Field("", description="where the requirements come from")
    figure: Literal["iau-sphere", "iau-ellipsoid", "kelly2018-sphere"] = Field(
        "iau-sphere", description="reference figure of Mars"
    )
    coverage: CoverageTable = Field(
        default_factory=lambda: CoverageTable.model_validate({}), description="mask of users"
    )
    station: list[StationTable] = Field(
        default_factory=list, max_length=1000, description="one [[station]] a place"
    )
    signal: SignalTable | None = Field(None, description="what a user's ranges are worth")
    requirement: list[RequirementTable] = Field(
        min_length=1, max_length=100, description="one [[requirement]] a thing wanted"
    )


def read_needs(path: str | Path) -> Needs:
    """Read a file of requirements, or take those of a design file.

    Raises
    ------
    DesignError
        With every fault of the file, or a design that requires nothing.
    """
    text, label = read_text(Path(path)), readable(path)
    if "[constellation]" in text and "constellation" in _tables(text):
        design = read_design_text(text, label)
        if not design.requirements:
            raise DesignError(f"{label}: requires nothing; add a [[requirement]]")
        wanted = design.requirements
        return Needs(design.name, design.figure, design.mask, wanted, design.signal)
    file = parse(text, label, RequirementFile, _faults)
    figure = FIGURES[file.figure]
    stations = tuple(site_of(station, figure) for station in file.station)
    wanted = requirements_of(file.requirement, stations)
    signal = None if file.signal is None else signal_of_table(file.signal)
    return Needs(file.name, figure, mask_of(file.coverage), wanted, signal)


def _tables(text: str) -> dict[str, Any]:
    try:
        return tables_of(text)
    except ValueError:
        return {}


def _faults(raw: dict[str, Any]) -> list[str]:
    return place_faults(raw) + requirement_faults(raw) + signal_faults(raw)

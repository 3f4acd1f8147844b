"""What the functions are given: a thing, or the path of the file that describes it."""

from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from compass.design import Design
from compass.errors import ArgumentError, said_of
from compass.inputs import read_design
from compass.sites import Mask, Site

if TYPE_CHECKING:
    from compass.inputs.scenario import Scenario
    from compass.inputs.study import Study


def given_design(design: Design | str | Path) -> Design:
    """Return the design, read from its file if it is a path.

    Raises
    ------
    DesignError
        As `compass.read_design`.
    ArgumentError
        It is something else.
    """
    if isinstance(design, Design):
        return design
    if isinstance(design, str | Path):
        return read_design(design)
    raise ArgumentError(
        f"design = {type(design).__name__}: must be a Design or the path of a design file"
    )


def given_scenario(scenario: "Scenario | str | Path") -> "Scenario":
    """Return the scenario, read from its file if it is a path.

    Raises
    ------
    DesignError
        As `compass.read_scenario`.
    ArgumentError
        It is something else.
    """
    from compass.inputs.scenario import Scenario, read_scenario

    if isinstance(scenario, Scenario):
        return scenario
    if isinstance(scenario, str | Path):
        return read_scenario(scenario)
    raise ArgumentError(
        f"scenario = {type(scenario).__name__}: must be a Scenario or the path of a scenario file"
    )


def given_study(study: "Study | str | Path") -> "Study":
    """Return the study, read from its file if it is a path; errors as `given_scenario`."""
    from compass.inputs.study import Study, read_study

    if isinstance(study, Study):
        return study
    if isinstance(study, str | Path):
        return read_study(study)
    raise ArgumentError(
        f"study = {type(study).__name__}: must be a Study or the path of a study file"
    )


def given_mask(mask_deg: float | None, design: Design) -> Mask:
    """Return a constant mask of degrees, or the design's where they are None.

    Raises
    ------
    ArgumentError
        Outside 0 up to below 90 degrees.
    """
    if mask_deg is None:
        return design.mask
    if not 0 <= mask_deg < 90:
        raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed 0 up to below 90 degrees")
    return Mask.constant(radians(mask_deg))


def given_site(station: Site | str, design: Design) -> Site:
    """Return a site, read from ``NAME=LAT,LON[,MASK]`` in degrees if it is a text.

    Raises
    ------
    ArgumentError
        The text is none of that form, or no place on Mars.
    """
    if isinstance(station, Site):
        return station
    name, equals, rest = station.partition("=")
    try:
        numbers = [float(part) for part in rest.split(",")]
    except ValueError:
        numbers = []
    if not (name.strip() and equals) or len(numbers) not in (2, 3):
        raise ArgumentError(
            f"station {station!r}: not NAME=LAT,LON or NAME=LAT,LON,MASK; "
            "write for example 'Gale=-4.6,137.4,10'"
        )
    latitude, longitude, mask = (*numbers, 0.0)[:3]
    with said_of(f"station {station!r}"):
        return Site.of(
            name.strip(),
            latitude_deg=latitude,
            longitude_deg=longitude,
            mask_deg=mask,
            figure=design.figure,
        )

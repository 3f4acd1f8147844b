"""The table ``[motion]`` of a design: which forces, from which files."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.errors import ArgumentError, DesignError
from compass.inputs.faults import fault
from compass.inputs.models import MotionTable
from compass.orbits.motion import Motion

if TYPE_CHECKING:
    from compass.orbits.gravity import GravityField
    from compass.orbits.trajectory import Trajectory

#: Degree of the field where none is given: beyond it a satellite at 20,000 km moves by less than
#: a centimetre in 100 days.
DEGREE = 8


def motion_of_table(
    table: MotionTable, folder: Path, label: str, ephemeris: "Trajectory | None" = None
) -> Motion:
    """Motion of a design's table; files are looked for beside the design.

    Raises
    ------
    DesignError
        A gravity file that cannot be used, or of too low a degree.
    """
    if ephemeris is not None:
        return Motion("ephemeris", table=ephemeris)
    if table.model != "numerical":
        return Motion(table.model)
    from compass.orbits.forces import ForceModel
    from compass.orbits.gravity import built_in_field, read_field

    degree = DEGREE if table.gravity_degree is None else table.gravity_degree
    try:
        field = built_in_field()
        if table.gravity_file is not None:
            field = read_field(folder / table.gravity_file, table.gravity_frame)
        if degree > field.degree:
            raise DesignError(_too_low(table.gravity_degree, field))
        forces = ForceModel(
            field.truncated(degree),
            table.sun,
            table.moons,
            table.radiation_m2_kg,
            table.shadow,
        )
    except ArgumentError as error:
        raise DesignError(f"{label}: motion.{error}") from error
    except DesignError as error:
        raise DesignError(f"{label}: {error}") from error
    return Motion("numerical", forces)


def _too_low(asked: int | None, field: "GravityField") -> str:
    """Refuse a field that ends below the degree that is asked for, or taken if none is."""
    wanted = f" = {asked}" if asked else f": {DEGREE} if left out"
    return (
        f"motion.gravity_degree{wanted}: allowed 2 to {field.degree}, the degree of {field.name}; "
        "write one of these, or give a fuller gravity_file"
    )


def motion_faults(raw: dict[str, Any]) -> list[str]:
    """Faults between fields of ``[motion]`` and ``[constellation]``, found on the raw tables."""
    table, faults = raw.get("motion"), []
    constellation = raw.get("constellation")
    by_table = isinstance(constellation, dict) and constellation.get("pattern") == "ephemeris"
    if not isinstance(table, dict):
        return []
    if by_table:
        return ["motion: the files of an ephemeris say how satellites move; leave the table out"]
    if table.get("model", "two-body") != "numerical":
        faults += [
            fault(f"motion.{key}", table[key], 'counts with model = "numerical" only; add that')
            for key in sorted(set(table) - {"model"})
            if key in MotionTable.model_fields
        ]
    if "gravity_frame" in table and "gravity_file" not in table:
        faults.append(
            fault("motion.gravity_frame", table["gravity_frame"], "is of a gravity_file; add it")
        )
    return faults

"""Columns of what a study keeps of each requirement, site or region by itself."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.document import Bracket, Proven, Value
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities import Quantity
from compass.quantities.merits import merits_of, worked_out
from compass.study.candidates import make_constellation

#: A heading, what the values under it are, and their column, or those of their bounds.
Shown = tuple[str, Quantity, tuple[str, ...]]


def each_placed(
    study: Study,
    stage: str,
    columns: Iterable[str],
    rows: NDArray,
    find: Callable[[Constellation, float], dict[str, float]],
) -> dict[str, NDArray[np.float64]]:
    """Figures and columns of a stage, shape (n,) each, found for one candidate after the other.

    Tracks of orbits that the study names are closed, their nodes as candidates stand at the epoch.

    Parameters
    ----------
    study, stage, columns, rows
        Whose candidates these are, and what the stage keeps besides its figures.
    find
        Both of a constellation above a mask, radians.
    """
    each = [find(*placed(study, row)) for row in rows]
    known = {
        name: np.array([one[name] for one in each], dtype=float)
        for name in (*merits_of(stage), *columns)
    }
    return worked_out(stage, known) | {name: known[name] for name in columns}


def placed(study: Study, row: np.void) -> tuple[Constellation, float]:
    """A candidate's orbits, with the tracks declared closed that are, and its mask, radians."""
    repeat = study.space.repeat(float(row["radius_km"]))
    return replace(make_constellation(row), repeat=repeat), float(np.radians(row["mask_deg"]))


def shown(asked: Iterable[Shown], figures: Any) -> list[tuple[str, tuple[Value, ...]]]:
    """Headings and the candidates' values; those that nobody has are left out.

    Parameters
    ----------
    asked
        What there may be.
    figures
        A mapping, or a dataset, of values by the names of columns, shape (n,) each.
    """
    found = []
    for heading, known, names in asked:
        columns = [np.asarray(figures[name], dtype=float) for name in names]
        values = tuple(_value(known, *ends) for ends in zip(*columns, strict=True))
        if any(value.value is not None for value in values):
            found.append((heading, values))
    return found


def _value(known: Quantity, *ends: float) -> Value:
    """A value, or what lies between proven bounds: of these the worse."""
    if np.isnan(ends).any():
        return Value(known, None)
    if len(ends) == 1:
        return Value(known, float(ends[0]))
    low, high = map(float, ends)
    worse = low if known.better == "more" else high
    return Value(known, worse, Bracket(low, high) if low < high else Proven())

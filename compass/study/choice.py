"""Which candidates stand out: the finalists of a study, each with what it is best at."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities.merits import MERITS
from compass.study.bounds import bracketed_figures, ends
from compass.study.candidates import PATTERNS, ROW, make_constellation
from compass.study.draw_bounds import half_widths
from compass.study.sampling import map_errors

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Finalist:
    """A candidate that stands out.

    Attributes
    ----------
    role
        What it is best at.
    row
        The candidate, of dtype `compass.study.candidates.ROW`.
    figures
        Its figures of merit.
    errors
        By how much those that are sampled over area and time may be off; half the width of those
        between bounds.
    brackets
        Proven bounds, of those that have them.
    """

    role: str
    row: np.void
    figures: dict[str, float]
    errors: dict[str, float] = field(default_factory=dict)
    brackets: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """Of pattern."""
        return PATTERNS[self.row["pattern"]]

    @property
    def constellation(self) -> Constellation:
        """Its orbits."""
        return make_constellation(self.row)

    @property
    def mask_deg(self) -> float:
        """Mask under which it was looked at, degrees."""
        return float(self.row["mask_deg"])

    @property
    def variables(self) -> dict[str, float]:
        """What it is, but for the kind of pattern."""
        return {name: self.row[name].item() for name in ROW.names or () if name != "pattern"}

    @property
    def notation(self) -> str:
        """Pattern and orbit in short."""
        return notation(self.constellation)


def notation(c: Constellation) -> str:
    """Pattern and orbit in short."""
    if c.pattern is None:
        return f"{c.size} satellites by their elements"
    kind = c.pattern.kind.removeprefix("walker-")
    return f"{kind} {c.pattern.notation}, {c.semi_major_axis[0] / 1e3:.0f} km"


def rows_in(results: "xr.Dataset") -> NDArray:
    """Candidates of a dataset of results, of dtype `ROW`."""
    rows = np.empty(results.sizes["candidate"], ROW)
    for name in ROW.names or ():
        values = results[name].values
        rows[name] = [PATTERNS.index(v) for v in values] if name == "pattern" else values
    return rows


def finalists_of(study: Study, results: "xr.Dataset") -> list[Finalist]:
    """Pick from the first front: the balanced one, then the best in each objective.

    Balanced is the least of the largest shortfalls, each objective's shortfall from the front's
    best being measured in ranges of the front (Chebyshev distance from the ideal point); of equals
    the next largest decides. Ties in one objective fall to the more balanced. If the study compares
    with a design, the most balanced feasible candidate of that design's size is added. Whoever
    wins twice has both roles.
    """
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    if not front.sizes["candidate"]:
        return []
    low, width = _scale(study, front)
    place = _by_balance(study, front, low, width)
    wins = [("balanced", front, int(np.argmin(place)))]
    for objective in study.objectives:
        values = objective.sign * front[objective.figure].values
        winner = int(np.lexsort((place, values))[0])
        wins.append((f"{objective.goal} {MERITS[objective.figure].title}", front, winner))
    if study.compare is not None:
        size = study.compare.constellation.size
        alike = results.isel(
            candidate=np.flatnonzero(
                (results.front.values >= 0) & (results.satellites.values == size)
            )
        )
        if alike.sizes["candidate"]:
            best = int(np.argmin(_by_balance(study, alike, low, width)))
            wins.append((f"best of {size} satellites", alike, best))
    found: dict[str, Finalist] = {}
    for role, where, at in wins:
        one = where.isel(candidate=slice(at, at + 1))
        key = str(one.identity.values[0])
        if key in found:
            old = found[key]
            found[key] = replace(old, role=f"{old.role}; {role}")
        else:
            named = (*MERITS, *(o.figure for o in study.objectives))
            figures = {name: float(one[name].values[0]) for name in named}
            row = rows_in(one)
            errors = {name: float(values[0]) for name, values in map_errors(study, row).items()}
            columns = {str(name): one[name].values[0] for name in one.data_vars}
            brackets = brackets_of(study, columns)
            errors |= half_brackets(brackets)
            errors |= half_widths(study, columns)
            found[key] = Finalist(role, row[0], figures, errors, brackets)
    return list(found.values())


def brackets_of(study: Study, known: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Proven bounds of one constellation's figures that have them, of the columns of these."""
    pairs = {
        figure: tuple(float(known[end]) for end in ends(figure))
        for figure in bracketed_figures(study)
        if ends(figure)[0] in known
    }
    return {name: (low, high) for name, (low, high) in pairs.items() if low <= high}


def half_brackets(brackets: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """Half of what lies between each pair of bounds."""
    return {
        name: 0.5 * (high - low) if low < high else 0.0 for name, (low, high) in brackets.items()
    }


def _scale(study: Study, front: "xr.Dataset") -> tuple[NDArray[Any], NDArray[Any]]:
    """Best value of each objective over a front, and the range of its finite values."""
    columns = [o.sign * front[o.figure].values for o in study.objectives]
    finite = [column[np.isfinite(column)] for column in columns]
    low = np.array([column.min() for column in columns])
    width = np.array([np.ptp(some) if some.size else 0.0 for some in finite])
    return low, np.where(width > 0, width, 1.0)


def _by_balance(
    study: Study, some: "xr.Dataset", low: NDArray[Any], width: NDArray[Any]
) -> NDArray[np.int64]:
    """Place of each candidate, the most balanced first."""
    values = np.column_stack([o.sign * some[o.figure].values for o in study.objectives])
    with np.errstate(invalid="ignore"):  # where even the best is infinite, all are alike
        shortfall = np.where(values == low, 0.0, (values - low) / width)
    largest_first = -np.sort(-shortfall, axis=1)
    place = np.empty(len(values), dtype=np.int64)
    place[np.lexsort(largest_first.T[::-1])] = np.arange(len(values))
    return place

"""Which candidates stand out: the finalists of a study, each with what it is best at."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.inputs.merit import MERITS
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.study.candidates import PATTERNS, ROW, make_constellation

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
    """

    role: str
    row: np.void
    figures: dict[str, float]

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
    if c.pattern.multiplier is not None:  # whose notation leaves the inclination out
        kind += f" {np.degrees(c.pattern.inclination):.6g}°:"
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
    best being measured in ranges of the front (Chebyshev distance from the ideal point). Ties in
    one objective fall to the more balanced. If the study compares with a design, the most
    balanced feasible candidate of that design's size is added. Whoever wins twice has both roles.
    """
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    if not front.sizes["candidate"]:
        return []
    low, width = _scale(study, front)
    shortfall = _shortfall(study, front, low, width)
    wins = [("balanced", front, int(np.argmin(shortfall)))]
    for objective in study.objectives:
        values = objective.sign * front[objective.figure].values
        winner = int(np.lexsort((shortfall, values))[0])
        wins.append((f"{objective.goal} {MERITS[objective.figure].title}", front, winner))
    if study.compare is not None:
        size = study.compare.constellation.size
        alike = results.isel(
            candidate=np.flatnonzero(
                (results.front.values >= 0) & (results.satellites.values == size)
            )
        )
        if alike.sizes["candidate"]:
            best = int(np.argmin(_shortfall(study, alike, low, width)))
            wins.append((f"best of {size} satellites", alike, best))
    found: dict[str, Finalist] = {}
    for role, where, place in wins:
        one = where.isel(candidate=slice(place, place + 1))
        key = str(one.identity.values[0])
        if key in found:
            old = found[key]
            found[key] = Finalist(f"{old.role}; {role}", old.row, old.figures)
        else:
            figures = {name: float(one[name].values[0]) for name in MERITS}
            found[key] = Finalist(role, rows_in(one)[0], figures)
    return list(found.values())


def _scale(study: Study, front: "xr.Dataset") -> tuple[NDArray[Any], NDArray[Any]]:
    """Best value and range of each objective over a front, of its finite values."""
    columns = [o.sign * front[o.figure].values for o in study.objectives]
    finite = [column[np.isfinite(column)] for column in columns]
    low = np.array([some.min() if some.size else 0.0 for some in finite])
    width = np.array([np.ptp(some) if some.size else 0.0 for some in finite])
    return low, np.where(width > 0, width, 1.0)


def _shortfall(
    study: Study, some: "xr.Dataset", low: NDArray[Any], width: NDArray[Any]
) -> NDArray[np.float64]:
    values = np.column_stack([o.sign * some[o.figure].values for o in study.objectives])
    worst = ((values - low) / width).max(axis=1)
    return np.asarray(worst, dtype=np.float64)

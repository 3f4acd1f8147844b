"""Which candidates stand out: the finalists of a study, each with what it is best at."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.inputs.merit import MERITS
from compass.inputs.study import Study
from compass.orbits.constellation import Pattern
from compass.study.candidates import PATTERNS, ROW, make_constellation
from compass.study.stages import evaluate

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
    def notation(self) -> str:
        """Pattern and orbit in short."""
        return notation(self.row)


def notation(row: np.void) -> str:
    """Pattern and orbit of a candidate in short."""
    pattern = make_constellation(row).pattern
    assert pattern is not None
    kind = PATTERNS[row["pattern"]].removeprefix("walker-")
    if pattern.multiplier is not None:  # whose notation leaves the inclination out
        kind += f" {row['inclination_deg']:.6g}°:"
    return f"{kind} {pattern.notation}, {row['radius_km']:.0f} km"


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


def compared_mask_deg(study: Study) -> float:
    """Mask under which the design to compare with is judged: the study's first, degrees."""
    mask = study.space.mask_deg
    return mask[0] if isinstance(mask, tuple) else mask.least


def yardstick(study: Study) -> Finalist | None:
    """Put the design to compare with through every stage; None unless a pattern of circles."""
    if study.compare is None:
        return None
    c = study.compare.constellation
    pattern: Pattern | None = c.pattern
    if pattern is None:
        return None
    rows = np.array(
        [
            (
                PATTERNS.index(pattern.kind),
                pattern.satellites,
                pattern.planes,
                pattern.phasing % pattern.planes,
                round(float(np.degrees(pattern.inclination)), 9),
                float(c.semi_major_axis[0]) / 1e3,
                compared_mask_deg(study),
            )
        ],
        ROW,
    )
    figures = dict.fromkeys(MERITS, float("nan"))
    for stage in ("screen", "map", *(("entry",) if study.entry else ())):
        found = evaluate(stage, study, rows)
        figures |= {name: float(values[0]) for name, values in found.figures.items()}
    return Finalist(study.compare.name, rows[0], figures)

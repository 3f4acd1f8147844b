"""Errors of fixes in metres over area and time of many patterns, where a study has a signal."""

import numpy as np
from numpy.typing import NDArray

from compass.core.screen import deciding_phases
from compass.coverage.errors import error_map
from compass.coverage.grid import make_grid
from compass.coverage.view import view
from compass.design import Design
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.requirement import ERRORS
from compass.signal.ranges import range_errors
from compass.sites import Mask
from compass.study.candidates import make_constellation, patterns_of

#: The percentile over area and time of each error that sorts candidates.
PERCENT = 95
NAMES = tuple(f"{error}.p{PERCENT}" for error in ERRORS)


def pattern_errors(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Errors over the whole sphere and the time that decides, m, one sigma, (n,) each.

    As those of `compass.study.pattern_map.map_figures`, at the same phases; nan without a signal.
    """
    if study.signal is None:
        return {name: np.full(rows.size, np.nan) for name in NAMES}
    each = []
    for row, *pattern in zip(rows, *patterns_of(rows)[:4], strict=True):
        c = make_constellation(row)
        first, last = deciding_phases(*pattern)
        epochs = study.map.epochs
        phases = first + (last - first) * (np.arange(epochs) + 0.5) / epochs
        each.append(errors_over(study, c, float(row["mask_deg"]), phases / c.mean_motion[0]))
    return {name: np.array([one[name] for one in each]) for name in NAMES}


def errors_over(
    study: Study, c: Constellation, mask_deg: float, times: NDArray[np.float64]
) -> dict[str, float]:
    """Errors of any orbits by the signal of a study, at some seconds after the epoch."""
    if study.signal is None:
        return dict.fromkeys(NAMES, float("nan"))
    mask = Mask.of(mask_deg)
    design = Design(c, figure=study.figure, mask=mask, signal=study.signal)
    seen = view(c, times, study.figure.equatorial_radius, mask)
    grid = make_grid("equal-area", study.map.step_deg)
    made = error_map(seen, grid, range_errors(design, times), workers=1)
    found = made.cells_error.sel(global_percentile=PERCENT)
    return {name: float(found.sel(error=error)) for name, error in zip(NAMES, ERRORS, strict=True)}

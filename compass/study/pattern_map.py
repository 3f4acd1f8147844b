"""Geometry over area and time of many patterns at once."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from compass.core.pattern_map import FIGURES, map_patterns
from compass.coverage.grid import make_grid
from compass.frames import direction
from compass.inputs.study import Study
from compass.quantities.merits import worked_out
from compass.study.candidates import patterns_of
from compass.study.pattern_errors import pattern_errors


def map_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Dilutions, counts and errors over the whole sphere and the time that decides, (n,) each.

    A pattern shows all it ever shows within a fraction of a revolution, but for turns of the
    sphere; the epochs are spread over that fraction, so few are enough. Zones of latitude are
    taken from rows of equal width: these reach nearer to the poles, where little area is.
    """
    step = study.map.step_deg
    figures = np.empty((rows.size, len(FIGURES)))
    map_patterns(
        patterns_of(rows),
        rows["radius_km"] * 1e3 / study.figure.equatorial_radius,
        np.sin(np.radians(rows["mask_deg"])),
        study.map.epochs,
        places("equal-area", step),
        places("equal-angle", step),
        make_grid("equal-angle", step).columns,
        study.map.pdop_max,
        figures,
    )
    known = dict(zip(FIGURES, figures.T, strict=True))
    return worked_out("map", known | pattern_errors(study, rows))


@lru_cache(maxsize=8)
def places(kind: str, step_deg: float) -> NDArray[np.float64]:
    """Unit vectors to the middles of a grid's cells, row by row from the south, shape (q, 3)."""
    grid = make_grid(kind, step_deg)
    found = direction(grid.latitude[:, np.newaxis], grid.longitude).reshape(-1, 3)
    found.setflags(write=False)  # it is everyone's
    return found

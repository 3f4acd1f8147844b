"""Figures of a study that draws tell, entries or places and moments, and the bounds these leave.

Bounds hold in 95 of 100 cases, each by itself (`compass.quantities.draws`).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.quantities.draws import median_bounds, quantile_bounds, share_bounds
from compass.quantities.merits import MERITS
from compass.requirement import ERRORS
from compass.study.bounds import ends

#: What of entries each figure is of, and which percentile; of shares None. What is counted is so
#: at each moment of an entry.
OF_ENTRIES: dict[str, tuple[str, float | None]] = {
    "in_view.median": ("counts", 50.0),
    "crlb_position_m.p50": ("position_m", 50.0),
    "crlb_position_m.p95": ("position_m", 95.0),
    "crlb_velocity_m_s.p50": ("velocity_m_s", 50.0),
    "crlb_velocity_m_s.p95": ("velocity_m_s", 95.0),
    "share_within_goal": ("within", None),
    "unobservable_share": ("blind", None),
}

#: Percentile of each error of fixes in metres, by the figure.
OF_FIXES = {f"{error}.p95": (error, 95.0) for error in ERRORS}


def drawn_figures(study: Study, stage: str | None = None) -> list[str]:
    """Figures that the study sorts by or limits and that draws bound, of one stage or of any."""
    figures = [name for name in (*OF_FIXES, *OF_ENTRIES) if name in study.named]
    return [name for name in figures if stage in (None, MERITS[name].stage)]


def side_columns(study: Study, stage: str | None = None) -> tuple[str, ...]:
    """Columns of bounds by draws, of figures of one stage or of any."""
    return tuple(name for figure in drawn_figures(study, stage) for name in ends(figure))


def half_widths(study: Study, figures: Mapping[str, Any]) -> dict[str, float]:
    """Half the width of the bounds by draws, of one candidate, where it has them."""
    pairs = {name: [float(figures[end]) for end in ends(name)] for name in drawn_figures(study)}
    return {name: 0.5 * (high - low) for name, (low, high) in pairs.items() if low <= high}


def entry_sides(study: Study, known: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Bounds of what a study names of entries, shape (n,) each, by what is known of n candidates.

    Of what `compass.quantities.merits.worked_out` takes.
    """
    columns: dict[str, NDArray[np.float64]] = {}
    for figure in drawn_figures(study, "entry"):
        name, percent = OF_ENTRIES[figure]
        values = known["position_m"] <= known["goal_m"] if name == "within" else known[name]
        if name == "counts":
            draws = known["position_m"].shape[1]
            pairs = [median_bounds(own, draws, known["longest"]) for own in values]
        elif percent is None:
            pairs = [share_bounds(float(own.mean()), own.size) for own in values]
        else:
            pairs = [quantile_bounds(own, percent) for own in values]
        # what no draw bounds from below is no less than 0 all the same
        low, high = np.array(pairs).reshape(-1, 2).T
        columns |= dict(zip(ends(figure), (np.maximum(low, 0.0), high), strict=True))
    return columns

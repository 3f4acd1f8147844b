"""More draws for candidates whose order is open: entries, or places and moments.

The same for all candidates, from the study's seed; a level draws all that the one before drew, and
more, so that neither the workers nor where a run was stopped matter.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from compass.allowed import MOST_SAMPLES
from compass.core.screen import deciding_phases
from compass.coverage.drawn import Drawn, drawn
from compass.design import Design
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities.draws import quantile_bounds
from compass.quantities.percentile import percentile
from compass.sites import Mask
from compass.study.bounds import ends
from compass.study.candidates import make_constellation, patterns_of
from compass.study.draw_bounds import OF_FIXES, drawn_figures, side_columns
from compass.study.pattern_judging import entry_figures

#: One level after the other, each for those that the one before leaves undecided: how many times
#: the study's entries are drawn, and parts of so many places and moments.
DRAWS = {"draws-1": (4, 1), "draws-2": (16, 4), "draws-3": (64, 16)}

#: More still, for who gives it time.
FURTHER = {"draws-4": (128, 64), "draws-5": (256, 256)}
ALL_DRAWS = DRAWS | FURTHER

#: The level that draws most without that.
MOST_DRAWS = list(DRAWS)[-1]

#: Places and moments of a part; entries at most, and with more time.
PART, MOST_ENTRIES, FURTHEST = 16_384, 4096, MOST_SAMPLES


def drawn_columns(study: Study) -> tuple[str, ...]:
    """What a level stores: the figures drawn anew, and their bounds."""
    return (*drawn_figures(study), *side_columns(study))


def entries_at(level: str, study: Study) -> int:
    """How many entries are drawn at a level; none without a table [entry]."""
    first = 0 if study.entry is None else study.entry.samples
    most = MOST_ENTRIES if level in DRAWS else FURTHEST
    return max(first, min(ALL_DRAWS[level][0] * first, most))


def judging_more(level: str, study: Study) -> Study:
    """The study with the entries of a level."""
    assert study.entry is not None
    return replace(study, entry=replace(study.entry, samples=entries_at(level, study)))


def more_draws(level: str, study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Figures that draws tell, by the draws of a level, and their bounds, shape (n,) each."""
    found: dict[str, NDArray[np.float64]] = {}
    if drawn_figures(study, "entry"):
        found |= entry_figures(judging_more(level, study), rows)
    if drawn_figures(study, "map"):
        each = []
        for row, *pattern in zip(rows, *patterns_of(rows)[:4], strict=True):
            c = make_constellation(row)
            first, last = (phase / c.mean_motion[0] for phase in deciding_phases(*pattern))
            each.append(drawn_fixes(level, study, c, float(row["mask_deg"]), (first, last)))
        found |= {name: np.array([one[name] for one in each]) for name in each[0]}
    return {name: found[name] for name in drawn_columns(study)}


def drawn_fixes(
    level: str, study: Study, c: Constellation, mask_deg: float, span: tuple[float, float]
) -> dict[str, float]:
    """Errors of fixes by random places and moments of a span, and their bounds."""
    design = Design(c, figure=study.figure, mask=Mask.of(mask_deg), signal=study.signal)
    parts = range(ALL_DRAWS[level][1])
    values = Drawn.joined(
        [drawn(design, span, draws=PART, seed=study.seed + k) for k in parts]
    ).values
    found: dict[str, float] = {}
    for figure in drawn_figures(study, "map"):
        error, percent = OF_FIXES[figure]
        found[figure] = float(percentile(values[error], percent))
        found |= dict(zip(ends(figure), quantile_bounds(values[error], percent), strict=True))
    return found

"""What a better clock buys against more satellites: the front's errors with every named clock.

Of fixes on the ground, and of landers.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.clocks import CLOCKS
from compass.inputs.study import Study
from compass.quantities.merits import MERITS
from compass.study.choice import rows_in
from compass.study.pattern_errors import NAMES, pattern_errors
from compass.study.pattern_judging import entry_figures

if TYPE_CHECKING:
    import xarray as xr

#: Candidates of the front that are looked at.
MOST = 25


def errors_by_clock(study: Study, results: "xr.Dataset") -> list[dict[str, Any]]:
    """Errors of candidates on the front with each named clock in the place of the study's own.

    Of the errors in metres that the study sorts by or limits, of fixes and of landers: of each
    the candidates that are best by it, best first, with their own error (`own`) and those with
    each clock (`m`). Nothing where it names none, or where its satellites have no clock whose
    time between uploads counts.
    """
    signal = study.signal
    if signal is None or signal.clock is None:
        return []
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    return [one for figure in _asked(study) for one in _with_each_clock(study, front, figure)]


def _asked(study: Study) -> list[str]:
    """Errors in metres that the study names: the first of fixes, and those of landers."""
    fixes = [name for name in NAMES if name in study.named][:1]
    landers = [
        name
        for name, merit in MERITS.items()
        if name in study.named and merit.stage == "entry" and merit.quantity.unit == "m"
    ]
    return fixes + landers


def _with_each_clock(study: Study, front: "xr.Dataset", figure: str) -> list[dict[str, Any]]:
    """Candidates of the front that are best by a figure, with each clock."""
    assert study.signal is not None
    order = np.argsort(front[figure].values, kind="stable")[:MOST]
    rows, own = rows_in(front)[order], front[figure].values[order]
    figures = pattern_errors if figure in NAMES else entry_figures
    found: list[dict[str, Any]] = [
        {
            "identity": identity,
            "satellites": int(row["satellites"]),
            "figure": figure,
            "own": float(error),
            "m": {},
        }
        for identity, row, error in zip(
            front.identity.values[order].tolist(), rows, own, strict=True
        )
    ]
    for clock in CLOCKS:
        other = replace(study, signal=replace(study.signal, clock=clock))
        for one, error in zip(found, figures(other, rows)[figure], strict=True):
            one["m"][clock.name] = float(error)
    return found

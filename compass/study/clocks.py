"""What a better clock buys against more satellites: the front's errors with every named clock.

Of fixes on the ground, and of landers. A stage finds them, for the best of the front alone.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.clocks import CLOCKS, Clock
from compass.inputs.study import Study
from compass.quantities.merits import MERITS, merits_of
from compass.study.choice import rows_in
from compass.study.pattern_errors import NAMES, pattern_errors
from compass.study.pattern_judging import entry_figures
from compass.study.sampling import sampling_of

if TYPE_CHECKING:
    import xarray as xr

#: Candidates of the front that are looked at, of each error the best.
MOST = 25


def clock_columns(study: Study) -> dict[str, dict[str, Any]]:
    """Columns of errors with each clock but the study's own, and the attributes of each.

    None where the study names no error in metres, or where its satellites have no clock whose
    time between uploads counts.
    """
    columns = {}
    for figure in _errors(study):
        known = MERITS[figure].quantity.attributes() | {"sampled_over": sampling_of(study, figure)}
        for clock in _others(study):
            title = f"{known['long_name']}, with {clock.title}"
            columns[f"{figure}.{clock.name}"] = known | {"long_name": title}
    return columns


def clock_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Errors of candidates with each clock in the place of the study's own, shape (n,) each."""
    assert study.signal is not None
    figures = _errors(study)
    found: dict[str, NDArray[np.float64]] = {}
    finders = [
        find
        for find, names in ((pattern_errors, NAMES), (entry_figures, merits_of("entry")))
        if set(names) & set(figures)
    ]
    for clock in _others(study):
        other = replace(study, signal=replace(study.signal, clock=clock))
        known = {name: value for find in finders for name, value in find(other, rows).items()}
        found |= {f"{figure}.{clock.name}": known[figure] for figure in figures}
    return found


def best_by_errors(study: Study, results: "xr.Dataset") -> NDArray:
    """Candidates of the front that are among the best by an error that the study names."""
    if not clock_columns(study):
        return rows_in(results)[:0]
    front = _front(results)
    each = [_order(front, figure) for figure in _errors(study)]
    return rows_in(front)[np.unique(np.concatenate(each))]


def errors_by_clock(study: Study, results: "xr.Dataset") -> list[dict[str, Any]]:
    """Errors of candidates on the front with each named clock, as the results hold them.

    Of the errors in metres that the study sorts by or limits, of fixes and of landers: of each
    the candidates that are best by it, best first, with their own error (`own`) and those with
    each clock (`m`); without those that no other clock is known of.
    """
    if not clock_columns(study):
        return []
    assert study.signal is not None
    own, front, found = study.signal.clock, _front(results), []
    for figure in _errors(study):
        for k in _order(front, figure):
            one = front.isel(candidate=k)
            error = float(one[figure])
            errors = {
                clock.name: error if clock == own else float(one[f"{figure}.{clock.name}"])
                for clock in CLOCKS
            }
            if not np.isnan(list(errors.values())).any():
                told = {"identity": str(one.identity.values), "satellites": int(one.satellites)}
                found.append(told | {"figure": figure, "own": error, "m": errors})
    return found


def _errors(study: Study) -> list[str]:
    """Errors in metres that the study names: the first of fixes, and those of landers."""
    fixes = [name for name in NAMES if name in study.named][:1]
    landers = [
        name
        for name, merit in MERITS.items()
        if name in study.named and merit.stage == "entry" and merit.quantity.unit == "m"
    ]
    return fixes + landers


def _others(study: Study) -> list[Clock]:
    """Named clocks but the study's own; none where that does not count."""
    own = None if study.signal is None else study.signal.clock
    return [] if own is None else [clock for clock in CLOCKS if clock != own]


def _front(results: "xr.Dataset") -> "xr.Dataset":
    return results.isel(candidate=np.flatnonzero(results.front.values == 0))


def _order(front: "xr.Dataset", figure: str) -> NDArray[np.int64]:
    """Places of the best of a front by a figure, the best first."""
    return np.argsort(front[figure].values, kind="stable")[:MOST]

"""What a better clock buys against more satellites: the front's errors with every named clock."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.clocks import CLOCKS
from compass.inputs.study import Study
from compass.study.choice import rows_in
from compass.study.pattern_errors import NAMES, pattern_errors

if TYPE_CHECKING:
    import xarray as xr

#: Candidates of the front that are looked at.
MOST = 25


def errors_by_clock(study: Study, results: "xr.Dataset") -> list[dict[str, Any]]:
    """Errors of candidates on the front with each named clock in the place of the study's own.

    Of the first error in metres that the study sorts by or limits, best first; nothing where it
    names none or its satellites have no clock whose time between uploads counts.
    """
    asked = [name for name in NAMES if name in study.named]
    signal = study.signal
    if not asked or signal is None or signal.clock is None:
        return []
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    order = np.argsort(front[asked[0]].values, kind="stable")[:MOST]
    rows = rows_in(front)[order]
    found: list[dict[str, Any]] = [
        {"identity": identity, "satellites": int(row["satellites"]), "figure": asked[0], "m": {}}
        for identity, row in zip(front.identity.values[order].tolist(), rows, strict=True)
    ]
    for clock in CLOCKS:
        other = replace(study, signal=replace(signal, clock=clock))
        for one, error in zip(found, pattern_errors(other, rows)[asked[0]], strict=True):
            one["m"][clock.name] = float(error)
    return found

"""The front of a study: what no candidate beats in two objectives at once."""

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import ScalarFormatter

from compass.pictures.style import CYCLE, FAINT, whole_numbers
from compass.quantities.merits import MERITS
from compass.study.bounds import ends

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def label(name: str, width: int = 44) -> str:
    """Title of a figure of merit with its unit, in lines of `width` letters."""
    return fill(MERITS[name].heading, width)


def draw_front(axes: "Axes", results: "xr.Dataset", a: str, b: str) -> None:
    """Draw all candidates with values, and the first front with its bounds, in two figures."""
    good, front = results.front.values >= 0, results.front.values == 0
    x, y = results[a].values, results[b].values
    axes.plot(x[good], y[good], ".", ms=3, color=FAINT, alpha=0.5, label="feasible")
    axes.plot(x[front], y[front], "o", ms=4, color=CYCLE[0], label="first Pareto front")
    for name, bars, across in ((a, axes.hlines, y[front]), (b, axes.vlines, x[front])):
        if ends(name)[0] in results:
            low, high = (results[end].values[front] for end in ends(name))
            known = np.isfinite(high - low)
            bars(across[known], low[known], high[known], color=CYCLE[0], lw=1.5)
    for axis, name in ((axes.xaxis, a), (axes.yaxis, b)):
        if MERITS[name].quantity.form == "count":
            whole_numbers(axis)
    least = np.min(y[good], initial=np.inf)
    ratio = np.max(y[good]) / least if np.isfinite(least) and least > 0 else 1.0
    if ratio > 5:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(ScalarFormatter())
        axes.yaxis.set_minor_formatter(ScalarFormatter() if ratio < 20 else "")
    axes.set(xlabel=label(a, 60), ylabel=label(b))
    axes.grid(True)

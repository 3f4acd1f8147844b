"""Spans of time as bars, a row a thing: when it is in sight, when it works."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from compass.pictures.reading import Rows
from compass.pictures.style import FAINT, PlainFigure

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_rows(
    axes: "Axes",
    names: Sequence[str],
    spans: Sequence[ArrayLike],
    colours: Sequence[str],
    ends: tuple[float, float],
    *,
    width: float = 6.0,
) -> None:
    """Draw spans between `ends` as bars, the first row on top, and keep them for who points.

    Parameters
    ----------
    axes
        Where to.
    names, colours
        Of the rows.
    spans
        Of each row, shape (number, 2): from and to, in the unit of the axis across.
    ends
        What of it is shown.
    width
        Of a bar, points.
    """
    kept = [within(each, ends) for each in spans]
    for row, (some, colour) in enumerate(zip(kept, colours, strict=True)):
        axes.axhline(row, color=FAINT, lw=0.4, alpha=0.5)
        # one line a row, broken between its spans
        across = np.column_stack([some, np.full(len(some), np.nan)]).ravel()
        axes.plot(across, np.full(across.size, row), color=colour, lw=width, solid_capstyle="butt")
    axes.set_yticks(range(len(names)), list(names), fontsize=8)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlim(*ends)
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x")
    axes.set_axisbelow(True)
    figure = axes.figure
    if isinstance(figure, PlainFigure):
        figure.rows.append(Rows(axes, tuple(names), tuple(kept)))


def runs(on: ArrayLike) -> np.ndarray:
    """First and past-the-last place of every run of truths, shape (runs, 2)."""
    edges = np.diff(np.concatenate([[False], np.asarray(on, bool), [False]]))
    return np.flatnonzero(edges).reshape(-1, 2)


def within(spans: ArrayLike, ends: tuple[float, float]) -> np.ndarray:
    """Spans, or what of them lies between two ends."""
    some = np.asarray(spans, float).reshape(-1, 2)
    some = some[(some[:, 1] > ends[0]) & (some[:, 0] < ends[1])]
    return np.clip(some, *ends)

"""One number of each of several things as bars, the first on top."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from compass.pictures.style import CYCLE, MARS, axes_or_new, look, whole_numbers
from compass.quantities import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_bars(
    axes: "Axes | None",
    names: Sequence[str],
    values: Sequence[float | None],
    quantity: Quantity,
    title: str,
    *,
    missed: Sequence[bool] = (),
) -> "Axes":
    """Draw a bar a thing; where there is no number none, and the name stays.

    Parameters
    ----------
    axes
        Where to; new ones without.
    names, values
        Of the things, in the quantity's unit.
    quantity
        What the numbers are.
    title
        Of the axes.
    missed
        Which of them miss what was asked for: in another colour, if any are given.
    """
    drawn = axes_or_new(axes, 8.0, 1.6 + 0.28 * len(names))
    colours = [MARS if k < len(missed) and missed[k] else CYCLE[0] for k in range(len(names))]
    with look():
        places = range(len(names))
        drawn.barh(places, [0.0 if v is None else v for v in values], color=colours)
        drawn.set_yticks(places, names)
        drawn.set_ylim(max(len(names), 4) - 0.5, -0.5)  # the first on top; no bar too broad
        drawn.set(xlabel=quantity.heading, title=title)
        drawn.grid(axis="x", alpha=0.3)
        if quantity.form == "count":
            whole_numbers(drawn.xaxis)
    return drawn

"""How the project's pictures look: colours, fonts, and figures made without global state."""

from io import BytesIO
from typing import Any

from matplotlib import colormaps, rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap
from matplotlib.figure import Figure

from compass.document import Picture

PNG_DPI = 130

INK, FAINT, MARS, SKY = "#23262b", "#9aa0a6", "#b5532d", "#2b6cb0"

#: Sequential, perceptually uniform and safe for colour-blind readers.
SEQUENTIAL = "viridis"

#: Ten colours that stay apart for colour-blind readers (Okabe and Ito 2008, two darkened).
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#5b5b5b", "#8c2d04")

_RC = {
    "font.size": 9.5,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": "#dfe3e8",
    "grid.linewidth": 0.6,
    "figure.facecolor": "white",
}


def new_figure(width: float = 8.0, height: float = 4.5, **options: Any) -> Figure:
    """Return an empty figure (inches) with the project's look and a canvas of its own."""
    with rc_context(_RC):
        figure = Figure(figsize=(width, height), layout="constrained", **options)
        FigureCanvasAgg(figure)
    return figure


def look() -> Any:
    """Return a context manager: axes made and artists drawn inside take the project's look."""
    return rc_context(_RC)


def steps_of(name: str, count: int) -> Colormap:
    """Return a colour map cut into `count` steps, for whole numbers."""
    return colormaps[name].resampled(count)


def axes_or_new(axes: Axes | None, width: float = 8.0, height: float = 4.5) -> Axes:
    """Return the axes given, or the only ones of a new figure that a notebook shows by itself."""
    if axes is not None:
        return axes
    with look():
        return new_figure(width, height).add_subplot()


def picture(figure: Figure, stem: str, title: str, caption: str, *, wide: bool = False) -> Picture:
    """Render a matplotlib figure to PNG; the same figure gives the same bytes."""
    buffer = BytesIO()
    metadata: dict[str, Any] = {"Software": None, "Title": title}
    figure.savefig(buffer, format="png", dpi=PNG_DPI, metadata=metadata)
    return Picture(stem, title, caption, buffer.getvalue(), wide)

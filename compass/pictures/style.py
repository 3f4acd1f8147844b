"""How the project's pictures look: colours, fonts, and figures made without global state.

Texts are drawn as they are written: a dollar in a name is a dollar, never the start of a formula.
"""

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from matplotlib import font_manager, rc_context
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import LogFormatterMathtext, MaxNLocator
from matplotlib.transforms import Bbox

from compass.document import Picture
from compass.pictures.reading import Field, Rows, reading
from compass.pictures.rendering import letters, rendered
from compass.words import latitude_words, longitude_words

#: Width and height, inches, of a curve that takes half the width of a page: its letters are read.
HALF = 5.6, 3.5

INK, FAINT, MARS, SKY = "#23262b", "#9aa0a6", "#b5532d", "#2b6cb0"

#: Sequential, perceptually uniform and safe for colour-blind readers.
SEQUENTIAL = "viridis"

#: Ten colours that stay apart for colour-blind readers (Okabe and Ito 2008, two darkened).
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#5b5b5b", "#8c2d04")

#: Fonts for letters that the first has not, of those that are installed.
_FONTS = ("DejaVu Sans", "Noto Sans CJK SC", "Noto Sans", "Noto Sans Arabic",
          "Noto Sans Devanagari", "Noto Sans Symbols 2", "Noto Emoji", "Unifont")  # fmt: skip

_RC: dict[str, Any] = {
    "text.parse_math": False,
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


class PlainFigure(Figure):
    """A figure that draws every text as it is written, whenever and for whomever it is drawn.

    Ticks are made when a figure is drawn, and take what holds then. A letter that no font has is
    a box, and no matter for a warning of its own: `boxes` tells them. `fields` are the maps in it
    and `rows` the rows of spans, whose values can be read; of `names` none is printed over one
    before it.
    """

    def __init__(self, *given: Any, **options: Any) -> None:
        super().__init__(*given, **options)
        self.fields: list[Field] = []
        self.rows: list[Rows] = []
        self.names: list[Text] = []

    def draw(self, renderer: Any) -> None:
        """As any figure is."""
        with self._plain():
            super().draw(renderer)

    def settle(self) -> None:
        """Find once and for all where everything stands; it is drawn there from then on."""
        engine = self.get_layout_engine()
        if engine is not None:
            with self._plain():
                engine.execute(self)
            self.set_layout_engine("none")
        kept: list[Bbox] = []
        for name in self.names:
            if (box := name.get_window_extent()).count_overlaps(kept):
                name.set_visible(False)
            else:
                kept.append(box)

    @contextmanager
    def _plain(self) -> Iterator[None]:
        """Texts as they are written, in the project's look."""
        for axes in self.axes:
            axes.title.set_wrap(True)  # at the figure's edges: names are as long as users like
            for axis in (axes.xaxis, axes.yaxis):
                for get, put in (
                    (axis.get_major_formatter, axis.set_major_formatter),
                    (axis.get_minor_formatter, axis.set_minor_formatter),
                ):
                    now = get()
                    if isinstance(now, LogFormatterMathtext) and not isinstance(now, Powers):
                        put(Powers(now))
        for text in self.findobj(Text):
            text.set_parse_math(False)
        with look(), warnings.catch_warnings(record=True) as told:
            warnings.filterwarnings("always", message=_MISSING.pattern, category=UserWarning)
            yield
        for one in told:
            if letter := _MISSING.match(str(one.message)):
                _boxes[chr(int(letter[1]))] = None
            else:
                warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


#: What matplotlib says of a letter that no font has; and those of which it did, in order.
_MISSING = re.compile(r"Glyph (\d+) .* missing from")
_boxes: dict[str, None] = {}


def boxes() -> str:
    """Letters drawn as boxes since last asked, because no font here has them."""
    letters = "".join(_boxes)
    _boxes.clear()
    return letters


class Powers(LogFormatterMathtext):
    """Ticks of a logarithmic axis as text: 10⁻³, 2×10⁵."""

    def __init__(self, like: LogFormatterMathtext) -> None:
        self.__dict__.update(like.__dict__)
        self._like = like

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Label of a tick."""
        self._like.axis = self.axis
        return without_markup(self._like(x, pos))

    def set_locs(self, locs: Any = None) -> None:
        """Know all ticks: whether those between powers are labelled depends on them."""
        self._like.axis = self.axis
        self._like.set_locs(locs)


_RAISED = str.maketrans("0123456789-−.", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻·")


def without_markup(formula: str) -> str:
    """Return a formula of matplotlib's own ticks as text."""
    text = re.sub(r"\$\\mathdefault\{(.*)\}\$", r"\1", formula).replace(r"\times", "×")
    return re.sub(r"\^\{([^}]*)\}", lambda power: power[1].translate(_RAISED), text)


@cache
def _families() -> list[str]:
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return [name for name in _FONTS if name in installed]


def new_figure(width: float = 8.0, height: float = 4.5, **options: Any) -> PlainFigure:
    """Return an empty figure (inches) with the project's look and a canvas of its own."""
    with look():
        figure = PlainFigure(figsize=(width, height), layout="constrained", **options)
        FigureCanvasAgg(figure)
    return figure


def look() -> Any:
    """Return a context manager: axes made and artists drawn inside take the project's look."""
    return rc_context(_RC | {"font.family": _families()})


def whole_numbers(axis: Axis) -> None:
    """Mark an axis of what is counted at whole numbers alone, be there but one of them on it."""
    axis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))


def degree_words(name: str, degrees: float) -> str:
    """A latitude or a longitude beside a picture; on the equator and the prime meridian 0°."""
    said = {"latitude": latitude_words, "longitude": longitude_words}[name](degrees, "g")
    return said if degrees else "0°"


def on_mars(axis: Axis, name: str) -> None:
    """Name an axis of latitudes or longitudes in degrees, and say on which side its ticks lie."""
    axis.set_label_text(name)
    axis.set_major_formatter(lambda value, _: degree_words(name, value))


def axes_or_new(axes: Axes | None, width: float = 8.0, height: float = 4.5) -> Axes:
    """Return the axes given, or the only ones of a new figure that a notebook shows by itself."""
    if axes is not None:
        return axes
    with look():
        return new_figure(width, height).add_subplot()


def picture(
    figure: Figure, stem: str, title: str, caption: str, *, wide: bool = False, alt: str = ""
) -> Picture:
    """Draw a figure, with its values and how small its letters are.

    The same figure gives the same bytes.
    """
    assert isinstance(figure, PlainFigure)
    drawn = rendered(figure, title)
    return Picture(stem, title, caption, drawn, wide, alt, reading(figure), letters(figure))

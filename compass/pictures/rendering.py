"""A figure as the bytes of a picture: vectors where it is made of lines and words, else pixels.

What matplotlib writes is made smaller without a change that can be seen: vectors lose what no
reader's program asks for and say each style once, pixels keep their 256 most used colours.
"""

import re
from io import BytesIO
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import QuadMesh
from matplotlib.image import AxesImage
from matplotlib.text import Text

if TYPE_CHECKING:
    from compass.pictures.style import PlainFigure

PNG_DPI = 130

#: Vectors of more bytes are drawn as pixels, which by then are fewer.
MOST_VECTORS = 60_000

#: A reader may have another font than the one measured here; those named are no wider.
_FONTS = "'DejaVu Sans', Verdana, sans-serif"


def rendered(figure: "PlainFigure", title: str) -> bytes:
    """Draw a figure as SVG or, where it has fields of colour, solids or many marks, as PNG."""
    figure.set_dpi(PNG_DPI)
    figure.settle()
    solid = any(axes.name == "3d" for axes in figure.axes)
    if not solid and not any(figure.findobj(kind) for kind in (QuadMesh, AxesImage)):
        made = vectors(figure, title)
        if len(made) <= MOST_VECTORS:
            return made
    return pixels(figure, title)


def vectors(figure: "PlainFigure", title: str) -> bytes:
    """Return a figure as SVG whose words are words, the same bytes for the same figure."""
    written = BytesIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "compass"}):
        FigureCanvasSVG(figure).print_svg(written, metadata={"Date": None})
    return smaller(written.getvalue().decode(), title).encode()


def smaller(svg: str, title: str) -> str:
    """Return an SVG without what is not drawn, places to 0.01 points, each style as a class."""
    body = re.sub(r"^.*?(?=<svg)|<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    classes: dict[str, str] = {}

    def style(found: re.Match[str]) -> str:
        name = classes.setdefault(found[1], f"s{len(classes)}")
        return f' class="{name}"'

    def tag(found: re.Match[str]) -> str:
        part = re.sub(r' transform="rotate\(-0 [^"]*"|(?<=<g) id="[^"]*"', "", found[0])
        part = re.sub(r' (?:d|x|y|width|transform)="[^"]*"', _rounded, part)
        return re.sub(r' style="([^"]*)"', style, part)

    # within tags alone: what stands between them may be a user's words
    body = re.sub(r"<[^>]*>", tag, body)
    body = re.sub(r">\s*\n\s*<", ">\n<", body)
    rules = "".join(f".{name}{{{_fonts(rule)}}}" for rule, name in classes.items())
    head = f"<title>{escape(title)}</title><style>{rules}</style>"
    return re.sub(r"<svg[^>]*>", lambda found: found[0] + head, body, count=1)


def _rounded(found: re.Match[str]) -> str:
    near = re.sub(
        r"-?\d+\.\d{3,}", lambda n: f"{float(n[0]):.2f}".rstrip("0").rstrip("."), found[0]
    )
    return re.sub(r"\s*\n", "", near)


def _fonts(rule: str) -> str:
    return re.sub(r"font-family: [^;]*", f"font-family: {_FONTS}", rule)


def pixels(figure: "PlainFigure", title: str) -> bytes:
    """Return a figure as PNG in 256 colours, which takes a third of the bytes."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(PNG_DPI)
    canvas.draw()
    words, written = PngInfo(), BytesIO()
    words.add_itxt("Title", title)
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    # those that are far apart, not those of most pixels: a colour bar keeps what no place has
    few = drawn.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    # level 9 would save one byte in a hundred and take three times as long
    few.save(written, format="png", compress_level=6, pnginfo=words)
    return written.getvalue()


def letters(figure: "PlainFigure") -> float:
    """Height of the smallest letters that are drawn as a share of the picture's width."""
    parts = [part for part in figure.get_children() if not isinstance(part, Axes)]
    for axes in figure.axes:
        hidden = () if axes.axison else (axes.xaxis, axes.yaxis)
        parts += [part for part in axes.get_children() if part not in hidden]
    drawn = [text for part in parts for text in part.findobj(Text) if _seen(text)]
    width_points = 72.0 * float(figure.get_figwidth())
    return min((float(text.get_fontsize()) for text in drawn), default=width_points) / width_points


def _seen(text: Text) -> bool:
    return bool(text.get_visible() and text.get_text().strip())

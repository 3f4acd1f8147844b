"""The pieces of a report: sections of text, pictures and tables."""

from dataclasses import dataclass, field
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PNG_DPI = 130


@dataclass(frozen=True)
class Picture:
    """A picture: file stem, title (also the alternative text), caption, PNG bytes, how wide.

    A wide one takes the width of the page, others stand two to a row.
    """

    stem: str
    title: str
    caption: str
    png: bytes
    wide: bool = False


@dataclass(frozen=True)
class Table:
    """A table: title, column headings with units, rows of numbers or text."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]


@dataclass(frozen=True)
class Interactive:
    """A picture that answers the pointer: file stem, title, caption, HTML, the script it needs."""

    stem: str
    title: str
    caption: str
    html: str
    script: str


@dataclass(frozen=True)
class Section:
    """A section of a report, shown in the order paragraphs, interactive, pictures, tables."""

    title: str
    paragraphs: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = field(default_factory=tuple)
    tables: tuple[Table, ...] = field(default_factory=tuple)
    interactive: tuple[Interactive, ...] = ()


def picture(
    figure: "Figure", stem: str, title: str, caption: str, *, wide: bool = False
) -> Picture:
    """Render a matplotlib figure to PNG; the same figure gives the same bytes."""
    buffer = BytesIO()
    metadata: dict[str, Any] = {"Software": None, "Title": title}
    figure.savefig(buffer, format="png", dpi=PNG_DPI, metadata=metadata)
    return Picture(stem, title, caption, buffer.getvalue(), wide)

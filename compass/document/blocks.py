"""The blocks a document is made of; they know nothing of how they are drawn."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from compass.document.numbers import Value
from compass.quantities import QUANTITIES, quantity


@dataclass(frozen=True)
class Verdict:
    """The answer: a word, the claim it is about, and whether the claim holds (None: open)."""

    word: str
    claim: str
    holds: bool | None = None


@dataclass(frozen=True)
class Sentence:
    """A paragraph of prose."""

    text: str


@dataclass(frozen=True)
class Table:
    """A table: title, column headings with units, rows of values, numbers or text.

    `shown` rows are drawn, all if None; how many are left out is said below.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]
    shown: int | None = None

    @property
    def drawn(self) -> tuple[tuple[object, ...], ...]:
        """The rows that are drawn."""
        return self.rows[: self.shown]

    @property
    def rest(self) -> str:
        """What is said of the rows that are not drawn."""
        left = len(self.rows) - len(self.drawn)
        return f"... and {left} more; JSON has them all" if left else ""


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
class Interactive:
    """A picture that answers the pointer: file stem, title, caption, HTML, the script it needs."""

    stem: str
    title: str
    caption: str
    html: str
    script: str


@dataclass(frozen=True)
class Details:
    """Blocks that are folded away under a title where the medium can fold."""

    title: str
    blocks: tuple["Block", ...]


@dataclass(frozen=True)
class Section:
    """Blocks under a title."""

    title: str
    blocks: tuple["Block", ...] = ()

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """Its prose."""
        return tuple(block.text for block in walk(self.blocks) if isinstance(block, Sentence))

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """Its pictures."""
        return tuple(block for block in walk(self.blocks) if isinstance(block, Picture))

    @property
    def tables(self) -> tuple[Table, ...]:
        """Its tables."""
        return tuple(block for block in walk(self.blocks) if isinstance(block, Table))

    @property
    def interactive(self) -> tuple[Interactive, ...]:
        """Its pictures that answer the pointer."""
        return tuple(block for block in walk(self.blocks) if isinstance(block, Interactive))


@dataclass(frozen=True)
class Page:
    """A document: a title, then its blocks, the answer first."""

    title: str
    blocks: tuple["Block", ...]


Block = Verdict | Sentence | Table | Picture | Interactive | Details | Section


def arranged(
    title: str,
    paragraphs: Iterable[str] = (),
    pictures: Iterable[Picture] = (),
    tables: Iterable[Table] = (),
    interactive: Iterable[Interactive] = (),
) -> Section:
    """Section with its prose first, then interactive pictures, pictures and tables."""
    prose = (Sentence(text) for text in paragraphs)
    return Section(title, (*prose, *interactive, *pictures, *tables))


def facts(title: str, values: Iterable[Value]) -> Table:
    """Table of single values: what, how much, unit, and how well it is known if any says so."""
    kept = list(values)
    known = any(value.evidence for value in kept)
    header = ("", "value", "unit") + (("evidence",) if known else ())
    rows = (
        (v.title, v, v.quantity.shown_unit) + ((str(v.evidence or ""),) if known else ())
        for v in kept
    )
    return Table(title, header, tuple(rows))


def values(group: str, known: Mapping[str, Any]) -> list[Value]:
    """Values of plain numbers by their names, as in JSON, looked up as ``group.name`` or ``name``.

    A value that is a mapping holds the same quantity from several: ``{"exact": ..., ...}``.
    """
    found = []
    for name, value in known.items():
        record = quantity(f"{group}.{name}" if f"{group}.{name}" in QUANTITIES else name)
        if isinstance(value, Mapping):
            found += [Value(record, each, None, whose) for whose, each in value.items()]
        else:
            found.append(Value(record, value))
    return found


def columns(title: str, rows: Sequence[Sequence[Value]], shown: int | None = None) -> Table:
    """Table with a row of values each; headings are those of the first row's quantities."""
    header = tuple(
        value.title + (f", {value.quantity.shown_unit}" if value.quantity.shown_unit else "")
        for value in (rows[0] if rows else ())
    )
    return Table(title, header, tuple(tuple(row) for row in rows), shown)


def walk(blocks: Iterable[Block]) -> Iterator[Block]:
    """All blocks, those inside others after them."""
    for block in blocks:
        yield block
        if isinstance(block, Details | Section):
            yield from walk(block.blocks)

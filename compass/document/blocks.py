"""The blocks a document is made of; they know nothing of how they are drawn."""

from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, inf
from re import split
from typing import Any

from compass.document.numbers import Value, is_number, number_of
from compass.quantities import QUANTITIES, quantity

#: A table of more rows is folded away on a page.
LONG = 12

#: What so great a share of a table's rows say alike is said once.
MOST = 0.6

#: Letters of a picture are never shown smaller, pixels of a screen.
SMALLEST = 10.0

#: Letters up to which is said in one how sure an answer is; else what that stands on is folded.
BRIEF = 32


@dataclass(frozen=True)
class Verdict:
    """The answer: a word, the claim it is about, and whether the claim holds (None: open)."""

    word: str
    claim: str
    holds: bool | None = None


@dataclass(frozen=True)
class Answer:
    """One question of those who decide: its answer, whether it is met, and how sure that is.

    `holds` is None where nothing was asked for that could be met or missed.
    """

    question: str
    answer: Value | str
    holds: bool | None = None
    evidence: str = ""

    @property
    def mark(self) -> str:
        """Whether it is met, in a word."""
        return {True: "met", False: "missed", None: ""}[self.holds]

    @property
    def sure(self) -> str:
        """How well the answer is known."""
        known = self.answer.evidence if isinstance(self.answer, Value) else None
        return self.evidence or ("" if known is None else str(known))

    @property
    def folded(self) -> tuple[str, str]:
        """How well it is known in a few words, and what that stands on if it takes more."""
        if len(self.sure) <= BRIEF:
            return self.sure, ""
        few, *rest = split(r"[,;:] ", self.sure, maxsplit=1)
        return few, "".join(rest)

    @property
    def written(self) -> str:
        """The answer with its unit."""
        unit = self.answer.quantity.shown_unit if isinstance(self.answer, Value) else ""
        return f"{self.answer} {unit}".strip()


@dataclass(frozen=True)
class Answers:
    """What is to be known first, as a table of marks."""

    title: str
    rows: tuple[Answer, ...]

    @property
    def table(self) -> "Table":
        """The same as a table of words."""
        rows = tuple((a.mark, a.question, a.written, a.sure) for a in self.rows)
        return Table(self.title, ("", "question", "answer", "how sure"), rows)


@dataclass(frozen=True)
class Sentence:
    """A paragraph of prose."""

    text: str


@dataclass(frozen=True)
class Table:
    """A table: title, column headings with units, rows of values, numbers or text.

    `shown` rows are drawn, all if None; how many are left out is said below. `nothing` is said
    instead of a table in which every number is zero, or every one infinite.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]
    shown: int | None = None
    nothing: str = ""

    @property
    def empty(self) -> bool:
        """Whether it is better said in its sentence: all its numbers are zero, or infinite."""
        said = {number_of(cell) for row in self.rows for cell in row if is_number(cell)}
        return bool(self.nothing) and (said <= {0.0} or said == {inf})

    @property
    def narrow(self) -> bool:
        """Whether another may stand beside it on a page."""
        return len(self.header) <= 4 and not self.long and not self.empty

    @property
    def long(self) -> bool:
        """Whether it is folded away on a page."""
        return len(self.drawn) > LONG

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
    """A picture: file stem, title, caption, bytes of PNG or SVG, how wide, what it shows in words.

    A wide one takes the width of the page, others stand two to a row. `reading` is what it says in
    numbers (JSON, of `compass.pictures.reading`), for where a reader can point at it; `letters` the
    height of its smallest letters as a share of its width.
    """

    stem: str
    title: str
    caption: str
    drawn: bytes
    wide: bool = False
    alt: str = ""
    reading: str = ""
    letters: float = 0.0

    @property
    def form(self) -> str:
        """How it is written, as the end of a file's name."""
        return "svg" if self.drawn.startswith(b"<svg") else "png"

    @property
    def file_name(self) -> str:
        """Its name as a file."""
        return f"{self.stem}.{self.form}"

    @property
    def source(self) -> str:
        """It as a page carries it inside."""
        media = {"svg": "svg+xml", "png": "png"}[self.form]
        return f"data:image/{media};base64,{b64encode(self.drawn).decode('ascii')}"

    @property
    def least_width(self) -> int:
        """Width in pixels of a screen below which its letters are smaller than `SMALLEST`."""
        return ceil(SMALLEST / self.letters) if self.letters else 0


@dataclass(frozen=True)
class Interactive:
    """A picture that answers the pointer: file stem, title, caption, HTML, the script it needs.

    `still` stands in its place where scripts do not run, and on paper.
    """

    stem: str
    title: str
    caption: str
    html: str
    script: str
    still: Picture | None = None


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
        """Its pictures, those that stand for what answers the pointer too."""
        shown = (b.still if isinstance(b, Interactive) else b for b in walk(self.blocks))
        return tuple(block for block in shown if isinstance(block, Picture))

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


Block = Verdict | Answers | Sentence | Table | Picture | Interactive | Details | Section


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
    """Table of single values: what, how much, unit, and how well it is known if any says so.

    What is known alike of all, or of most, is said once, behind the title.
    """
    kept = list(values)
    said = [str(value.evidence or "") for value in kept]
    most = max(said, key=said.count, default="")
    # of what there is none of, nothing need be known
    alike = len(kept) > 1 and all(
        each == most or value.value is None for value, each in zip(kept, said, strict=True)
    )
    if alike and most:
        title = f"{title} ({most})"
    elif len(kept) > 1 and most and said.count(most) > MOST * len(kept):
        title = f"{title} ({most}, where nothing else is said)"
        said = ["" if each == most else each for each in said]
    known = any(said) and not alike
    header = ("", "value", "unit") + (("evidence",) if known else ())
    rows = (
        (v.title, v, "" if v.value is None else v.quantity.shown_unit)
        + ((evidence,) if known else ())
        for v, evidence in zip(kept, said, strict=True)
    )
    return Table(title, header, tuple(rows))


def values(group: str, known: Mapping[str, Any]) -> list[Value]:
    """Values of plain numbers by their names, as in JSON, looked up as ``group.name`` or ``name``.

    A value that is a mapping holds the same quantity from several: ``{"exact": ..., ...}``.
    """
    listed = []
    for name, value in known.items():
        record = quantity(f"{group}.{name}" if f"{group}.{name}" in QUANTITIES else name)
        if isinstance(value, Mapping):
            listed += [Value(record, each, None, whose) for whose, each in value.items()]
        else:
            listed.append(Value(record, value))
    return listed


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

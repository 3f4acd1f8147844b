"""Blocks as text for a terminal."""

import textwrap
from collections.abc import Iterable

from compass.document.blocks import (
    Answers,
    Block,
    Details,
    Interactive,
    Page,
    Picture,
    Section,
    Sentence,
    Table,
    Verdict,
)
from compass.document.numbers import cell, is_number

WIDTH = 100


def text(page: Page) -> str:
    """Write a document as lines; pictures are left out."""
    blocks = list(page.blocks)
    head = page.title
    if blocks and isinstance(blocks[0], Verdict):
        head = f"{page.title}: {_verdict(blocks.pop(0))}"
    return "\n".join([head, *_lines(blocks)])


def _lines(blocks: Iterable[Block]) -> list[str]:
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Verdict):
            lines.append(_verdict(block))
        elif isinstance(block, Sentence):
            lines += textwrap.wrap(
                block.text, WIDTH, initial_indent="  ", subsequent_indent="  ",
                break_long_words=False, break_on_hyphens=False,
            )  # fmt: skip
        elif isinstance(block, Answers):
            lines += _table(block.table)
        elif isinstance(block, Table):
            lines += [f"  {block.nothing}"] if block.empty else _table(block)
        elif isinstance(block, Section | Details):
            lines += ["", block.title, "=" * len(block.title), *_lines(block.blocks)]
        else:
            assert isinstance(block, Picture | Interactive)
    return lines


def _verdict(block: Block) -> str:
    assert isinstance(block, Verdict)
    return f"{block.word.upper()}: {block.claim}" if block.word else block.claim


def _table(table: Table) -> list[str]:
    """Title, rule, and columns: words on the left, numbers on their decimal point."""
    if not table.drawn:
        return []
    columns = []
    for k, name in enumerate(table.header):
        values = [row[k] for row in table.drawn]
        written = [cell(value) for value in values]
        if any(is_number(value) for value in values) and len(table.drawn) > 1:
            written = _on_the_point(written)
        columns.append([name, *written])
    if not any(column[0] for column in columns if column is not columns[1]):
        columns = [column[1:] for column in columns]  # a list of facts needs no headings
    widths = [max(len(entry) for entry in column) for column in columns]
    rows = zip(*columns, strict=True)
    lines = [
        "  ".join(entry.ljust(width) for entry, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    return ["", table.title, "-" * len(table.title), *lines, *([table.rest] if table.rest else [])]


def _on_the_point(written: list[str]) -> list[str]:
    """Pad numbers on the left so that their decimal points stand below each other."""
    before = [
        len(entry.split(" ")[0].split(".")[0]) if entry[:1] in "-0123456789∞" else 0
        for entry in written
    ]
    most = max(before)
    return [
        " " * (most - long) + entry if long else entry
        for entry, long in zip(written, before, strict=True)
    ]

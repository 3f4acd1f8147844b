"""Blocks as HTML, for a page and for a notebook; everything that comes from a user is escaped."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

from compass.document.blocks import Block, Page, Picture, Table
from compass.document.numbers import cell, is_number, padding

if TYPE_CHECKING:
    import jinja2
    import markupsafe


def html(part: Page | Block) -> str:
    """Draw a document or one block as a piece of HTML that carries its own style."""
    return environment().get_template("notebook.html").render(part=part)


def kind(block: object) -> str:
    """Name of the template that draws a block."""
    return type(block).__name__.lower()


def beside(block: object) -> str:
    """Name of the row that a block may share with others of its kind; none if it stands alone."""
    if isinstance(block, Picture):
        return "pictures"
    return "tables" if isinstance(block, Table) and block.narrow and block.drawn else ""


def alone(block: object, after: object, before: Sequence[object]) -> bool:
    """Whether a picture has a row of its own for want of another of its size to stand beside."""
    if not isinstance(block, Picture) or block.wide:
        return False
    left = 0  # pictures of half the width on the row that is open
    for each in before:
        left = 0 if not isinstance(each, Picture) or each.wide else (left + 1) % 2
    return left == 0 and (not isinstance(after, Picture) or after.wide)


def aligned(table: Table) -> list[list[tuple[str, str, bool]]]:
    """Rows of a table: each cell as text, what aligns it unseen, whether it is a number."""
    columns = []
    for values in zip(*table.drawn, strict=True):
        written = [cell(value) for value in values]
        numeric = [is_number(value) for value in values]
        several = len(written) > 1 and all(
            number or not text for number, text in zip(numeric, written, strict=True)
        )
        plain = all(len(text.split()) < 2 for text in written)
        pads = padding(written) if several and plain else [""] * len(written)
        columns.append(list(zip(written, pads, numeric, strict=True)))
    return [list(row) for row in zip(*columns, strict=True)]


def prose(text: str) -> "markupsafe.Markup":
    """Escape a text; what stands between backticks is code, as people write it in sources."""
    from markupsafe import Markup, escape

    parts = text.split("`")
    if len(parts) % 2 == 0:  # one is left alone
        return escape(text)
    return Markup("").join(
        Markup("<code>{}</code>").format(part) if k % 2 else escape(part)
        for k, part in enumerate(parts)
    )


@cache
def environment() -> "jinja2.Environment":
    """Return the templates, one a block, with what they need to write a cell."""
    import jinja2

    made = jinja2.Environment(
        loader=jinja2.PackageLoader("compass.document"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    made.filters |= {
        "aligned": aligned,
        "alone": alone,
        "beside": beside,
        "cell": cell,
        "kind": kind,
        "prose": prose,
    }
    made.tests["numeric"] = is_number
    return made

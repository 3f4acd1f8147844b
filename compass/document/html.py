"""Blocks as HTML, for a page and for a notebook; everything that comes from a user is escaped."""

import base64
from functools import cache
from typing import TYPE_CHECKING

from compass.document.blocks import Block, Page
from compass.document.numbers import cell, is_number

if TYPE_CHECKING:
    import jinja2


def html(part: Page | Block) -> str:
    """Draw a document or one block as a piece of HTML that carries its own style."""
    return environment().get_template("notebook.html").render(part=part)


def in_base64(data: bytes) -> str:
    """Write bytes as text, for a picture inside a page."""
    return base64.b64encode(data).decode("ascii")


def kind(block: object) -> str:
    """Name of the template that draws a block."""
    return type(block).__name__.lower()


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
        "base64": in_base64,
        "cell": cell,
        "kind": kind,
    }
    made.tests["numeric"] = is_number
    return made

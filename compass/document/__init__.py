"""Documents: blocks of words and numbers, drawn as text for a terminal or HTML for a page.

No physics. A command's text, its page and its notebook view are drawn from the same blocks, so
they cannot differ.
"""

from compass.document.blocks import (
    Answer,
    Answers,
    Block,
    Details,
    Page,
    Picture,
    Section,
    Sentence,
    Table,
    Verdict,
)
from compass.document.evidence import Bracket, Evidence, Interval, Proven, Sampled
from compass.document.html import html
from compass.document.numbers import Value
from compass.document.text import text

__all__ = [
    "Answer",
    "Answers",
    "Block",
    "Bracket",
    "Details",
    "Evidence",
    "Interval",
    "Page",
    "Picture",
    "Proven",
    "Sampled",
    "Section",
    "Sentence",
    "Table",
    "Value",
    "Verdict",
    "html",
    "text",
]

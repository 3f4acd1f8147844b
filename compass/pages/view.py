"""The globe of a design, as a page of its own and in notebooks."""

from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from compass.api.given import given_in_metres
from compass.api.results import Result
from compass.arguments import checked
from compass.design import Design
from compass.document import Page, Section, Sentence
from compass.pages.answers import subtitle
from compass.pages.globe.piece import globe
from compass.pages.globe.still import still_picture
from compass.pages.page import render
from compass.saving import replacing
from compass.study.mapping import provenance


@dataclass(frozen=True, repr=False)
class ViewResult(Result):
    """A page with the globe of a design, which needs no network; in a notebook, the globe itself.

    Attributes
    ----------
    design
        Whose satellites it shows.
    page
        The page, HTML.
    """

    design: Design = field(repr=False)
    page: str = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {"design": self.design.name, "bytes": len(self.page.encode())}

    def document(self) -> Page:
        """What the page shows."""
        size = len(self.page.encode()) / 1e6
        text = f"A globe one can turn, {size:.2f} MB; `write` puts it into a file, for any browser."
        return Page(self.design.name, (Sentence(text),))

    def _repr_html_(self) -> str:
        frame = f'<iframe title="Globe of {escape(self.design.name)}" style="width:100%;'
        return f'{frame}height:960px;border:0" srcdoc="{escape(self.page)}"></iframe>'

    def write(self, path: str | Path) -> Path:
        """Write the page.

        Raises
        ------
        OutputError
            It cannot be written.
        """
        path = Path(path)
        with replacing(path) as temporary:
            temporary.write_text(self.page, encoding="utf-8")
        return path


@checked
def view(design: Design | str | Path, *, command: str = "") -> ViewResult:
    """Show a design on a globe: satellites in motion, and what every place sees of them.

    Parameters
    ----------
    design
        The design, or the path of its file.
    command
        What to write into the page's provenance.

    Raises
    ------
    ArgumentError, DesignError
        The file has faults, or its satellites fall.

    Examples
    --------
    >>> import compass
    >>> "canvas" in compass.view("designs/compass-15-5-1.toml").page
    True
    """
    shown = given_in_metres(design)
    made = provenance(shown, command)
    rows = [
        ("command", command or "made from Python"),
        ("version", made["source"]),
        ("design file", made["design_file"]),
        ("SHA-256 of the design", made["design_sha256"]),
        ("reference figure", shown.figure.title),
    ]
    section = Section("Globe", (globe(shown, still_picture(shown)),))
    page = render(shown.name, subtitle(shown), [section], rows, shown.text)
    return ViewResult(shown, page)

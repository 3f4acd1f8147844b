"""One self-contained HTML page, its pictures inside it and also as files beside it."""

import os
import shutil
import tempfile
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from compass.document.blocks import Section
from compass.document.html import environment
from compass.errors import OutputError

if TYPE_CHECKING:
    import jinja2

PAGE = "index.html"


def render(
    title: str,
    subtitle: str,
    sections: Sequence[Section],
    provenance: Sequence[tuple[str, str]],
    source_text: str,
) -> str:
    """Return the page; everything that comes from a user is escaped."""
    scripts = [i.script for s in sections for i in s.interactive]
    if any(picture.reading for section in sections for picture in section.pictures):
        scripts.append(script("reading.js"))
    if scripts:
        scripts.insert(0, script("tip.js"))
    return (
        templates()
        .get_template("report.html")
        .render(
            title=title,
            subtitle=subtitle,
            sections=sections,
            readable=True,
            scripts=list(dict.fromkeys(scripts)),
            provenance=provenance,
            source_text=source_text,
        )
    )


@cache
def templates() -> "jinja2.Environment":
    """Return the templates of pages beside those of the blocks."""
    import jinja2

    return environment().overlay(
        loader=jinja2.ChoiceLoader(
            [jinja2.PackageLoader("compass.pages"), jinja2.PackageLoader("compass.document")]
        )
    )


@cache
def script(name: str) -> str:
    """Return a script of the pages' own."""
    return (files("compass.pages") / "templates" / name).read_text(encoding="utf-8")


def check_page_folder(folder: Path) -> None:
    """Refuse a folder for a report before any work is spent on it; it need not be there yet.

    Raises
    ------
    OutputError
        It, or a folder that it is to be made in, is a file or cannot be written into.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file; give a folder for the report")
    place = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not place.is_dir():
        raise OutputError(f"{folder}: {place} is a file; give another folder for the report")
    if not os.access(place, os.W_OK):
        raise OutputError(f"{folder}: {place} is not writable; give another folder for the report")


def write_page(folder: Path, page: str, sections: Sequence[Section]) -> Path:
    """Write the page and its pictures into `folder`; a killed run leaves the old page.

    Everything is written beside its place first; the page, renamed last, never refers to files
    that are not there, because it carries its pictures inside.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    OutputError
        As `check_page_folder`, or the disk is full.
    """
    check_page_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=".report-", dir=folder))
        try:
            for picture in (p for section in sections for p in section.pictures):
                (scratch / picture.file_name).write_bytes(picture.drawn)
            (scratch / PAGE).write_text(page, encoding="utf-8")
            for made in sorted(scratch.iterdir(), key=lambda path: path.name == PAGE):
                made.replace(folder / made.name)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
    except OSError as error:
        reason = error.strerror or error
        raise OutputError(f"{folder}: the report cannot be written: {reason}") from error
    return folder / PAGE

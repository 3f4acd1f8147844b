"""Commands that do more than call their function and write what options name of its result."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.clock import line_of_its_own
from compass.cli.refusals import check_outputs
from compass.cli.running import called
from compass.cli.shared import command_line, emit_json, say, wants_json, watched
from compass.saving import check_new_folder


def export(design: Path, output: Path, **options: Any) -> object:
    """Say where the file or folder is, and what it lacks."""
    read = compass.read_design(design)
    if options["format"] == "oem":
        check_new_folder(output)
    else:
        check_outputs(output, inputs=[design])
    made = compass.export(read, output=output, **options)
    if wants_json():
        return made
    for said in made.not_kept:
        say(f"not kept: {said}")
    say(f"wrote {output}" + (f": {len(made.files)} messages" if made.format == "oem" else ""))
    return None


def judge(folder: Path | None, **options: Any) -> object:
    """Make a page of what is found, where a folder for it is given."""
    from compass.pages.page import check_page_folder

    if folder is not None:
        check_page_folder(folder)
    result = called("judge", **options)
    if options["rival"] is not None:
        say(f"wrote {options['rival']}")
    if folder is not None:
        made = compass.report(result, output=folder, command=command_line(), progress=watched())
        say(f"report: {made.page}")
    return result


def new(kind: str, like: str | None, output: Path | None) -> object:
    """Write files that the new one names beside it, or say that there are some."""
    made = compass.new(kind, like=like)
    if output is None:
        for file in made.companions:
            say(f"it names {file.name}; with -o FILE that is written beside it")
        return made
    for file in made.write(output):
        say(f"wrote {file}")
    return made if wants_json() else None


def trade(**options: Any) -> object:
    """Say beside JSON what the text ends with."""
    result = called("trade", **options)
    for words in result.notes() if wants_json() else ():
        say(words)
    return result


def view(design: Path, output: Path | None, opened: bool | None) -> None:
    """Write the page and open it in a browser."""
    page = output or Path("views") / f"{design.stem}.html"
    read = compass.read_design(design)
    if output is None:
        page.parent.mkdir(exist_ok=True)
    check_outputs(page, inputs=[design])
    made = compass.view(read, command=command_line())
    made.write(page)
    if wants_json():
        emit_json({"page": str(page), **made.to_dict()})
    else:
        with line_of_its_own():
            click.echo(page)
    if opened or (opened is None and sys.stdout.isatty()):
        import webbrowser  # for nothing else

        if not webbrowser.open(page.absolute().as_uri()):
            say(f"no browser was found; open {page} in one")


SPECIAL: dict[str, Callable[..., object]] = {
    "export": export,
    "judge": judge,
    "new": new,
    "trade": trade,
    "view": view,
}

"""``compass view``: the globe one can turn."""

import sys
from pathlib import Path

import click

import compass
from compass.cli.clock import line_of_its_own
from compass.cli.options import takes
from compass.cli.shared import check_outputs, command_line, emit_json, say, wants_json


@takes("design output opened")
def command(design: Path, output: Path | None, opened: bool | None) -> None:
    """Show a DESIGN on a globe: one page, without a network, opened in a browser.

    Satellites move with a slider; every place shows how many it sees, its GDOP or, of a design
    with a table [signal], how many metres a fix errs there.
    """
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
        import webbrowser

        if not webbrowser.open(page.absolute().as_uri()):
            say(f"no browser was found; open {page} in one")

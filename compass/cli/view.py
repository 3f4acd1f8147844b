"""``compass view``: the globe one can turn."""

import sys
from pathlib import Path

import click

from compass.cli.options import design_argument, json_option, path
from compass.cli.shared import announce_compilation, command_line, emit_json, say


@click.command()
@design_argument
@path("-o", "--output", help="Page to write; by default views/NAME-OF-THE-FILE.html.")
@click.option(
    "--open/--no-open",
    "opened",
    default=None,
    help="Open it in a browser; by default where a person sits at the terminal.",
)
@json_option
def command(design: Path, output: Path | None, opened: bool | None, as_json: bool) -> None:
    """Show a DESIGN on a globe: one page, without a network, opened in a browser.

    Satellites move with a slider; every place shows how many it sees, or its GDOP.
    """
    announce_compilation()
    import compass
    from compass.saving import check_writable

    path = output or Path("views") / f"{design.stem}.html"
    read = compass.read_design(design)
    if output is None:
        path.parent.mkdir(exist_ok=True)
    check_writable(path, [design])
    made = compass.view(read, command=command_line())
    made.write(path)
    if as_json:
        emit_json({"page": str(path), **made.to_dict()})
    else:
        click.echo(path)
    if opened or (opened is None and sys.stdout.isatty()):
        import webbrowser

        if not webbrowser.open(path.absolute().as_uri()):
            say(f"no browser was found; open {path} in one")

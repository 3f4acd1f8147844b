"""``compass new``: a commented file that runs as it is."""

from pathlib import Path

import click

from compass.cli.options import json_option, path
from compass.cli.shared import print_result, say

KINDS = click.Choice(["design", "scenario", "study"])


@click.command()
@click.argument("kind", type=KINDS)
@click.option(
    "--from",
    "like",
    metavar="NAME",
    help="A design, scenario or study that comes with compass, by name, or any file.",
)
@path("-o", "--output", help="File to write, else stdout.")
@json_option
def command(kind: str, like: str | None, output: Path | None, as_json: bool) -> None:
    """Write a commented file to start from: every key, its unit, range and default.

    It runs as it is. Files that it names are written beside it.
    """
    import compass

    made = compass.new(kind, like=like)
    if output is None:
        print_result(made, as_json)
        for path in made.companions:
            say(f"it names {path.name}; with -o FILE that is written beside it")
        return
    written = made.write(output)
    if as_json:
        print_result(made, as_json)
    for path in written:
        say(f"wrote {path}")

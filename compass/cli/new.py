"""``compass new``: a commented file that runs as it is."""

from pathlib import Path

import click

import compass
from compass.cli.options import kind_argument, path
from compass.cli.shared import say, wants_json


@click.command()
@kind_argument
@click.option(
    "--from",
    "like",
    metavar="NAME",
    help="A design, scenario or study that comes with compass, by name, or any file.",
)
@path("-o", "--output", help="File to write, else stdout.")
def command(kind: str, like: str | None, output: Path | None) -> object:
    """Write a commented file to start from: every key, its unit, range and default.

    It runs as it is. Files that it names are written beside it.
    """
    made = compass.new(kind, like=like)
    if output is None:
        for file in made.companions:
            say(f"it names {file.name}; with -o FILE that is written beside it")
        return made
    for file in made.write(output):
        say(f"wrote {file}")
    return made if wants_json() else None

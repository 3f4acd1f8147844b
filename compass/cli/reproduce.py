"""``compass reproduce``: a source paper, number by number."""

from pathlib import Path

import click

from compass.cli.options import json_option, path
from compass.cli.shared import announce_compilation, print_result, say
from compass.papers import PAPERS
from compass.saving import readable


@click.command("reproduce")
@click.argument("paper", type=click.Choice(PAPERS))
@path(
    "-o",
    "--output",
    help="Folder for the rows (CSV) and the paper's figures, each as picture and data.",
)
@json_option
def command(paper: str, output: Path | None, as_json: bool) -> None:
    """Every number of a source PAPER: published, computed, and who is right.

    Exit status 1 if a number differs and the paper is not shown to be wrong.
    """
    announce_compilation()
    import compass
    from compass.pictures.files import check_folder

    if output is not None:
        check_folder(output)
    found = compass.reproduce(paper)
    if output is not None:
        found.write(output)
        say(f"wrote {readable(output)}")
    print_result(found, as_json)

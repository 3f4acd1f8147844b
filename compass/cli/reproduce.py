"""``compass reproduce``: a source paper, number by number."""

from pathlib import Path

import click

import compass
from compass.cli.options import Word, path
from compass.cli.shared import check_outputs, put
from compass.papers import PAPERS


@click.command()
@click.argument("paper", type=Word(PAPERS))
@path(
    "-o",
    "--output",
    help="Folder for the rows (CSV) and the paper's figures, each as picture and data.",
)
def command(paper: str, output: Path | None) -> object:
    """Every number of a source PAPER: published, computed, and who is right.

    Exit status 1 if a number differs and the paper is not shown to be wrong.
    """
    check_outputs(folders=[output])
    found = compass.reproduce(paper)
    put(found.write, output)
    return found

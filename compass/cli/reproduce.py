"""``compass reproduce``: a source paper, number by number."""

import click

from compass.cli.shared import announce_compilation, json_option, print_result
from compass.papers import PAPERS


@click.command("reproduce")
@click.argument("paper", type=click.Choice(PAPERS))
@json_option
def command(paper: str, as_json: bool) -> None:
    """Every number of a source PAPER: published, computed, and who is right.

    Exit status 1 if a number differs without an erratum on record.
    """
    announce_compilation()
    import compass

    print_result(compass.reproduce(paper), as_json)

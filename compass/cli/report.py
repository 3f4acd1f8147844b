"""``compass report``: one self-contained HTML page about a design, scenario, study or paper."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import area_options, design_argument, path, real, whole
from compass.cli.shared import command_line, watched


@click.command()
@design_argument
@area_options
@path(
    "-o",
    "--output",
    help="Folder for the page and its pictures; by default reports/NAME-OF-THE-FILE.",
)
@real("--step-deg", help="Cell size of a design's maps.  [default: 1.0]")
@whole(
    "--epochs",
    help="Epochs in the period of a design's maps; a prime number meets moments "
    "of symmetry least.  [default: 109]",
)
@path("--store", help="Folder of a study's store; by default trades/NAME-OF-THE-FILE.")
def command(design: Path, **options: Any) -> object:
    """Report on a DESIGN, a scenario, a study or a paper: one HTML page that needs no network.

    A file with a table [study] is a study, and its page is made from the store of `compass
    trade`; one with a table [vehicle] is a scenario of landing; all else is a design. The name
    of a source paper, as of `compass reproduce`, is a page of its numbers beside the computed ones.
    """
    return compass.report(design, **options, command=command_line(), progress=watched())

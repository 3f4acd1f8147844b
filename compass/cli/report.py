"""``compass report``: one self-contained HTML page about a design, scenario, study or paper."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import area_options, design_argument, json_option, path, real, whole
from compass.cli.shared import announce_compilation, command_line, print_result, watched


@click.command("report")
@design_argument
@area_options
@path(
    "-o",
    "--output",
    help="Folder for the page and its pictures; by default reports/NAME-OF-THE-FILE.",
)
@real("--step-deg", help="Cell size of a design's maps, 0.05 to 90 degrees.  [default: 1.0]")
@whole(
    "--epochs",
    help="Epochs in the period of a design's maps, from 1; a prime number meets moments "
    "of symmetry least.  [default: 109]",
)
@path("--store", help="Folder of a study's store; by default trades/NAME-OF-THE-FILE.")
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Report on a DESIGN, a scenario, a study or a paper: one HTML page that needs no network.

    A file with a table [study] is a study, and its page is made from the store of `compass
    trade`; one with a table [vehicle] is a scenario of landing; all else is a design. The name
    of a source paper, as of `compass reproduce`, is a page of its numbers beside the computed ones.
    """
    announce_compilation()
    import compass

    made = compass.report(design, **options, command=command_line(), progress=watched())
    print_result(made, as_json)

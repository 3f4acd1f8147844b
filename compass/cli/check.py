"""``compass check``: every requirement of a design, met or missed."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    certified_options,
    design_argument,
    json_option,
    print_result,
    watched,
)


@click.command()
@design_argument
@click.option("--days", type=float, help="Days to settle it for, at the places; else for ever.")
@click.option("--start-day", type=float, default=0.0, help="Day after the epoch to begin at.")
@click.option(
    "--motion",
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="How the satellites move; else as the design says.",
)
@certified_options
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Settle every [[requirement]] of a design: met or missed, proven or with a bracket.

    Exit status 0 all met, 1 one missed or undecided, 2 bad input.
    """
    announce_compilation()
    import compass

    print_result(compass.check(design, progress=watched(), **options), as_json)

"""``compass check``: every requirement of a design, met or missed."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import (
    certified_options,
    json_option,
    motion_option,
    real,
)
from compass.cli.shared import announce_compilation, print_result, watched


@click.command()
@click.argument("designs", nargs=-1, required=True, type=click.Path(path_type=Path))
@real("--days", help="Days to settle it for, at the places; else for ever.")
@real("--start-day", default=0.0, help="Day after the epoch to begin at.")
@motion_option
@certified_options
@json_option
def command(designs: tuple[Path, ...], as_json: bool, **options: Any) -> None:
    """Settle every [[requirement]] of DESIGNS: met or missed, proven or with a bracket.

    Several DESIGNS are one network: their satellites together, asked for the requirements of all.

    Exit status 0 all met, 1 one missed or undecided, 2 bad input.
    """
    announce_compilation()
    import compass

    print_result(compass.check(*designs, progress=watched(), **options), as_json)

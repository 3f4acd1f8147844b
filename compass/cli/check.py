"""``compass check``: every requirement of a design, met or missed."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    certified_options,
    designs_argument,
    motion_option,
    real,
    start_day_option,
)
from compass.cli.shared import watched


@click.command()
@designs_argument
@real("--days", help="Days to settle it for, at the places; else for ever.")
@start_day_option
@motion_option
@certified_options
def command(designs: tuple[Path, ...], **options: Any) -> object:
    """Settle every [[requirement]] of DESIGNS: met or missed, proven or with a bracket.

    Several DESIGNS are one network: their satellites together, asked for the requirements of all.

    Exit status 0 all met, 1 one missed or undecided, 2 bad input.
    """
    return compass.check(*designs, progress=watched(), **options)

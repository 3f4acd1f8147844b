"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from typing import Any

import click

import compass
from compass.cli.options import (
    design_argument,
    fold_option,
    mask_option,
    motion_option,
    real,
    region_option,
    start_day_option,
    whole,
)
from compass.cli.shared import watched


@click.command()
@design_argument
@fold_option
@mask_option
@whole("--losses", default=0, help="Also what is left after so many failures.")
@region_option
@real("--duration-h", help="Hours from the epoch to look at, not all time.")
@real("--days", help="Days to prove it for, along the satellites' paths.")
@start_day_option
@motion_option
def command(**options: Any) -> object:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    return compass.fold(progress=watched(), **options)

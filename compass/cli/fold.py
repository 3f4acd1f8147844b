"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import (
    design_argument,
    fold_option,
    json_option,
    mask_option,
    motion_option,
    real,
    whole,
)
from compass.cli.shared import announce_compilation, print_result, watched


@click.command()
@design_argument
@fold_option
@mask_option
@whole("--losses", default=0, help="Also what is left after so many failures.")
@click.option(
    "--region", help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."
)
@real("--duration-h", help="Hours from the epoch to look at, not all time.")
@real("--days", help="Days to prove it for, along the satellites' paths.")
@real("--start-day", default=0.0, help="Day after the epoch to begin at.")
@motion_option
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    announce_compilation()
    import compass

    print_result(compass.fold(design, progress=watched(), **options), as_json)

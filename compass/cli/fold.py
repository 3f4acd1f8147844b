"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    design_argument,
    json_option,
    print_result,
    watched,
)


@click.command()
@design_argument
@click.option("--fold", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--losses", type=int, default=0, help="Also what is left after so many failures.")
@click.option(
    "--region", help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."
)
@click.option("--duration-h", type=float, help="Hours from the epoch to look at, not all time.")
@click.option("--days", type=float, help="Days to prove it for, along the satellites' paths.")
@click.option("--start-day", type=float, default=0.0, help="Day after the epoch to begin at.")
@click.option(
    "--motion",
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="How the satellites move; else as the design says.",
)
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    announce_compilation()
    import compass

    print_result(compass.fold(design, progress=watched(), **options), as_json)

"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from pathlib import Path

import click

from compass.cli.shared import announce_compilation, design_argument, json_option, print_result


@click.command()
@design_argument
@click.option("--fold", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--losses", type=int, default=0, help="Also what is left after so many failures.")
@click.option(
    "--region", help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."
)
@click.option("--duration-h", type=float, help="Hours from the epoch to look at, not all time.")
@json_option
def command(
    design: Path,
    fold: int | None,
    mask_deg: float | None,
    losses: int,
    region: str | None,
    duration_h: float | None,
    as_json: bool,
) -> None:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    announce_compilation()
    import compass

    found = compass.fold(
        design,
        fold=fold,
        mask_deg=mask_deg,
        losses=losses,
        region=region,
        duration_h=duration_h,
        progress=True,
    )
    print_result(found, as_json)

"""``compass keep``: station-keeping of a design, simulated."""

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
@click.option("--years", type=float, help="Time to simulate; else the design's, 1.")
@click.option(
    "--box-deg", type=float, help="Half width of the box along the track; else half the margin."
)
@click.option("--fold", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--specific-impulse-s", type=float, help="Else the design's, 220.")
@click.option("--dry-mass-kg", type=float, help="Without propellant; else the design's, 100.")
@click.option("--smallest-burn-m-s", type=float, help="Least impulse; else the design's, 0.005.")
@click.option("--execution-error", type=float, help="Relative; else the design's, 0.01.")
@click.option("--navigation-error-m", type=float, help="Along the track; else the design's, 1000.")
@click.option("--seed", type=int, default=0, show_default=True, help="Of the errors.")
@click.option(
    "--radius-km",
    help="Also how long it lasts untouched at other radii: FIRST..LAST:STEP, or A,B,C, km.",
)
@json_option
def command(design: Path, radius_km: str | None, as_json: bool, **options: Any) -> None:
    """Simulate impulsive station-keeping of every satellite of a DESIGN in its slot.

    Exit status 0 if all stay within the margin, 1 if not.
    """
    announce_compilation()
    import compass
    from compass.api.radii import read_radii

    radii = [] if radius_km is None else read_radii(radius_km)
    print_result(compass.keep(design, radius_km=radii, progress=watched(), **options), as_json)

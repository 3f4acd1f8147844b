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
@click.option("--years", type=float, default=1.0, show_default=True, help="Time to simulate.")
@click.option(
    "--box-deg", type=float, help="Half width of the box along the track; else half the margin."
)
@click.option("--fold", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--specific-impulse-s", type=float, default=220.0, show_default=True)
@click.option("--dry-mass-kg", type=float, default=100.0, show_default=True)
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Simulate impulsive station-keeping of every satellite of a DESIGN in its slot.

    Exit status 0 if all stay within the margin, 1 if not.
    """
    announce_compilation()
    import compass

    print_result(compass.keep(design, progress=watched(), **options), as_json)

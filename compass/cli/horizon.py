"""``compass horizon``: horizons of stations from a grid of heights."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import choice, design_argument, path, real, whole
from compass.cli.shared import check_outputs, put, watched


@click.command()
@design_argument
@path("--terrain", required=True, help="GeoTIFF or netCDF grid of heights.")
@click.option("--variable", help="Name of the heights in a netCDF file that has several.")
@choice(
    "--latitude-kind",
    among=["planetocentric", "planetographic"],
    default="planetocentric",
    help="Kind of latitude of a netCDF grid.",
)
@real("--above-m", default=0.0, help="Height of stations over the ground, m.")
@whole("--azimuths", default=360, help="Steps all around.")
@path("-o", "--output", help="Write the design with the horizons.")
def command(output: Path | None, **options: Any) -> object:
    """Draw the horizon of every station from terrain, and write it into a design file."""
    check_outputs(output)
    found = compass.horizon(progress=watched(), **options)
    put(found.write, output)
    return found

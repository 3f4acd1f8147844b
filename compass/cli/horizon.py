"""``compass horizon``: horizons of stations from a grid of heights."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import choice, design_argument, json_option, path, real, whole
from compass.cli.shared import announce_compilation, print_result, say, watched


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
@json_option
def command(output: Path | None, design: Path, as_json: bool, **options: Any) -> None:
    """Draw the horizon of every station from terrain, and write it into a design file."""
    announce_compilation()
    import compass
    from compass.saving import check_writable

    if output is not None:
        check_writable(output)
    found = compass.horizon(design, progress=watched(), **options)
    print_result(found, as_json)
    if output is not None:
        found.write(output)
        say(f"wrote {output}")

"""``compass determine``: who tracks the satellites, and how well they are known for it."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import choice, design_argument, motion_option, path, real
from compass.cli.shared import check_drawn, check_outputs, put


@click.command()
@design_argument
@real("--days", help="Arc of tracking from the epoch; else the design's.")
@real("--update-h", help="Hours between uploads, the prediction; else the design's.")
@motion_option
@path("-o", "--output", help="Design file to write, with the [signal] that follows.")
@path("--figure", "picture", help="PNG of sigma against time, or of who tracks whom when.")
@choice(
    "--of",
    "drawn",
    among=["tracking", "components", "schedule"],
    default="tracking",
    help="What the picture shows: sigma by tracking, by component, or the schedule.",
)
def command(
    design: Path, output: Path | None, picture: Path | None, drawn: str, **options: Any
) -> object:
    """Covariance of the orbits and clocks of a DESIGN, tracked as its [tracking] says.

    Radial, along, cross and clock sigma of every satellite against time, what each kind of
    tracking buys, and the [signal] for the users that follows.
    """
    check_drawn(picture, "drawn")
    check_outputs(output, picture, inputs=[design])
    found = compass.determine(design, **options)
    put(found.write, output)
    put(lambda file: found.save_plot(file, drawn), picture)
    return found

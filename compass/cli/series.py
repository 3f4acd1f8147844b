"""``compass series``: what stations see over time."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    choice,
    designs_argument,
    fold_option,
    motion_option,
    path,
    real,
    start_day_option,
    stations_option,
    whole,
)
from compass.cli.shared import check_drawn, check_outputs, command_line, put


@click.command()
@designs_argument
@stations_option
@click.option(
    "--beacon",
    "beacons",
    multiple=True,
    metavar="SITE",
    help="A beacon on the ground, counted as a satellite is: a station's name, or as a --station.",
)
@click.option(
    "--route",
    "routes",
    multiple=True,
    metavar="NAME=LAT,LON;...",
    help="A rover that goes through these places, evenly over the span; needs a [signal].",
)
@click.option(
    "--orbiter",
    "orbiters",
    multiple=True,
    metavar="NAME=KM,E,INC,RAAN,ARGP,M",
    help="A user in orbit: semi-major axis, eccentricity, degrees at the epoch; needs a [signal].",
)
@real("--beam-deg", help="Half angle of the satellites' antennas.")
@fold_option
@real("--mask-deg", help="Elevation mask, degrees; the higher of it and a station's own horizon.")
@real("--days", default=10.0, help="Length of the span.")
@start_day_option
@whole("--epochs", default=1009, help="Moments at which dilutions are looked at.")
@motion_option
@path("-o", "--output", help="Write counts and dilutions over time: .nc or .csv.")
@path("--figure", "picture", help="PNG curve to draw.")
@choice(
    "--of",
    "drawn",
    among=[
        "count",
        "gdop",
        "pdop",
        "hdop",
        "vdop",
        "tdop",
        "age_h",
        "error_horizontal_m",
        "error_vertical_m",
        "error_position_m",
        "error_time_m",
    ],
    default="count",
    help="What the curve shows.",
)
def command(
    designs: tuple[Path, ...],
    output: Path | None,
    picture: Path | None,
    drawn: str,
    **options: Any,
) -> object:
    """Follow what users see over time: satellites in view, dilutions, gaps, errors in metres.

    Several DESIGNS are one network. Gaps are found by rise and set, dilutions at moments.

    Exit status 0 no gap, 1 a station has one, 2 bad input.
    """
    from compass.api.access_result import check_suffix
    from compass.api.series import SUFFIXES

    check_suffix(output, SUFFIXES)
    check_drawn(picture, "drawn")
    check_outputs(output, picture, inputs=designs)
    found = compass.series(*designs, **options)
    put(lambda file: found.write(file, command=command_line()), output)
    put(lambda file: found.save_plot(file, drawn), picture)
    return found

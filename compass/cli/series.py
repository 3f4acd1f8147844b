"""``compass series``: what stations see over time."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import choice, fold_option, json_option, motion_option, path, real, whole
from compass.cli.shared import (
    announce_compilation,
    check_drawn,
    check_outputs,
    command_line,
    print_result,
    say_written,
)


@click.command("series")
@click.argument("designs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--station",
    "stations",
    multiple=True,
    metavar="NAME=LAT,LON[,MASK]",
    help="A station beside the designs': planetocentric latitude, east longitude, mask; degrees.",
)
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
@real("--beam-deg", help="Half angle of the satellites' antennas, above 0 to 90 degrees.")
@fold_option
@real("--mask-deg", help="Elevation mask, degrees; the higher of it and a station's own horizon.")
@real("--days", default=10.0, help="Length of the span, above 0 to 1000 days.")
@real("--start-day", default=0.0, help="Day after the epoch to begin at.")
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
@json_option
def command(
    designs: tuple[Path, ...],
    output: Path | None,
    picture: Path | None,
    drawn: str,
    as_json: bool,
    **options: Any,
) -> None:
    """Follow what users see over time: satellites in view, dilutions, gaps, errors in metres.

    Several DESIGNS are one network. Gaps are found by rise and set, dilutions at moments.

    Exit status 0 no gap, 1 a station has one, 2 bad input.
    """
    announce_compilation()
    import compass
    from compass.api.access_result import check_suffix
    from compass.api.series import SUFFIXES

    if output:
        check_suffix(output, SUFFIXES)
    check_drawn(picture, "drawn")
    check_outputs(output, picture, inputs=designs)
    found = compass.series(*designs, **options)
    if output:
        found.write(output, command=command_line())
    if picture:
        found.save_plot(picture, drawn)
    print_result(found, as_json)
    say_written(output, picture)

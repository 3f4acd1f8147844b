"""``compass access``: when stations, moons, the Earth and satellites see each other."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import choice, design_argument, json_option, motion_option, path, real
from compass.cli.shared import announce_compilation, command_line, print_result, say


@click.command("access")
@design_argument
@real(
    "--duration-sols",
    help="Span from the design's epoch, above 0 to 1000 sols.  [default: the design's, else 10]",
)
@click.option(
    "--station",
    "stations",
    multiple=True,
    metavar="NAME=LAT,LON[,MASK]",
    help="A station beside the design's: planetocentric latitude, east longitude, mask; degrees.",
)
@choice("--moon", "moons", among=["phobos", "deimos"], multiple=True, help="Link with a moon.")
@click.option("--earth", is_flag=True, help="Link with the Earth.")
@click.option("--crosslinks", is_flag=True, help="Link satellites with each other.")
@click.option("--eclipse", is_flag=True, help="Find when satellites and moons are in shadow.")
@motion_option
@real("--start-day", default=0.0, help="Day after the epoch to begin at.")
@choice(
    "--moon-model", among=["precessing", "circular"], default="precessing", help="How moons move."
)
@click.option("--pairs", is_flag=True, help="Print a line for every pair.")
@path("-o", "--output", help="Write all windows to a file: .nc, .csv or .json.")
@json_option
def command(design: Path, output: Path | None, as_json: bool, **options: Any) -> None:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch, or after its --start-day.
    """
    announce_compilation()
    import compass
    from compass.api.access_result import check_suffix
    from compass.saving import check_writable

    if output:
        check_writable(check_suffix(output), [design])
    found = compass.access(design, **options)
    if output:
        found.write(output, command=command_line())
        say(f"wrote {output}")
    print_result(found, as_json)

"""``compass access``: when stations, moons, the Earth and satellites see each other."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    choice,
    design_argument,
    motion_option,
    path,
    real,
    start_day_option,
    stations_option,
)
from compass.cli.shared import check_outputs, command_line, put


@click.command()
@design_argument
@real(
    "--duration-sols",
    help="Span from the design's epoch.  [default: the design's, else 10]",
)
@stations_option
@choice("--moon", "moons", among=["phobos", "deimos"], multiple=True, help="Link with a moon.")
@click.option("--earth", is_flag=True, help="Link with the Earth.")
@click.option("--crosslinks", is_flag=True, help="Link satellites with each other.")
@click.option("--eclipse", is_flag=True, help="Find when satellites and moons are in shadow.")
@motion_option
@start_day_option
@choice(
    "--moon-model", among=["precessing", "circular"], default="precessing", help="How moons move."
)
@click.option("--pairs", is_flag=True, help="Print a line for every pair.")
@path("-o", "--output", help="Write all windows to a file: .nc, .csv or .json.")
def command(design: Path, output: Path | None, **options: Any) -> object:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch, or after its --start-day.
    """
    from compass.api.access_result import check_suffix

    check_suffix(output)
    check_outputs(output, inputs=[design])
    found = compass.access(design, **options)
    put(lambda file: found.write(file, command=command_line()), output)
    return found

"""``compass land``: how well a lander navigates on radio beacons."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import figures_option, path, real, scenario_argument, whole
from compass.cli.shared import (
    check_outputs,
    command_line,
    put,
    put_pictures,
    say,
    watched,
)


@click.command()
@scenario_argument
@path("-o", "--output", help="netCDF file to write.")
@figures_option
@whole("--runs", help="Monte Carlo runs.")
@real(
    "--start-day",
    help="Day after the beacons' epoch at which entry begins; else the scenario's.",
)
@click.option("--strict", is_flag=True, help="Exit with 1 if a filter is inconsistent.")
def command(scenario: Path, output: Path | None, figures: Path | None, **options: Any) -> object:
    """Fly a SCENARIO and navigate it: trajectory, view, observability, bound and filter.

    A scenario with a table [fusion] is also flown with accelerometers and ranges in centralised
    and distributed filters, through plasma and faults if it has them.
    """
    check_outputs(output, folders=[figures], inputs=[scenario])
    found = compass.land(
        scenario, **options, command=command_line(), progress=watched(), notice=say
    )
    put(found.write, output)
    put_pictures(found.pictures, figures)
    return found

"""``compass optimize``: the best beacons or orbits for a lander."""

from pathlib import Path

import click

import compass
from compass.cli.options import figures_option, scenario_argument
from compass.cli.shared import check_outputs, command_line, put_pictures, watched


@click.command()
@scenario_argument
@figures_option
def command(scenario: Path, figures: Path | None) -> object:
    """Search for the best beacons or orbits, as the SCENARIO's [optimize] table asks."""
    check_outputs(folders=[figures])
    found = compass.optimize(scenario, command=command_line(), progress=watched())
    put_pictures(found.pictures, figures)
    return found

"""``compass locate``: the place of a user who stands still, with however few satellites."""

from typing import Any

import click

import compass
from compass.cli.options import design_argument, real, start_day_option


@click.command()
@design_argument
@click.option("--site", required=True, help="A station of the design, or NAME=LAT,LON in degrees.")
@click.option("--satellites", help="Those that are there already: A,B,C; all if left out.")
@real("--hours", default=6.0, help="How long the user stands.")
@real("--step-s", default=60.0, help="Between measurements, s.")
@start_day_option
@real("--goal-m", default=10.0, help="One sigma of the place that is wanted.")
@real("--height-m", default=10.0, help="One sigma of the height where it is known.")
@real("--doppler-m-s", default=0.001, help="One sigma of a range rate.")
@click.option(
    "--clock", default="uso", show_default=True, help="The user's clock where it is held."
)
def command(satellites: str | None, **options: Any) -> object:
    """Find how well a user who stands still knows his place from ranges and Doppler over time.

    With one to three satellites of a DESIGN in view there is no fix at a moment, but hours of
    standing make one. Exit status 0 if the goal is met with a held clock and a known height.
    """
    names = [name.strip() for name in (satellites or "").split(",") if name.strip()]
    return compass.locate(satellites=names, **options)

"""``compass judge``: candidate constellations ranked by landing-navigation quality."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    area_options,
    designs_argument,
    path,
    real,
    start_day_option,
    whole,
)
from compass.cli.shared import command_line, say, watched


@click.command()
@designs_argument
@area_options
@path("-s", "--scenario", required=True, help="Scenario file of the lander.")
@whole("--samples", default=1024, help="Entries to judge on.")
@whole("--seed", default=0, help="Of sites, times and noise.")
@real("--goal-m", default=10.0, help="Position wanted, m.")
@real("--density-sigma", default=0.0, help="Unknown density, relative; known if left out.")
@real("--lift-sigma", default=0.0, help="Unknown L/D, relative; known if left out.")
@real("--clock-m", default=3e4, help="Lander's clock at first, m.")
@real("--clock-drift-m-s", default=0.3, help="Its drift, m/s.")
@real(
    "--orbit-m", nargs=3, default=(2.0, 8.0, 5.0), help="Broadcast orbits: radial, along, cross, m."
)
@real("--satellite-clock-m", default=3.0, help="Their clocks, m.")
@real("--range-bias-m", default=1.0, help="Of each range, m.")
@whole("--finalists", default=3, help="Run the filter on them.")
@whole("--runs", default=512, help="Filter runs of each.")
@path("--rival", help="Find the best Walker delta of the first design's size, and write it there.")
@real("--rival-radius-km", help="Its orbits' radius; the first design's if left out.")
@start_day_option
@path(
    "-o",
    "--report",
    "folder",
    help="Folder for an HTML page with maps and distributions; none is made if left out.",
)
def command(designs: tuple[Path, ...], folder: Path | None, **options: Any) -> object:
    """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

    The lander of the scenario is flown to parachute deployment (its trigger of that name, or the
    end of the scenario) at sites over the whole globe, or at those named, at moments over the
    repeat period. Ranked by the 95th percentile of the Cramer-Rao bound of position there,
    blackout taken into account.
    """
    from compass.pages.page import check_page_folder

    if folder is not None:
        check_page_folder(folder)
    found = compass.judge(designs, **options, command=command_line(), progress=watched())
    if options["rival"] is not None:
        say(f"wrote {options['rival']}")
    if folder is not None:
        made = compass.report(found, output=folder, command=command_line(), progress=watched())
        say(f"report: {made.page}")
    return found

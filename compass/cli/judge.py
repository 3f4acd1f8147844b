"""``compass judge``: candidate constellations ranked by landing-navigation quality."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    json_option,
    print_result,
    say,
    watched,
)

if TYPE_CHECKING:
    from compass.api.judge import JudgeResult


@click.command()
@click.argument("designs", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option(
    "-s",
    "--scenario",
    type=click.Path(path_type=Path),
    required=True,
    help="Scenario file of the lander.",
)
@click.option("--samples", type=int, default=1024, show_default=True, help="Entries to judge on.")
@click.option("--seed", type=int, default=0, show_default=True, help="Of sites, times and noise.")
@click.option("--goal-m", type=float, default=10.0, show_default=True, help="Position wanted, m.")
@click.option(
    "--density-sigma", type=float, default=0.0, help="Unknown density, relative; known if left out."
)
@click.option(
    "--lift-sigma", type=float, default=0.0, help="Unknown L/D, relative; known if left out."
)
@click.option(
    "--clock-m", type=float, default=3e4, show_default=True, help="Lander's clock at first, m."
)
@click.option(
    "--clock-drift-m-s", type=float, default=0.3, show_default=True, help="Its drift, m/s."
)
@click.option(
    "--orbit-m",
    type=float,
    nargs=3,
    default=(2.0, 8.0, 5.0),
    show_default=True,
    help="Broadcast orbits: radial, along, cross, m.",
)
@click.option(
    "--satellite-clock-m", type=float, default=3.0, show_default=True, help="Their clocks, m."
)
@click.option(
    "--range-bias-m", type=float, default=1.0, show_default=True, help="Of each range, m."
)
@click.option("--finalists", type=int, default=3, show_default=True, help="Run the filter on them.")
@click.option("--runs", type=int, default=512, show_default=True, help="Filter runs of each.")
@click.option(
    "--rival",
    type=click.Path(path_type=Path),
    help="Find the best Walker delta of the first design's size, and write it there.",
)
@click.option(
    "--rival-radius-km", type=float, help="Its orbits' radius; the first design's if left out."
)
@click.option(
    "--start-day", type=float, default=0.0, help="Day after the epochs on whose orbits to judge."
)
@click.option(
    "-o",
    "--report",
    "folder",
    type=click.Path(path_type=Path),
    help="Folder for an HTML page with maps and distributions; none is made if left out.",
)
@json_option
def command(designs: tuple[Path, ...], folder: Path | None, as_json: bool, **options: Any) -> None:
    """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

    The lander of the scenario is flown to parachute deployment (its trigger of that name, or the
    end of the scenario) at sites over the whole globe, at moments over the repeat period. Ranked
    by the 95th percentile of the Cramer-Rao bound of position there, blackout taken into account.
    """
    announce_compilation()
    import compass
    from compass.pages.page import check_page_folder

    if folder is not None:
        check_page_folder(folder)
    found = compass.judge(designs, **options, command=command_line(), progress=watched())
    if options["rival"] is not None:
        say(f"wrote {options['rival']}")
    if folder is not None:
        _write_page(folder, found)
    print_result(found, as_json)


def _write_page(folder: Path, found: "JudgeResult") -> None:
    from compass.pages.judge import judge_report
    from compass.pages.page import write_page

    page, sections = judge_report(found.ranking, found.designs, found.scenario, command_line())
    say(f"report: {write_page(folder, page, sections)}")

"""``compass land``: how well a lander navigates on radio beacons."""

from pathlib import Path

import click

from compass.cli.options import json_option, path, real
from compass.cli.shared import announce_compilation, command_line, print_result, say, watched


@click.command("land")
@click.argument("scenario", type=click.Path(path_type=Path))
@path("-o", "--output", help="netCDF file to write.")
@path("--figures", help="Folder to write the pictures (SVG, maps PNG) into.")
@click.option("--runs", type=click.IntRange(1, 100_000), help="Monte Carlo runs, 1 to 100000.")
@real(
    "--start-day",
    help="Day after the beacons' epoch at which entry begins; else the scenario's.",
)
@click.option("--strict", is_flag=True, help="Exit with 1 if a filter is inconsistent.")
@json_option
def command(
    scenario: Path,
    output: Path | None,
    figures: Path | None,
    runs: int | None,
    start_day: float | None,
    strict: bool,
    as_json: bool,
) -> None:
    """Fly a SCENARIO and navigate it: trajectory, view, observability, bound and filter.

    A scenario with a table [fusion] is also flown with accelerometers and ranges in centralised
    and distributed filters, through plasma and faults if it has them.
    """
    announce_compilation()
    import compass
    from compass.pictures.files import check_folder, write_pictures
    from compass.saving import check_writable

    if output:
        check_writable(output, [scenario])
    if figures:
        check_folder(figures)
    found = compass.land(
        scenario,
        runs=runs,
        start_day=start_day,
        strict=strict,
        command=command_line(),
        progress=watched(),
        notice=say,
    )
    if output:
        found.write(output)
        say(f"wrote {output}")
    if figures:
        pictures = found.pictures()
        write_pictures(pictures, figures)
        say(f"wrote {len(pictures)} pictures into {figures}")
    print_result(found, as_json)

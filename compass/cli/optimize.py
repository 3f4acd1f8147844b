"""``compass optimize``: the best beacons or orbits for a lander."""

from pathlib import Path

import click

from compass.cli.options import json_option, path
from compass.cli.shared import announce_compilation, command_line, print_result, say, watched


@click.command("optimize")
@click.argument("scenario", type=click.Path(path_type=Path))
@path("--figures", help="Folder to write the pictures (SVG, maps PNG) into.")
@json_option
def command(scenario: Path, figures: Path | None, as_json: bool) -> None:
    """Search for the best beacons or orbits, as the SCENARIO's [optimize] table asks."""
    announce_compilation()
    import compass
    from compass.pictures.files import check_folder, write_pictures

    if figures:
        check_folder(figures)
    found = compass.optimize(scenario, command=command_line(), progress=watched())
    if figures:
        pictures = found.pictures()
        write_pictures(pictures, figures)
        say(f"wrote {len(pictures)} pictures into {figures}")
    print_result(found, as_json)

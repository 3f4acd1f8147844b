"""``compass determine``: who tracks the satellites, and how well they are known for it."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    design_argument,
    json_option,
    print_result,
    say,
)


@click.command()
@design_argument
@click.option("--days", type=float, help="Arc of tracking from the epoch; else the design's.")
@click.option(
    "--update-h", default=6.0, show_default=True, help="Hours between uploads: the prediction."
)
@click.option(
    "--motion",
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="How the satellites move; else as the design says.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Design file to write, with the [signal] that follows.",
)
@click.option(
    "--figure", "picture", type=click.Path(path_type=Path), help="PNG of sigma against time."
)
@json_option
def command(
    design: Path, output: Path | None, picture: Path | None, as_json: bool, **options: Any
) -> None:
    """Covariance of the orbits and clocks of a DESIGN, tracked as its [tracking] says.

    Radial, along, cross and clock sigma of every satellite against time, what each kind of
    tracking buys, and the [signal] for the users that follows.
    """
    announce_compilation()
    import compass
    from compass.saving import check_writable

    for path in (output, picture):
        if path is not None:
            check_writable(path, [design])
    found = compass.determine(design, **options)
    if output:
        found.write(output)
    if picture:
        found.save_plot(picture)
    print_result(found, as_json)
    for path in (output, picture):
        if path:
            say(f"wrote {path}")

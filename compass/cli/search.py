"""``compass search``: the smallest pattern with continuous k-fold coverage."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    json_option,
    print_result,
    say,
    watched,
)


@click.command()
@click.option("--fold", type=int, required=True, help="Satellites to be in view at once.")
@click.option("--mask-deg", type=float, default=0.0, show_default=True, help="Elevation mask.")
@click.option("--radius-km", type=float, help="Orbit radius from Mars's centre.")
@click.option("--altitude-km", type=float, help="Orbit altitude over the equator.")
@click.option("--orbit", type=click.Choice(["areosynchronous"]), help="An orbit by name.")
@click.option(
    "--repeat",
    type=int,
    nargs=2,
    help="Revolutions and rotations of Mars after which the ground track closes.",
)
@click.option("--max-satellites", type=int, required=True, help="Largest size to try.")
@click.option(
    "--beyond",
    type=int,
    default=0,
    show_default=True,
    help="Sizes to try beyond the smallest that has the fold.",
)
@click.option(
    "--pattern",
    type=click.Choice(["walker-delta", "walker-star", "rosette"]),
    default="walker-delta",
    show_default=True,
    help="Kind of pattern.",
)
@click.option(
    "--figure",
    type=click.Choice(["iau-sphere", "kelly2018-sphere"]),
    default="iau-sphere",
    show_default=True,
    help="Sphere that is to be covered.",
)
@click.option("--finalists", type=int, default=10, show_default=True, help="How many to certify.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Write the best as a design.")
@json_option
def command(output: Path | None, as_json: bool, **options: Any) -> None:
    """Find the smallest pattern with continuous k-fold coverage of the whole sphere.

    Every pattern, size after size up to the smallest that has it, each at its best inclination to
    0.01 degree; smallest first, then largest mask margin. Exit status 1 if there is none.
    """
    announce_compilation()
    import compass
    from compass.saving import check_writable

    if output is not None:
        check_writable(output)
    found = compass.search(**options, progress=watched())
    print_result(found, as_json)
    if output is not None:
        found.write(output, command=command_line())
        say(f"wrote {output}")

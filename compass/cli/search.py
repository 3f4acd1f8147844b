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
from compass.orbits.kinds import KIND_NAMES


@click.command()
@click.option(
    "--require", type=click.Path(path_type=Path), help="File with [[requirement]], or a design."
)
@click.option("--fold", type=int, help="Satellites to be in view at once.")
@click.option("--region", multiple=True, help="globe, lat:MIN:MAX or polygon:LAT,LON;..., degrees.")
@click.option("--pdop-at-most", type=float, help="Largest PDOP allowed there.")
@click.option("--gdop-at-most", type=float, help="Largest GDOP allowed there.")
@click.option("--share", type=float, default=1.0, show_default=True, help="For how much of it.")
@click.option(
    "--share-of",
    type=click.Choice(["time", "area-time"]),
    default="time",
    show_default=True,
    help="Of the time at the worst place, or of area and time.",
)
@click.option(
    "--least-approach-deg",
    type=float,
    default=1.0,
    show_default=True,
    help="Least angle between two satellites at any time.",
)
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
    type=click.Choice(KIND_NAMES),
    default=KIND_NAMES[0],
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
    """Find the smallest pattern that meets requirements, or covers the whole sphere k-fold.

    Requirements are those of a file (--require), or --fold, --region and limits on geometry; size
    after size is tried. Ends with the sentence that says what to build. Exit status 1 if there is
    none.
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

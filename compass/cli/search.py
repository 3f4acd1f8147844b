"""``compass search``: the smallest pattern with continuous k-fold coverage."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import choice, path, real, whole
from compass.cli.shared import check_outputs, command_line, put, watched
from compass.orbits.kinds import KIND_NAMES


def _radius(_context: click.Context, _option: click.Parameter, text: str | None) -> object:
    """One radius, or the least and the greatest."""
    if text is None:
        return None
    try:
        numbers = tuple(float(part) for part in text.split(":"))
    except ValueError:
        numbers = ()
    if len(numbers) in (1, 2):
        return numbers if len(numbers) == 2 else numbers[0]
    raise click.BadParameter(f"{text!r} is not a number or LEAST:MOST, such as 9000:26000.")


@click.command()
@path("--require", help="File with [[requirement]], or a design.")
@whole("--fold", help="Satellites to be in view at once.")
@click.option("--region", multiple=True, help="globe, lat:MIN:MAX or polygon:LAT,LON;..., degrees.")
@real("--pdop-at-most", help="Largest PDOP allowed there.")
@real("--gdop-at-most", help="Largest GDOP allowed there.")
@real("--share", default=1.0, help="For how much of it: 0.95 is 95 %.")
@choice(
    "--share-of",
    among=["time", "area-time"],
    default="time",
    help="Of the time at the worst place, or of area and time.",
)
@real("--least-approach-deg", default=1.0, help="Least angle between two satellites at any time.")
@real("--mask-deg", default=0.0, help="Elevation mask, degrees.")
@click.option(
    "--radius-km",
    metavar="R or LEAST:MOST",
    callback=_radius,
    help="Orbit radius from Mars's centre; of requirements also a range, nine radii of it.",
)
@real("--altitude-km", help="Orbit altitude over the equator.")
@choice("--orbit", among=["areosynchronous"], help="An orbit by name.")
@whole(
    "--repeat",
    nargs=2,
    help="Revolutions and rotations of Mars after which the ground track closes.",
)
@whole("--max-satellites", required=True, help="Largest size to try.")
@whole("--beyond", default=0, help="Sizes to try beyond the smallest that has the fold.")
@choice("--pattern", among=KIND_NAMES, default=KIND_NAMES[0], help="Kind of pattern.")
@choice(
    "--figure",
    among=["iau-sphere", "kelly2018-sphere"],
    default="iau-sphere",
    help="Sphere that is to be covered.",
)
@whole("--finalists", default=10, help="How many to certify.")
@real("--days", help="Days for which it must hold on real orbits that nobody steers, too.")
@real("--budget-s", help="Seconds for each share of geometry wanted.")
@path("-o", "--output", help="Write the best as a design.")
def command(output: Path | None, **options: Any) -> object:
    """Find the smallest pattern that meets requirements, or covers the whole sphere k-fold.

    Requirements are those of a file (--require), or --fold, --region and limits on geometry; size
    after size is tried. Ends with the sentence that says what to build. Exit status 1 if there is
    none.
    """
    check_outputs(output)
    found = compass.search(**options, progress=watched())
    put(lambda file: found.write(file, command=command_line()), output)
    return found

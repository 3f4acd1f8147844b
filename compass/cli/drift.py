"""``compass drift``: a design left alone on real orbits; how long its coverage lasts."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    design_argument,
    json_option,
    print_result,
    say,
    watched,
)


@click.command()
@design_argument
@click.option("--days", type=float, default=687.0, show_default=True, help="Length of the span.")
@click.option(
    "--start-day", type=float, default=0.0, show_default=True, help="Its begin after the epoch."
)
@click.option("--step-days", type=float, help="Between the moments that are listed.")
@click.option("--fold", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--trim", "trimmed", is_flag=True, help="Trim the initial axes first.")
@click.option(
    "--radius-km", help="Also how long it lasts at other radii: FIRST..LAST:STEP, or A,B,C, km."
)
@click.option("--avoid-km", type=float, help="Distance to keep from the moons' centres.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write margin, room and places in the slots over time as netCDF (.nc).",
)
@click.option(
    "--elements",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write the elements to inject as a design file (with --trim).",
)
@json_option
def command(
    design: Path,
    radius_km: str | None,
    output: Path | None,
    elements: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Follow a DESIGN that is left alone: margin and room over time, the first loss, proven.

    Exit status 0 if the fold is proven for all the days, 1 if it is lost or undecided.
    """
    announce_compilation()
    import compass
    from compass.api.radii import read_radii
    from compass.saving import check_writable

    for written in (output, elements):
        if written is not None:
            check_writable(written, [design])
    radii = [] if radius_km is None else read_radii(radius_km)
    found = compass.drift(design, radius_km=radii, progress=watched(), **options)
    if elements is not None:
        found.write_elements(elements)
    if output is not None:
        found.write(output, command=command_line())
        say(f"wrote {output}")
    print_result(found, as_json)

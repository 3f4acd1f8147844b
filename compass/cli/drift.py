"""``compass drift``: a design left alone on real orbits; how long its coverage lasts."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import design_argument, fold_option, json_option, mask_option, real
from compass.cli.shared import (
    announce_compilation,
    check_outputs,
    command_line,
    print_result,
    say_written,
    watched,
)


@click.command()
@design_argument
@real("--days", default=687.0, help="Length of the span.")
@real("--start-day", default=0.0, help="Its begin after the epoch.")
@real("--step-days", help="Between the moments that are listed.")
@fold_option
@mask_option
@click.option(
    "--region", help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."
)
@click.option("--trim", "trimmed", is_flag=True, help="Trim the initial axes first.")
@click.option(
    "--radius-km", help="Also how long it lasts at other radii: FIRST..LAST:STEP, or A,B,C, km."
)
@real("--avoid-km", help="Distance to keep from the moons' centres.")
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
@click.option(
    "--oem",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write the orbits of these elements as OEM, a new folder of files (with --trim).",
)
@json_option
def command(
    design: Path,
    radius_km: str | None,
    output: Path | None,
    elements: Path | None,
    oem: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Follow a DESIGN that is left alone: margin and room over time, the first loss, proven.

    Exit status 0 if what the design requires (without requirements the fold) is proven for all the
    days, 1 if it is lost or undecided.
    """
    announce_compilation()
    import compass
    from compass.api.drift_files import check_trimmed
    from compass.api.radii import read_radii
    from compass.saving import check_new_folder

    check_outputs(output, elements, inputs=[design])
    if elements is not None or oem is not None:
        check_trimmed(options["trimmed"])
    if oem is not None:
        check_new_folder(oem)
    radii = [] if radius_km is None else read_radii(radius_km)
    found = compass.drift(design, radius_km=radii, progress=watched(), **options)
    if elements is not None:
        found.write_elements(elements)
    if oem is not None:
        found.write_orbits(oem)
    if output is not None:
        found.write(output, command=command_line())
    say_written(elements, oem, output)
    print_result(found, as_json)

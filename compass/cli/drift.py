"""``compass drift``: a design left alone on real orbits; how long its coverage lasts."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    design_argument,
    fold_option,
    mask_option,
    path,
    radii_option,
    real,
    region_option,
    start_day_option,
)
from compass.cli.shared import check_outputs, command_line, put, watched


@click.command()
@design_argument
@real("--days", default=687.0, help="Length of the span.")
@start_day_option
@real("--step-days", help="Between the moments that are listed.")
@fold_option
@mask_option
@region_option
@click.option("--trim", "trimmed", is_flag=True, help="Trim the initial axes first.")
@radii_option
@real("--avoid-km", help="Distance to keep from the moons' centres.")
@path("-o", "--output", help="Write margin, room and places in the slots over time: .nc.")
@path("--elements", help="Write the elements to inject as a design file (with --trim).")
@path("--oem", help="Write the orbits of these elements as OEM, a new folder (with --trim).")
def command(
    design: Path, output: Path | None, elements: Path | None, oem: Path | None, **options: Any
) -> object:
    """Follow a DESIGN that is left alone: margin and room over time, the first loss, proven.

    Exit status 0 if what the design requires (without requirements the fold) is proven for all the
    days, 1 if it is lost or undecided.
    """
    from compass.api.drift_files import check_trimmed
    from compass.saving import check_new_folder

    check_outputs(output, elements, inputs=[design])
    if elements is not None or oem is not None:
        check_trimmed(options["trimmed"])
    if oem is not None:
        check_new_folder(oem)
    found = compass.drift(design, progress=watched(), **options)
    put(found.write_elements, elements)
    put(found.write_orbits, oem)
    put(lambda file: found.write(file, command=command_line()), output)
    return found

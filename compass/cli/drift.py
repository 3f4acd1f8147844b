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
@click.option(
    "--region",
    help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere.",
)
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
    from compass.api.drift import read_radii
    from compass.api.drift_files import check_trimmed, write_elements, write_orbits
    from compass.saving import check_new_folder, check_writable, save_netcdf
    from compass.study.mapping import provenance

    if output is not None:
        check_writable(output, [design])
    if elements is not None or oem is not None:
        check_trimmed(options["trimmed"])
    if oem is not None:
        check_new_folder(oem)
    radii = [] if radius_km is None else read_radii(radius_km)
    found = compass.drift(design, radius_km=radii, progress=watched(), **options)
    if elements is not None:
        write_elements(found, elements, design)
    if oem is not None:
        write_orbits(found, oem)
        say(f"wrote {oem}")
    if output is not None:
        made = provenance(found.design, command_line())
        known = {name: words for name, words in made.items() if words}
        save_netcdf(output, found.dataset.assign_attrs(known))
        say(f"wrote {output}")
    print_result(found, as_json)

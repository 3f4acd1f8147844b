"""``compass map``: satellite counts and dilution of precision over the sphere and a period."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import (
    announce_compilation,
    certified_options,
    command_line,
    design_argument,
    json_option,
    print_result,
    say,
    watched,
)


@click.command("map")
@design_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="netCDF file to write.")
@click.option("--figure", "picture", type=click.Path(path_type=Path), help="PNG map to draw.")
@click.option(
    "--of",
    "drawn",
    default="gdop",
    show_default=True,
    help="What the PNG map shows: gdop, error_horizontal_m, count_min, ...",
)
@click.option("--step-deg", default=1.0, show_default=True, help="Cell size, 0.05 to 90 degrees.")
@click.option(
    "--grid",
    default="equal-angle",
    show_default=True,
    type=click.Choice(["equal-angle", "equal-area"]),
    help="Kind of cells.",
)
@click.option(
    "--epochs",
    default=109,
    show_default=True,
    help="Epochs in the period, from 1; a prime number meets moments of symmetry least.",
)
@click.option("--mask-deg", type=float, help="Elevation mask instead of the design's, degrees.")
@click.option("--fold", type=int, help="Satellites wanted instead of the design's.")
@click.option(
    "--pdop-max", default=6.0, show_default=True, help="Largest PDOP that counts as available."
)
@click.option(
    "--motion",
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="How the satellites move; else as the design says.",
)
@click.option(
    "--start-day",
    type=float,
    default=0.0,
    show_default=True,
    help="Days after the epoch at which the period begins.",
)
@click.option(
    "--duration-h",
    type=float,
    help="Period to map, hours; by default until the ground tracks repeat.",
)
@click.option(
    "--error-max-m",
    default=30.0,
    show_default=True,
    help="Largest error of a fix that counts as within, m; of designs with a [signal].",
)
@click.option(
    "--weights",
    default="variance",
    show_default=True,
    type=click.Choice(["variance", "equal"]),
    help="How a fix weighs its ranges.",
)
@certified_options
@click.option("--time-series", is_flag=True, help="Also write every epoch's counts and DOPs.")
@json_option
def command(
    design: Path,
    output: Path | None,
    picture: Path | None,
    drawn: str,
    time_series: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Count and DOP maps of a DESIGN over the sphere and one repeat period.

    A dilution of precision is infinite with fewer than four satellites in view; infinities
    count in every percentile (JSON: null) and against availability.
    """
    announce_compilation()
    import compass
    from compass.errors import ArgumentError
    from compass.saving import check_writable

    read = compass.read_design(design)
    if time_series and output is None:
        raise ArgumentError("--time-series: needs a file to write to; add -o FILE.nc")
    for path in (output, picture):
        if path is not None:
            check_writable(path, [design])
    if options["leaves"] is not None:
        check_writable(options["leaves"], [design])
    if output and picture and output == picture:
        raise ArgumentError(f"--figure = {picture}: is the netCDF file too; give another name")
    made = compass.map(read, **options, command=command_line(), progress=watched())
    if output:
        made.write(output, time_series=time_series, progress=watched())
    if picture:
        made.save_plot(picture, drawn)
    print_result(made, as_json)
    for path in (output, picture):
        if path:
            say(f"wrote {path}")

"""``compass map``: satellite counts and dilution of precision over the sphere and a period."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import (
    area_options,
    certified_options,
    choice,
    cluster_options,
    design_argument,
    fold_option,
    mask_option,
    motion_option,
    path,
    real,
    start_day_option,
    whole,
)
from compass.cli.shared import (
    check_drawn,
    check_outputs,
    command_line,
    put,
    silence_the_cluster,
    watched,
)
from compass.errors import ArgumentError


@click.command()
@design_argument
@area_options
@path("-o", "--output", help="netCDF file to write.")
@path("--figure", "picture", help="PNG map to draw.")
@click.option(
    "--of",
    "name",
    default="gdop",
    show_default=True,
    help="What the PNG map shows: gdop, error_horizontal_m, count_min, ...",
)
@real("--step-deg", default=1.0, help="Cell size.")
@choice("--grid", among=["equal-angle", "equal-area"], default="equal-angle", help="Kind of cells.")
@whole(
    "--epochs",
    default=109,
    help="Epochs in the period; a prime number meets moments of symmetry least.",
)
@mask_option
@fold_option
@real("--pdop-max", default=6.0, help="Largest PDOP that counts as available.")
@motion_option
@start_day_option
@real("--duration-h", help="Period to map, hours; by default until the ground tracks repeat.")
@real(
    "--error-max-m",
    default=30.0,
    help="Largest error of a fix that counts as within, m; of designs with a [signal].",
)
@choice(
    "--weights",
    among=["variance", "equal"],
    default="variance",
    help="How a fix weighs its ranges.",
)
@click.option(
    "--each-loss",
    is_flag=True,
    help="Also protection after the loss of any one satellite; needs [signal] and [integrity].",
)
@certified_options
@whole("--workers", help="Threads of this machine; by default one a core.")
@cluster_options
@click.option("--time-series", is_flag=True, help="Also write every epoch's counts and DOPs.")
def command(
    design: Path,
    output: Path | None,
    picture: Path | None,
    name: str,
    time_series: bool,
    **options: Any,
) -> object:
    """Count and DOP maps of a DESIGN over the sphere and one repeat period.

    A dilution of precision is infinite with fewer than four satellites in view; infinities
    count in every percentile (JSON: null) and against availability.
    """
    read = compass.read_design(design)
    if time_series and output is None:
        raise ArgumentError("--time-series: needs a file to write to; add -o FILE.nc")
    check_drawn(picture, "name")
    check_outputs(output, picture, options["leaves"], inputs=[design])
    if options["scheduler"] is not None:
        silence_the_cluster()
    made = compass.map(read, **options, command=command_line(), progress=watched())
    put(lambda file: made.write(file, time_series=time_series, progress=watched()), output)
    put(lambda file: made.save_plot(file, name), picture)
    return made

"""``compass map``: satellite counts and dilution of precision over the sphere and a period."""

from pathlib import Path
from typing import Literal

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    design_argument,
    emit_json,
    json_option,
    say,
)


@click.command("map")
@design_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="netCDF file to write.")
@click.option("--figure", "picture", type=click.Path(path_type=Path), help="PNG map of the GDOP.")
@click.option("--step-deg", default=1.0, show_default=True, help="Cell size, 0.05 to 90 degrees.")
@click.option(
    "--grid",
    "kind",
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
    default="two-body",
    show_default=True,
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="Model of the motion.",
)
@click.option(
    "--duration-h",
    type=float,
    help="Period to map, hours; by default until the ground tracks repeat.",
)
@click.option("--time-series", is_flag=True, help="Also write every epoch's counts and DOPs.")
@json_option
def command(
    design: Path,
    output: Path | None,
    picture: Path | None,
    step_deg: float,
    kind: str,
    epochs: int,
    mask_deg: float | None,
    fold: int | None,
    pdop_max: float,
    motion: Literal["two-body", "j2", "numerical"],
    duration_h: float | None,
    time_series: bool,
    as_json: bool,
) -> None:
    """Count and DOP maps of a DESIGN over the sphere and one repeat period.

    A dilution of precision is infinite with fewer than four satellites in view; infinities
    count in every percentile (JSON: null) and against availability.
    """
    announce_compilation()
    from tqdm import tqdm

    from compass.cli.shared import print_table
    from compass.coverage.files import write_map
    from compass.errors import ArgumentError
    from compass.inputs import read_design
    from compass.pages.statistics import statistics, statistics_tables
    from compass.saving import check_writable, replacing
    from compass.study.mapping import MapOptions, make_map

    chosen = read_design(design)
    if time_series and output is None:
        raise ArgumentError("--time-series: needs a file to write to; add -o FILE.nc")
    for path in (output, picture):
        if path is not None:
            check_writable(path, [design])
    if output and picture and output == picture:
        raise ArgumentError(f"--figure = {picture}: is the netCDF file too; give another name")
    options = MapOptions(
        step_deg=step_deg,
        grid=kind,
        epochs=epochs,
        mask_deg=mask_deg,
        fold=fold,
        pdop_max=pdop_max,
        motion=motion,
        duration_h=duration_h,
    )
    with tqdm(desc="map", unit="row", disable=None, leave=False) as bar:
        made = make_map(chosen, options, command_line(), progress=bar.update)
    if output:
        with tqdm(desc="series", unit="row", disable=None, leave=False) as bar:
            series = (made.view, made.grid) if time_series else None
            write_map(made.dataset, output, chosen.figure, series=series, progress=bar.update)
    if picture:
        from compass.pages.coverage import map_figure

        title = f"{chosen.name}: GDOP, 95th percentile over time"
        figure = map_figure(
            made.dataset.gdop.sel(percentile=95).values,
            made.grid,
            title,
            "GDOP",
            figure_name=chosen.figure.name,
        )
        with replacing(picture) as temporary:
            figure.savefig(temporary, format="png", dpi=150)
    if as_json:
        emit_json(statistics(made.dataset) | {"provenance": made.dataset.attrs})
        return
    for table in statistics_tables(made.dataset):
        print_table(table.title, table.rows, table.header)
    for path in (output, picture):
        if path:
            say(f"wrote {path}")

"""``compass access``: when stations, moons, the Earth and satellites see each other."""

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
)


@click.command("access")
@design_argument
@click.option(
    "--duration-sols",
    type=float,
    help="Span from the design's epoch, above 0 to 1000 sols.  [default: the design's, else 10]",
)
@click.option(
    "--station",
    "stations",
    multiple=True,
    metavar="NAME=LAT,LON[,MASK]",
    help="A station beside the design's: planetocentric latitude, east longitude, mask; degrees.",
)
@click.option(
    "--moon",
    "moons",
    multiple=True,
    type=click.Choice(["phobos", "deimos"]),
    help="Link with a moon.",
)
@click.option("--earth", is_flag=True, help="Link with the Earth.")
@click.option("--crosslinks", is_flag=True, help="Link satellites with each other.")
@click.option("--eclipse", is_flag=True, help="Find when satellites and moons are in shadow.")
@click.option(
    "--model",
    type=click.Choice(["two-body", "j2"]),
    default="two-body",
    show_default=True,
    help="How satellites move.",
)
@click.option(
    "--moon-model",
    type=click.Choice(["precessing", "circular"]),
    default="precessing",
    show_default=True,
    help="How moons move.",
)
@click.option("--pairs", is_flag=True, help="Print a line for every pair.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Write all windows to a file: .nc, .csv or .json.",
)
@json_option
def command(design: Path, output: Path | None, as_json: bool, **options: Any) -> None:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch.
    """
    announce_compilation()
    import compass
    from compass.api.access import check_suffix
    from compass.saving import check_writable

    if output:
        check_writable(check_suffix(output), [design])
    found = compass.access(design, **options)
    if output:
<<<<<<< HEAD
        _write(output, found, record, read)
    if as_json:
        emit_json(record)
        return
    click.echo(f"{read.name}: access over {record['duration_sols']:g} sols")
    _print(record, pairs)
    if output:
        click.echo(f"\nwritten: {output}")


def _check_suffix(output: Path) -> None:
    from compass.errors import OutputError

    if output.suffix not in SUFFIXES:
        raise OutputError(
            f"{output}: unknown kind {output.suffix or 'of file'!r}; "
            f"the name must end in {', '.join(SUFFIXES)}"
        )


def _station(text: str, design: "Design") -> "Site":
    """Read a site of the form NAME=LAT,LON[,MASK] in degrees."""
    import numpy as np

    from compass.errors import ArgumentError
    from compass.sites import Mask, Site

    name, equals, rest = text.partition("=")
    try:
        numbers = [float(part) for part in rest.split(",")]
    except ValueError:
        numbers = []
    if not (name.strip() and equals) or len(numbers) not in (2, 3):
        raise ArgumentError(
            f"--station {text!r}: not NAME=LAT,LON or NAME=LAT,LON,MASK; "
            "write for example --station 'Gale=-4.6,137.4,10'"
        )
    mask = numbers[2] if len(numbers) == 3 else 0.0
    limits = {"latitude": (-90, 90), "longitude": (-180, 360), "mask": (0, 89.999)}
    for (field, (low, high)), value in zip(limits.items(), (*numbers[:2], mask), strict=True):
        if not low <= value <= high:
            raise ArgumentError(
                f"--station {text!r}: {field} = {value:g}: allowed {low:g} to {high:g} degrees"
            )
    latitude, longitude, low_mask = np.radians([*numbers[:2], mask]).tolist()
    return Site(
        name.strip(), latitude, longitude, mask=Mask.constant(low_mask), figure=design.figure
    )


def _write(output: Path, found: "Survey", record: dict[str, Any], design: "Design") -> None:
    """Write all windows, in the format that the file's name asks for."""
    import json

    import compass
    from compass.contacts.dataset import windows_dataset
    from compass.conventions import epoch_text
    from compass.document.plain import plain
    from compass.saving import replacing, save_netcdf

    if output.suffix == ".nc":
        dataset = windows_dataset(
            found.windows,
            title=f"Access windows of {design.name}",
            design=design.text,
            design_sha256=design.digest,
            epoch_tdb=epoch_text(design.constellation.epoch),
            history=command_line(),
            source=f"compass {compass.__version__}",
        )
        save_netcdf(output, dataset)
        return
    with replacing(output) as path:
        if output.suffix == ".json":
            text = json.dumps(plain(record), indent=2, allow_nan=False) + "\n"
            path.write_text(text, encoding="utf-8")
        else:
            _write_csv(path, record)


def _write_csv(path: Path, record: dict[str, Any]) -> None:
    from compass.saving import write_csv

    names = ["start_s", "end_s", "duration_s", "culmination_s", "max_elevation_deg"]
    write_csv(
        path,
        ["first", "second", *names],
        (
            [pair["first"], pair["second"], *(window[name] for name in names)]
            for pair in record["pairs"]
            for window in pair["windows"]
        ),
    )


def _print(record: dict[str, Any], pairs: bool) -> None:
    """Print the record as tables."""
    from compass.pages.access_tables import access_tables

    for table in access_tables(record, pairs=pairs):
        print_table(table.title, table.rows, table.header)
    if record["latency"] is None:
        say("store and forward between stations: left out, there is too much of it")
    if record["earth"]:
        angle = record["earth"]["sun_earth_mars_angle_deg"]
        seasons = len(record["earth"]["conjunction_seasons"])
        click.echo(
            f"\nSun-Earth-Mars angle {angle['least']:.2f} to {angle['largest']:.2f} deg; "
            f"{seasons} season(s) below {record['earth']['conjunction_deg']:g} deg"
        )
=======
        found.write(output, command=command_line())
        say(f"wrote {output}")
    print_result(found, as_json)
>>>>>>> main

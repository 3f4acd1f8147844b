"""``compass access``: when stations, moons, the Earth and satellites see each other."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compass.cli.shared import (
    command_line,
    design_argument,
    emit_json,
    json_option,
    print_table,
    say,
)

if TYPE_CHECKING:
    from compass.access.survey import Survey
    from compass.inputs.design import Design
    from compass.sites import Site

SUFFIXES = (".nc", ".csv", ".json")


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
def command(
    design: Path,
    duration_sols: float | None,
    stations: tuple[str, ...],
    moons: tuple[str, ...],
    earth: bool,
    crosslinks: bool,
    eclipse: bool,
    model: Any,
    moon_model: Any,
    pairs: bool,
    output: Path | None,
    as_json: bool,
) -> None:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch.
    """
    from compass.access.record import survey_record
    from compass.access.survey import Wanted, survey
    from compass.bodies import SOLAR_DAY
    from compass.inputs import read_design
    from compass.saving import check_writable

    if output:
        _check_suffix(output)
        check_writable(output, [design])
    read = read_design(design)
    wanted = Wanted(
        tuple(dict.fromkeys((*read.access.moons, *moons))),
        read.access.earth or earth,
        read.access.crosslinks or crosslinks,
        read.access.atmosphere_height,
    )
    sites = (*read.stations, *(_station(text, read) for text in stations))
    duration = read.access_duration
    if duration_sols is not None:
        duration = duration_sols * SOLAR_DAY.value
    found = survey(
        read.constellation,
        sites,
        duration,
        wanted,
        figure=read.figure,
        model=model,
        moon_model=moon_model,
    )
    record = survey_record(
        found,
        read.constellation.epoch,
        radios=read.radios,
        threshold=read.conjunction,
        figure=read.figure,
        eclipse=eclipse,
    )
    record = {"design": read.name, "epoch_tdb_s_past_j2000": read.constellation.epoch, **record}
    if output:
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
    from compass.access.dataset import windows_dataset
    from compass.cli.shared import plain
    from compass.saving import replacing

    with replacing(output) as path:
        if output.suffix == ".nc":
            dataset = windows_dataset(
                found.windows,
                title=f"Access windows of {design.name}",
                design=design.text,
                design_sha256=design.digest,
                epoch_tdb_s_past_j2000=design.constellation.epoch,
                history=command_line(),
                source=f"compass {compass.__version__}",
            )
            dataset.to_netcdf(path, engine="h5netcdf")
        elif output.suffix == ".json":
            path.write_text(json.dumps(plain(record), indent=2, allow_nan=False) + "\n")
        else:
            _write_csv(path, record)


def _write_csv(path: Path, record: dict[str, Any]) -> None:
    import csv

    names = ["start_s", "end_s", "duration_s", "culmination_s", "max_elevation_deg"]
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["first", "second", *names])
        for pair in record["pairs"]:
            for window in pair["windows"]:
                writer.writerow([pair["first"], pair["second"], *(window[name] for name in names)])


def _print(record: dict[str, Any], pairs: bool) -> None:
    """Print the record as tables."""
    if record["nodes"]:
        header = [
            "node", "satellites seen", "share of time each", "least", "passes/sol each",
            "mean pass h", "longest gap h", "any: share", "any: longest gap h",
        ]  # fmt: skip
        rows = [
            [
                r["node"],
                f"{r['seen']} of {r['satellites']}",
                _percent(r["mean_share"]),
                _percent(r["least_share"]),
                f"{r['passes_per_sol']:.3f}",
                "-" if r["mean_pass_h"] is None else f"{r['mean_pass_h']:.3f}",
                f"{r['longest_gap_h']:.3f}",
                _percent(r["any_share"]),
                f"{r['any_longest_gap_h']:.3f}",
            ]
            for r in record["nodes"]
        ]
        print_table("Satellites in sight", rows, header)
    if record["earth"]:
        _print_earth(record["earth"])
    if record["latency"] is None:
        say("store and forward between stations: left out, there are too many stations")
    if record["latency"]:
        rows = [
            [
                f"{r['source']} -> {r['target']}",
                _percent(r["at_once"]),
                "-" if r["mean_h"] != r["mean_h"] else f"{r['mean_h']:.3f}",
                "-" if r["longest_h"] != r["longest_h"] else f"{r['longest_h']:.3f}",
                _percent(r["undelivered"]),
            ]
            for r in record["latency"]
        ]
        header = ["way", "at once", "mean wait h", "longest wait h", "not within the span"]
        print_table("Store and forward between stations", rows, header)
    if record["eclipses"]:
        rows = [
            [r["node"], r["count"], _percent(r["share"]), f"{r['longest_h']:.3f}",
             r["umbra_count"], f"{r['umbra_longest_h']:.3f}"]
            for r in record["eclipses"]
        ]  # fmt: skip
        header = ["node", "eclipses", "share", "longest h", "umbra", "longest umbra h"]
        print_table("In Mars's shadow", rows, header)
    if record["radio"]:
        rows = [
            [f"{r['first']} - {r['second']}", f"{r['least_range_km']:.0f}",
             f"{r['largest_range_km']:.0f}", f"{r['largest_range_rate_km_s']:.3f}",
             f"{r['largest_light_time_s']:.3f}", f"{r['least_cn0_dbhz']:.1f}",
             f"{r['required_cn0_dbhz']:.1f}", _percent(r["usable_share"])]
            for r in record["radio"]
        ]  # fmt: skip
        header = ["link", "least km", "largest km", "km/s", "light time s", "least C/N0 dBHz",
                  "required", "usable"]  # fmt: skip
        print_table("Radio links along their windows", rows, header)
    if pairs:
        rows = [
            [f"{r['first']} - {r['second']}", r["count"], f"{r['passes_per_sol']:.3f}",
             f"{r['mean_duration_h']:.3f}", _percent(r["share"]), f"{r['longest_gap_h']:.3f}",
             _range(r)]
            for r in record["pairs"]
        ]  # fmt: skip
        header = ["pair", "windows", "per sol", "mean h", "share", "longest gap h", "range km"]
        print_table("Pairs", rows, header)


def _print_earth(earth: dict[str, Any]) -> None:
    rows = [
        [
            r["station"],
            _percent(r["direct_share"]),
            _percent(r["share"]),
            ", ".join(f"{h}: {_percent(s)}" for h, s in r["by_hops"].items()) or "-",
            _percent(r["share_outside_conjunction"]),
        ]
        for r in earth["stations"]
    ]
    header = [
        "station",
        "direct",
        "through the network",
        "by links in the chain",
        "out of conjunction",
    ]
    print_table("Reaching the Earth", rows, header)
    angle = earth["sun_earth_mars_angle_deg"]
    click.echo(
        f"Sun-Earth-Mars angle {angle['least']:.2f} to {angle['largest']:.2f} deg; "
        f"{len(earth['conjunction_seasons'])} season(s) below {earth['conjunction_deg']:g} deg"
    )


def _range(pair: dict[str, Any]) -> str:
    if not pair["count"]:
        return "-"
    return f"{pair['least_range_km']:.0f} to {pair['largest_range_km']:.0f}"


def _percent(share: float) -> str:
    return f"{100 * share:.2f} %"

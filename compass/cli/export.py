"""``compass export``: a design for other programs, as OEM, CZML, GeoJSON or a design file."""

from pathlib import Path
from typing import Literal

import click

from compass.cli.shared import design_argument, emit_json, json_option, say


@click.command("export")
@design_argument
@click.option(
    "--format",
    "kind",
    type=click.Choice(["oem", "czml", "geojson", "toml"]),
    required=True,
    help="CCSDS OEM 2.0, CZML, GeoJSON on the Mars sphere, or a design file.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    required=True,
    help="File to write; for OEM, which takes one satellite a message, a new folder of files.",
)
@click.option(
    "--duration-h",
    type=float,
    help="Time span, hours; by default until the ground tracks repeat.",
)
@click.option(
    "--step-s",
    type=float,
    help="Seconds between states; by default close enough for interpolation to a millimetre.",
)
@click.option(
    "--motion",
    type=click.Choice(["two-body", "j2", "numerical"]),
    help="How they move; else as the design says.",
)
@json_option
def command(
    design: Path,
    kind: str,
    output: Path,
    duration_h: float | None,
    step_s: float | None,
    motion: Literal["two-body", "j2", "numerical"] | None,
    as_json: bool,
) -> None:
    """Write a DESIGN down for other programs.

    OEM: states in ICRF about Mars, TDB, one message a satellite. CZML: satellites, paths and
    stations on the Mars ellipsoid. GeoJSON: sub-satellite points, footprints and gaps at the
    epoch, and ground tracks. TOML: the design file itself, every pattern and unit made plain.
    """
    from compass.errors import ArgumentError
    from compass.handover.czml import czml
    from compass.handover.geojson import geojson
    from compass.handover.instants import iso, sample_times, tdb
    from compass.handover.oem import oem
    from compass.handover.toml import design_toml
    from compass.inputs import read_design
    from compass.saving import check_new_folder, check_writable, making_folder, replacing

    chosen = read_design(design)
    if kind == "oem":
        check_new_folder(output)
    else:
        check_writable(output, [design])
    model = chosen.motion.or_of(motion)
    files: dict[str, str] = {}
    result = {
        "design": chosen.name,
        "format": kind,
        "output": str(output),
        "satellites": chosen.constellation.size,
    }
    if kind == "toml":
        given = {"--duration-h": duration_h, "--step-s": step_s, "--motion": motion}
        for option, value in given.items():
            if value is not None:
                raise ArgumentError(
                    f"{option} = {value}: a design file holds orbits, not states; leave it out, "
                    "or choose the format oem, czml or geojson"
                )
        text = design_toml(chosen)
    else:
        times = sample_times(chosen.constellation, duration_h, step_s)
        start, stop = iso(tdb(chosen.constellation.epoch, times[[0, -1]]))
        result |= {
            "motion": model.model,
            "start_tdb": start,
            "stop_tdb": stop,
            "step_s": float(times[1] - times[0]),
            "epochs": times.size,
        }
        if kind == "oem":
            files = oem(chosen, times, model)
        else:
            text = {"czml": czml, "geojson": geojson}[kind](chosen, times, model)
    if files:
        with making_folder(output) as folder:
            for name, message in files.items():
                (folder / name).write_text(message, encoding="ascii")
    else:
        with replacing(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
    if as_json:
        emit_json(result | {"files": len(files) or 1})
        return
    say(f"wrote {output}" + (f": {len(files)} messages" if files else ""))

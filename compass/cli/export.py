"""``compass export``: a design for other programs, as OEM, CZML, GeoJSON or a design file."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import check_outputs, say, wants_json


@takes("design format output duration_h step_s motion start_day")
def command(design: Path, output: Path, **options: Any) -> object:
    """Write a DESIGN down for other programs.

    OEM: states in ICRF about Mars, TDB, one message a satellite. CZML: satellites, paths and
    stations on the Mars ellipsoid. GeoJSON: ground tracks, and sub-satellite points, footprints
    and gaps at the first moment. TOML: the design file itself, every pattern and unit made plain.
    """
    from compass.saving import check_new_folder

    read = compass.read_design(design)
    if options["format"] == "oem":
        check_new_folder(output)
    else:
        check_outputs(output, inputs=[design])
    made = compass.export(read, output=output, **options)
    if wants_json():
        return made
    for said in made.not_kept:
        say(f"not kept: {said}")
    say(f"wrote {output}" + (f": {len(made.files)} messages" if made.format == "oem" else ""))
    return None

"""``compass map``: satellite counts and dilution of precision over the sphere and a period."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import AREAS, BOUNDS, CLUSTER, takes
from compass.cli.shared import command_line, put, silence_the_cluster, watched


@takes(
    f"design {AREAS} output picture name step_deg grid epochs altitude_km mask_deg beam_deg fold "
    f"pdop_max motion start_day duration_h error_max_m weights each_loss {BOUNDS} workers "
    f"{CLUSTER} time_series"
)
def command(
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
    if options["scheduler"] is not None:
        silence_the_cluster()
    made = compass.map(**options, command=command_line(), progress=watched())
    put(lambda file: made.write(file, time_series=time_series, progress=watched()), output)
    put(lambda file: made.save_plot(file, name), picture)
    return made

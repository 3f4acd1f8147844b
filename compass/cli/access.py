"""``compass access``: when stations, moons, the Earth and satellites see each other."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import command_line, put


@takes(
    "design duration_sols stations moons earth crosslinks eclipse motion start_day moon_model "
    "pairs output"
)
def command(output: Path | None, **options: Any) -> object:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch, or after its --start-day.
    """
    result = compass.access(**options)
    put(lambda file: result.write(file, command=command_line()), output)
    return result

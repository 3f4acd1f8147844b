"""``compass search``: the smallest pattern with continuous k-fold coverage."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.parameters import choice
from compass.cli.shared import command_line, put, watched
from compass.orbits.kinds import KIND_NAMES


@takes(
    "require fold region pdop_at_most gdop_at_most share share_of least_approach_deg mask_deg "
    "radius_km altitude_km orbit repeat max_satellites beyond pattern figure finalists days "
    "budget_s output",
    pattern=choice(KIND_NAMES, "Kind of pattern.", KIND_NAMES[0]),
)
def command(output: Path | None, **options: Any) -> object:
    """Find the smallest pattern that meets requirements, or covers the whole sphere k-fold.

    Requirements are those of a file (--require), or --fold, --region and limits on geometry; size
    after size is tried. Ends with the sentence that says what to build. Exit status 1 if there is
    none.
    """
    found = compass.search(**options, progress=watched())
    put(lambda file: found.write(file, command=command_line()), output)
    return found

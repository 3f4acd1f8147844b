"""``compass drift``: a design left alone on real orbits; how long its coverage lasts."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import command_line, put, watched


@takes(
    "design days start_day step_days fold mask_deg region trimmed radius_km avoid_km output "
    "elements oem"
)
def command(output: Path | None, elements: Path | None, oem: Path | None, **options: Any) -> object:
    """Follow a DESIGN that is left alone: margin and room over time, the first loss, proven.

    Exit status 0 if what the design requires (without requirements the fold) is proven for all the
    days, 1 if it is lost, undecided or cannot be followed.
    """
    if elements is not None or oem is not None:
        from compass.api.drift_files import check_trimmed

        check_trimmed(options["trimmed"])
    found = compass.drift(**options, progress=watched())
    put(found.write_elements, elements)
    put(found.write_orbits, oem)
    put(lambda file: found.write(file, command=command_line()), output)
    return found

"""``compass land``: how well a lander navigates on radio beacons."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import command_line, put, put_pictures, say, watched


@takes("scenario output figures runs start_day strict")
def command(output: Path | None, figures: Path | None, **options: Any) -> object:
    """Fly a SCENARIO and navigate it: trajectory, view, observability, bound and filter.

    A scenario with a table [fusion] is also flown with accelerometers and ranges in centralised
    and distributed filters, through plasma and faults if it has them.
    """
    result = compass.land(**options, command=command_line(), progress=watched(), notice=say)
    put(result.write, output)
    put_pictures(result.pictures, figures)
    return result

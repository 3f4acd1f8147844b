"""``compass horizon``: horizons of stations from a grid of heights."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import put, watched


@takes("design terrain variable latitude_kind above_m azimuths output")
def command(output: Path | None, **options: Any) -> object:
    """Draw the horizon of every station from terrain, and write it into a design file."""
    found = compass.horizon(progress=watched(), **options)
    put(found.write, output)
    return found

"""``compass optimize``: the best beacons or orbits for a lander."""

from pathlib import Path

import compass
from compass.cli.options import takes
from compass.cli.shared import command_line, put_pictures, watched


@takes("scenario figures")
def command(scenario: Path, figures: Path | None) -> object:
    """Search for the best beacons or orbits, as the SCENARIO's [optimize] table asks."""
    result = compass.optimize(scenario, command=command_line(), progress=watched())
    put_pictures(result.pictures, figures)
    return result

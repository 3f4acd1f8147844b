"""``compass determine``: who tracks the satellites, and how well they are known for it."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import put, watched


@takes("design days update_h motion output picture drawn")
def command(output: Path | None, picture: Path | None, drawn: str, **options: Any) -> object:
    """Covariance of the orbits and clocks of a DESIGN, tracked as its [tracking] says.

    Radial, along, cross and clock sigma of every satellite against time, what each kind of
    tracking buys, and the [signal] for the users that follows.
    """
    result = compass.determine(**options, progress=watched())
    put(result.write, output)
    put(lambda file: result.save_plot(file, drawn), picture)
    return result

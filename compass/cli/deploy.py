"""``compass deploy``: how satellites of one launch come to their planes."""

from typing import Any

import compass
from compass.cli.options import takes


@takes("design launch_altitude_km longest_wait_days satellites_a_launch")
def command(**options: Any) -> object:
    """Weigh waiting for planes, whose nodes Mars's flattening turns apart, against delta-v.

    Exit status 0 if waiting reaches every plane of the DESIGN in time, 1 if not.
    """
    return compass.deploy(**options)

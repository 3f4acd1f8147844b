"""``compass locate``: the place of a user who stands still, with however few satellites."""

from typing import Any

import compass
from compass.cli.options import takes


@takes("design site satellites hours step_s start_day goal_m height_m doppler_m_s clock")
def command(**options: Any) -> object:
    """Find how well a user who stands still knows his place from ranges and Doppler over time.

    With one to three satellites of a DESIGN in view there is no fix at a moment, but hours of
    standing make one. Exit status 0 if the goal is met with a held clock and a known height.
    """
    return compass.locate(**options)

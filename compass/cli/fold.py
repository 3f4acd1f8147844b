"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import watched


@takes("design fold mask_deg losses region duration_h days start_day motion")
def command(**options: Any) -> object:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    return compass.fold(progress=watched(), **options)

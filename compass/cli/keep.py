"""``compass keep``: station-keeping of a design, simulated."""

from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import watched


@takes(
    "design years box_deg fold mask_deg specific_impulse_s dry_mass_kg smallest_burn_m_s "
    "execution_error navigation_error_m seed radius_km"
)
def command(**options: Any) -> object:
    """Simulate impulsive station-keeping of every satellite of a DESIGN in its slot.

    Exit status 0 if all stay within the margin, 1 if not.
    """
    return compass.keep(progress=watched(), **options)

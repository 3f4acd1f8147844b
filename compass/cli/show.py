"""``compass show``: the analytic geometry of a design."""

from pathlib import Path

import compass
from compass.cli.options import takes


@takes("design")
def command(design: Path) -> object:
    """Analytic geometry of a DESIGN: caps, gaps, totals; published against exact."""
    return compass.show(design)

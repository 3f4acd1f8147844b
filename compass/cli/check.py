"""``compass check``: every requirement of a design, met or missed."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import BOUNDS, takes
from compass.cli.shared import watched


@takes(f"designs days start_day motion {BOUNDS}")
def command(designs: tuple[Path, ...], **options: Any) -> object:
    """Settle every [[requirement]] of DESIGNS: met or missed, proven or with a bracket.

    Several DESIGNS are one network: their satellites together, asked for the requirements of all.

    Exit status 0 all met, 1 one missed or undecided, 2 bad input.
    """
    return compass.check(*designs, progress=watched(), **options)

"""``compass series``: what stations see over time."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import takes
from compass.cli.shared import command_line, put


@takes(
    "designs stations beacons routes orbiters beam_deg fold mask_deg days start_day epochs "
    "motion output picture drawn"
)
def command(
    designs: tuple[Path, ...],
    output: Path | None,
    picture: Path | None,
    drawn: str,
    **options: Any,
) -> object:
    """Follow what users see over time: satellites in view, dilutions, gaps, errors in metres.

    Several DESIGNS are one network. Gaps are found by rise and set, dilutions at moments.

    Exit status 0 no gap, 1 a station has one, 2 bad input.
    """
    result = compass.series(*designs, **options)
    put(lambda file: result.write(file, command=command_line()), output)
    put(lambda file: result.save_plot(file, drawn), picture)
    return result

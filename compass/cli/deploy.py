"""``compass deploy``: how satellites of one launch come to their planes."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import design_argument, json_option, real, whole
from compass.cli.shared import print_result


@click.command()
@design_argument
@real("--launch-altitude-km", help="Orbit launched into; else the design's.")
@real("--longest-wait-days", help="For the last plane; else the design's.")
@whole("--satellites-a-launch", help="At most; else the design's, or all.")
@json_option
def command(design: Path, as_json: bool, **options: Any) -> None:
    """Weigh waiting for planes, whose nodes Mars's flattening turns apart, against delta-v.

    Exit status 0 if waiting reaches every plane of the DESIGN in time, 1 if not.
    """
    import compass

    print_result(compass.deploy(design, **options), as_json)

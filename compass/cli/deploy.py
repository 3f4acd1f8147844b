"""``compass deploy``: how satellites of one launch come to their planes."""

from typing import Any

import click

import compass
from compass.cli.options import design_argument, real, whole


@click.command()
@design_argument
@real("--launch-altitude-km", help="Orbit launched into; else the design's.")
@real("--longest-wait-days", help="For the last plane; else the design's.")
@whole("--satellites-a-launch", help="At most; else the design's, or all.")
def command(**options: Any) -> object:
    """Weigh waiting for planes, whose nodes Mars's flattening turns apart, against delta-v.

    Exit status 0 if waiting reaches every plane of the DESIGN in time, 1 if not.
    """
    return compass.deploy(**options)

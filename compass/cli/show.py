"""``compass show``: the analytic geometry of a design."""

from pathlib import Path

import click

import compass
from compass.cli.options import design_argument


@click.command()
@design_argument
def command(design: Path) -> object:
    """Analytic geometry of a DESIGN: caps, gaps, totals; published against exact."""
    return compass.show(design)

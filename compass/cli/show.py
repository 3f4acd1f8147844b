"""``compass show``: the analytic geometry of a design."""

from pathlib import Path

import click

from compass.cli.options import design_argument, json_option
from compass.cli.shared import print_result


@click.command("show")
@design_argument
@json_option
def command(design: Path, as_json: bool) -> None:
    """Analytic geometry of a DESIGN: caps, gaps, totals; published against exact."""
    import compass

    print_result(compass.show(design), as_json)

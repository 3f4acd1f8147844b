"""``compass warm``: compile kernels now, so that later runs do not wait for it."""

import click

from compass.cli.options import json_option
from compass.cli.shared import print_result, watched


@click.command()
@click.option(
    "--workers", type=click.IntRange(1, 256), help="Commands run at a time; else one a core."
)
@json_option
def command(workers: int | None, as_json: bool) -> None:
    """Compile the commands' kernels now, by small jobs of them.

    For images of containers, for clusters, and before a lecture. Rarer options compile theirs when
    they are first asked for.
    """
    import compass

    print_result(compass.warm(workers=workers, progress=watched()), as_json)

"""``compass warm``: compile kernels now, so that later runs do not wait for it."""

import click

import compass
from compass.cli.options import whole
from compass.cli.shared import watched


@click.command()
@whole("--workers", help="Commands run at a time; else one a core.")
def command(workers: int | None) -> object:
    """Compile the commands' kernels now, by small jobs of them.

    For images of containers, for clusters, and before a lecture. Rarer options compile theirs when
    they are first asked for.
    """
    return compass.warm(workers=workers, progress=watched())

"""``compass warm``: compile every kernel now, so that no later run waits for it."""

import click

from compass.cli.shared import json_option, print_result, watched


@click.command()
@click.option(
    "--workers", type=click.IntRange(1, 256), help="Commands run at a time; else one a core."
)
@json_option
def command(workers: int | None, as_json: bool) -> None:
    """Compile every kernel once, by small jobs of every command.

    For images of containers, for clusters, and before a lecture.
    """
    import compass

    print_result(compass.warm(workers=workers, progress=watched()), as_json)

"""``compass version``: which version this is, and on what it runs."""

import click

from compass.cli.options import json_option
from compass.cli.shared import print_result


@click.command()
@json_option
def command(as_json: bool) -> None:
    """Print the versions of compass and of what it runs on."""
    import compass

    print_result(compass.version(), as_json)

"""``compass schema``: what a file may say, for editors."""

import click

from compass.cli.new import KINDS
from compass.cli.options import json_option
from compass.cli.shared import emit_json


@click.command()
@click.argument("kind", type=KINDS)
@json_option
def command(kind: str, as_json: bool) -> None:
    """Print the JSON Schema of a design, scenario or study file.

    Editors complete and check a TOML file by it: write it to a file, and name that in the first
    line, `#:schema design.json`.
    """
    import compass

    emit_json(compass.schema(kind).to_dict())

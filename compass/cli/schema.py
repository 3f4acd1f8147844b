"""``compass schema``: what a file may say, for editors."""

import compass
from compass.cli.options import takes
from compass.cli.shared import emit_json


@takes("kind")
def command(kind: str) -> None:
    """Print the JSON Schema of a design, scenario or study file.

    Editors complete and check a TOML file by it: write it to a file, and name that in the first
    line, `#:schema design.json`.
    """
    emit_json(compass.schema(kind).to_dict())

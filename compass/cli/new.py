"""``compass new``: a commented file that runs as it is."""

from pathlib import Path

import compass
from compass.cli.options import takes
from compass.cli.shared import say, wants_json


@takes("kind like output")
def command(kind: str, like: str | None, output: Path | None) -> object:
    """Write a commented file to start from: every key, its unit, range and default.

    It runs as it is. Files that it names are written beside it.
    """
    made = compass.new(kind, like=like)
    if output is None:
        for file in made.companions:
            say(f"it names {file.name}; with -o FILE that is written beside it")
        return made
    for file in made.write(output):
        say(f"wrote {file}")
    return made if wants_json() else None

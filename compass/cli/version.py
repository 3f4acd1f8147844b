"""``compass version``: which version this is, and on what it runs."""

import compass
from compass.cli.options import takes


@takes()
def command() -> object:
    """Print the versions of compass and of what it runs on."""
    return compass.version()

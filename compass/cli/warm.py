"""``compass warm``: compile kernels now, so that later runs do not wait for it."""

import compass
from compass.cli.options import takes
from compass.cli.shared import watched


@takes("workers")
def command(workers: int | None) -> object:
    """Compile the commands' kernels now, by small jobs of them.

    For images of containers, for clusters, and before a lecture. Rarer options compile theirs when
    they are first asked for.
    """
    return compass.warm(workers=workers, progress=watched())

"""``compass trade``: a study over many candidates, resumable, on a cluster if asked."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import CLUSTER, takes
from compass.cli.shared import say, silence_the_cluster, wants_json, watched


@takes(f"study output budget_s workers {CLUSTER}")
def command(study: Path, **options: Any) -> object:
    """Judge every candidate of a STUDY: an exact screen first, then maps, then entries.

    Every finished batch is stored at once; the same command resumes a run that was killed.
    Exit status 1 if no candidate meets every constraint and has a value for every objective, or
    workers died of some.
    """
    if options["scheduler"] is not None:
        silence_the_cluster()
    result = compass.trade(study, **options, progress=watched(), notice=say)
    for words in result.notes() if wants_json() else ():
        say(words)
    return result

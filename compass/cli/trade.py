"""``compass trade``: a study over many candidates, resumable, on a cluster if asked."""

from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.options import cluster_options, path, whole
from compass.cli.shared import say, silence_the_cluster, wants_json, watched


@click.command()
@click.argument("study", type=click.Path(path_type=Path))
@path("-o", "--output", help="Folder of the store; by default trades/NAME-OF-THE-FILE.")
@whole("--workers", help="Processes on this machine; by default one a core.")
@cluster_options
def command(study: Path, **options: Any) -> object:
    """Judge every candidate of a STUDY: an exact screen first, then maps, then entries.

    Every finished batch is stored at once; the same command resumes a run that was killed.
    Exit status 1 if no candidate meets every constraint and has a value for every objective, or
    workers died of some.
    """
    if options["scheduler"] is not None:
        silence_the_cluster()
    found = compass.trade(study, **options, progress=watched(), notice=say)
    for words in found.notes() if wants_json() else ():
        say(words)
    return found

"""``compass trade``: a study over many candidates, resumable, on a cluster if asked."""

from pathlib import Path
from typing import Any

import click

from compass.cli.options import cluster_options, json_option, path, whole
from compass.cli.shared import (
    announce_compilation,
    print_result,
    say,
    silence_the_cluster,
    watched,
)

_FILE = click.Path(path_type=Path)


@click.command()
@click.argument("study", type=_FILE)
@path("-o", "--output", help="Folder of the store; by default trades/NAME-OF-THE-FILE.")
@whole("--workers", help="Processes on this machine; by default one a core.")
@cluster_options
@json_option
def command(study: Path, as_json: bool, **options: Any) -> None:
    """Judge every candidate of a STUDY: an exact screen first, then maps, then entries.

    Every finished batch is stored at once; the same command resumes a run that was killed.
    Exit status 1 if no candidate meets every constraint and has a value for every objective, or
    workers died of some.
    """
    announce_compilation()
    import compass

    if options["scheduler"] is not None:
        silence_the_cluster()
    found = compass.trade(study, **options, progress=watched(), notice=say)
    if as_json:
        for words in found.notes():
            say(words)
    print_result(found, as_json)

"""``compass trade``: a study over many candidates, resumable, on a cluster if asked."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import announce_compilation, json_option, print_result, say, watched

_FILE = click.Path(path_type=Path)


@click.command()
@click.argument("study", type=_FILE)
@click.option(
    "-o",
    "--output",
    type=_FILE,
    help="Folder of the store; by default trades/NAME-OF-THE-FILE.",
)
@click.option("--workers", type=int, help="Processes on this machine; by default one a core.")
@click.option("--scheduler", help="Address of a Dask scheduler, such as tcp://host:8786.")
@click.option("--tls-ca", type=_FILE, help="Certificate of the cluster's authority (PEM).")
@click.option("--tls-cert", type=_FILE, help="Own certificate (PEM).")
@click.option("--tls-key", type=_FILE, help="Own key (PEM).")
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
        _silence_the_cluster()
    found = compass.trade(study, **options, progress=watched(), notice=say)
    if as_json:
        for words in found.notes():
            say(words)
    print_result(found, as_json)


def _silence_the_cluster() -> None:
    """Keep the cluster's own messages from stderr: what matters is said here."""
    import logging
    from contextlib import suppress

    with suppress(ImportError):  # as the cluster says
        import distributed  # noqa: F401  # which sets its loggers' levels itself
    for name in ("distributed", "distributed.client", "tornado.application"):
        logging.getLogger(name).setLevel(logging.CRITICAL)

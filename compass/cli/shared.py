"""What commands share: how results are printed, files written, and messages said."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compass.cli.clock import line_of_its_own
from compass.saving import readable

if TYPE_CHECKING:
    from compass.api.results import Result
    from compass.document import Picture

#: Exit status of a result whose claim does not hold.
CLAIM_FAILS = 1

#: Where a command's context keeps whether it is to print JSON, and whether it is to be quiet.
JSON, QUIET = "compass.json", "compass.quiet"


def emit_json(result: dict[str, Any]) -> None:
    """Print one strict JSON object: numpy values become plain, nan and inf become null."""
    from compass.document.plain import plain

    click.echo(json.dumps(plain(result), indent=2, allow_nan=False, ensure_ascii=False))


def print_result(result: "Result") -> None:
    """Print a result as text or JSON; exit status 1 where its claim does not hold."""
    if wants_json():
        emit_json(result.to_dict())
    else:
        click.echo(str(result))
    if not result.holds:
        raise click.exceptions.Exit(CLAIM_FAILS)


def wants_json() -> bool:
    """Whether JSON is to be printed."""
    return bool(click.get_current_context().meta.get(JSON))


def watched() -> bool:
    """Whether progress is wanted: not where the user asked for quiet."""
    context = click.get_current_context(silent=True)
    return not (context and context.meta.get(QUIET))


def say(message: str) -> None:
    """Tell the user something that is not a result (stderr), unless they asked for quiet."""
    if watched():
        with line_of_its_own():
            click.echo(message, err=True)


def put(write: Callable[[Path], object], output: Path | None) -> None:
    """Write a file or folder that is wanted, and say so; one that is None is not."""
    if output is not None:
        write(output)
        say(f"wrote {readable(output)}")


def say_boxes() -> None:
    """Say once which letters no font here has, of the pictures drawn so far."""
    style = sys.modules.get("compass.pictures.style")
    if style and (letters := style.boxes()):
        shown = " ".join(letters[:20]) + (" ..." if len(letters) > 20 else "")
        say(f"no font here has {shown}: drawn as boxes; install a font that has them, such as Noto")


def put_pictures(draw: "Callable[[], tuple[Picture, ...]]", folder: Path | None) -> None:
    """Draw pictures and write them into a folder that is wanted, and say so."""
    if folder is not None:
        from compass.pictures.files import write_pictures

        pictures = draw()
        write_pictures(pictures, folder)
        say(f"wrote {len(pictures)} pictures into {folder}")


def command_line() -> str:
    """Return the command as typed, for provenance."""
    import shlex

    return readable(shlex.join(["compass", *sys.argv[1:]]))


def announce_compilation() -> None:
    """Say once when a kernel is about to be compiled, until the running command ends.

    Compiled kernels are kept on disk, so this happens on a first run only.
    """
    from compass.core.compiling import listeners

    wanted = watched()  # a thread that compiles knows no command
    said = False

    def tell() -> None:
        nonlocal said
        from compass.core import kernel_cache

        if wanted and not said:
            said = True
            if kernel_cache.is_lasting():
                say("first run: compiling kernels, up to a minute; later runs start at once")
            else:
                say(f"compiling kernels, up to a minute: {kernel_cache.REMEDY}")

    listeners.append(tell)
    click.get_current_context().call_on_close(lambda: listeners.remove(tell))


def silence_the_cluster() -> None:
    """Keep the cluster's own messages from stderr: what matters is said here."""
    import logging
    from contextlib import suppress

    with suppress(ImportError):  # as the cluster says
        import distributed  # noqa: F401  # which sets its loggers' levels itself
    for name in ("distributed", "distributed.client", "tornado.application"):
        logging.getLogger(name).setLevel(logging.CRITICAL)

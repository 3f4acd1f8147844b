"""The ``compass`` program: finds its commands, and turns errors into one message and an exit code.

Every other module of this folder that defines ``command`` is a subcommand named by its file.
"""

import errno
import functools
import logging
import os
import re
import signal
import sys
import traceback
from _thread import interrupt_main
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from copy import copy
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from threading import Timer
from types import FrameType
from typing import Any, TextIO

import click
from click.core import ParameterSource

import compass
from compass.allowed import RANGES
from compass.cli.clock import clock
from compass.cli.parameters import meant
from compass.cli.shared import (
    CLAIM_FAILS,
    JSON,
    QUIET,
    announce_compilation,
    print_result,
    say_boxes,
    watched,
)
from compass.errors import ArgumentError, CompassError

#: Files beside those of commands: this one and what they share.
SHARED = ("clock", "main", "options", "parameters", "shared")

DONE, BAD_INPUT, BROKEN, INTERRUPTED = 0, 2, 3, 130

#: Seconds after which a ^C that went where nothing can be raised is raised again.
RETRY_S = 0.05


class WholeNumber(click.types.IntParamType):
    """Whole numbers that a kernel can take: of 64 bits, which no help needs to recite."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number; refuse one that is too large."""
        number = super().convert(value, param, ctx)
        if not -(2**63) <= number < 2**63:
            self.fail(f"{number} is not in the range -2**63 to 2**63 - 1.", param, ctx)
        return number


class Commands(click.Group):
    """A group whose subcommands are the modules of ``compass.cli``, imported when named."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the command files, without this one and what they share."""
        package = import_module("compass.cli")
        names = (module.name for module in iter_modules(package.__path__))
        return sorted(name for name in names if name not in SHARED)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import the file of a command."""
        return _loaded(name) if name in self.list_commands(ctx) else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command named; of one that there is not, name the one that is near."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            ctx.fail(error.message + meant(args[0], self.list_commands(ctx)))

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; a reader of its pipe that has seen enough (head, say) ends it well."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            _give_up(sys.stdout)
            return DONE


@functools.cache
def _loaded(name: str) -> click.Command:
    return prepared(import_module(f"compass.cli.{name}").command)


def prepared(command: click.Command) -> click.Command:
    """Return a file's command as the program has it: what it returns is printed.

    Its numbers are bounded, their ranges shown, its refusals in words of the user; ``--json``
    and ``--quiet`` are options of every command.
    """
    loaded = copy(command)
    loaded.params = [
        *(copy(parameter) for parameter in loaded.params),
        _flag(JSON, "--json", help="Print one JSON object on stdout and nothing else."),
        _flag(QUIET, "-q", "--quiet", help="No progress, no messages; results and errors alone."),
    ]
    for parameter in loaded.params:
        if parameter.type is click.INT:
            parameter.type = WholeNumber()
        allowed = RANGES.get(f"{command.name}.{parameter.name}", RANGES.get(str(parameter.name)))
        if isinstance(parameter, click.Option) and allowed is not None:
            parameter.help = f"{parameter.help}  [{allowed}]"
    if loaded.callback is not None:
        loaded.callback = _printed(loaded.callback)
    return loaded


def _flag(key: str, *names: str, help: str) -> click.Option:
    """Return an option that is kept in the command's context, for whoever prints or says."""

    def keep(context: click.Context, _parameter: click.Parameter, wanted: bool) -> None:
        context.meta[key] = wanted

    return click.Option(names, is_flag=True, expose_value=False, callback=keep, help=help)


def _printed(callback: Callable[..., Any]) -> Callable[..., None]:
    """Print what a command returns, if anything; errors name the option or file they are about."""

    @functools.wraps(callback)
    def call(*arguments: Any, **options: Any) -> None:
        announce_compilation()
        name = click.get_current_context().info_name or ""
        try:
            with clock(name, watched()):
                result = callback(*arguments, **options)
        except ArgumentError as error:
            said = in_words_of_the_user(str(error), click.get_current_context())
            raise ArgumentError(said) from error
        say_boxes()
        if result is not None:
            print_result(result)

    return call


def in_words_of_the_user(message: str, context: click.Context) -> str:
    """Name the option that a message is about; else the file, if there is one and it does not."""
    heads = re.match(r"\w+(?:(?:, | and )\w+)*(?=[ :])", message)
    names = re.split(", | and ", heads[0]) if heads else []
    parameters = context.command.params
    for parameter in parameters:
        if context.get_parameter_source(parameter.name or "") is not ParameterSource.COMMANDLINE:
            continue
        option = max(parameter.opts, key=len)
        words = option.removeprefix("--").replace("-", "_") + "_"
        if len(names) > 1 and parameter.name in names:  # arguments, which no file has
            return _with_options(message, parameters)
        if len(names) == 1 and (parameter.name == names[0] or words.startswith(f"{names[0]}_")):
            message = option + message[len(names[0]) :]  # its unit may be left out
            break
    files = list(_files(context))
    if not files:
        return _with_options(message, parameters)
    if message.startswith("--") or any(file in message for file in files):
        return message
    return f"{', '.join(files)}: {message}"


def _files(context: click.Context) -> Iterator[str]:
    """Names of the files that a command was given, the outputs of options apart."""
    for parameter in context.command.params:
        if isinstance(parameter, click.Argument):
            given = context.params.get(parameter.name or "")
            for value in given if isinstance(given, tuple) else (given,):
                if isinstance(value, Path):
                    yield str(value)


def _with_options(message: str, parameters: list[click.Parameter]) -> str:
    """Name the options wherever their names stand: there is no file that they could be keys of."""
    names = {p.name: max(p.opts, key=len) for p in parameters if isinstance(p, click.Option)}
    name = "|".join(sorted(map(str, names), key=len, reverse=True))
    # names that are words of the language as well are taken for names in a list of such alone
    told = rf"(?<![-\w])(?:(?:{name})(?:(?:, | and )(?:{name}))+|\w+_\w+)\b"
    message = re.sub(
        told, lambda part: re.sub(r"\w+", lambda w: names.get(w[0], w[0]), part[0]), message
    )
    first = re.match(r"\w+(?=[ :])", message)
    return names.get(first[0], first[0]) + message[first.end() :] if first else message


@click.command(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(compass.__version__, prog_name="compass")
def program() -> None:
    """Design navigation constellations around Mars.

    A design file goes in; coverage, geometry, access and landing-navigation quality come out.
    Exit status: 0 done, 1 the claim asked about does not hold, 2 bad usage or bad input, 3 the
    program itself failed, 130 interrupted.
    """


def main() -> None:
    """Run the program; errors that a user can mend become one message and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a name may have what the terminal cannot write
            stream.reconfigure(errors="backslashreplace")
    os.environ["MPLBACKEND"] = "agg"  # a notebook's may not be installed here
    # and where its folder cannot be written, how it helps itself is nobody's business
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    with _interrupts_noted() as interrupts:
        try:
            status = _status()
        except Exception:  # of ours, unless it is what became of ^C on its way up
            status = INTERRUPTED if interrupts else BROKEN
            if status == BROKEN:
                _say(traceback.format_exc().rstrip())
        if interrupts and status in (DONE, CLAIM_FAILS):  # what was found by then is an answer
            status = INTERRUPTED
            _say("interrupted; what is printed is what was known by then")
        elif status == INTERRUPTED:
            _say("interrupted; nothing half-written was left behind")
        sys.exit(_written(status))


def _status() -> int:
    """Run the program and return its exit code, every error said."""
    try:
        status = program.main(standalone_mode=False)
    except click.exceptions.Exit as finished:
        status = finished.exit_code
    except click.ClickException as error:
        with suppress(OSError):
            error.show()
        return BAD_INPUT
    except CompassError as error:
        _say(str(error))
        return BAD_INPUT
    except MemoryError:
        _say("not enough memory; take fewer or larger steps, or a machine with more")
        return BAD_INPUT
    except OSError as error:
        _say(_of_the_system(error))
        return BAD_INPUT
    except (KeyboardInterrupt, click.exceptions.Abort) as stop:
        # click's own error has the interruption as its cause
        for note in getattr(stop.__cause__ or stop, "__notes__", ()):
            _say(note)
        return INTERRUPTED
    except SystemExit:  # click's, when nobody reads its help
        _give_up(sys.stdout)
        return DONE
    return status if isinstance(status, int) else DONE


def _of_the_system(error: OSError) -> str:
    """Return the system's word, where no command has a better one."""
    if error.filename is not None:
        return f"{error.filename}: {error.strerror}; give another name"
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
        return f"the output cannot be written: {error.strerror}; make room, or send it elsewhere"
    return f"the system refuses: {error.strerror or error}; see what it lacks, and try again"


@contextmanager
def _interrupts_noted() -> Iterator[list[int]]:
    """Note each ^C: what it interrupts may turn it into an error of another kind.

    Or lose it: what is raised while an import clears up its locks goes to a hook, no further; and
    LLVM, which asks Python for compiled code, does not survive that. It comes a moment later then.
    """
    noted: list[int] = []

    def later() -> None:
        once_more = Timer(RETRY_S, interrupt_main)
        once_more.daemon = True
        once_more.start()

    def note(number: int, frame: FrameType | None) -> None:
        noted.append(number)
        if _in_llvm(frame):
            later()
        else:
            raise KeyboardInterrupt

    def again(lost: "sys.UnraisableHookArgs") -> None:
        if isinstance(lost.exc_value, KeyboardInterrupt):
            later()
        else:
            hook(lost)

    hook = sys.unraisablehook
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # ^C is ignored, or someone else's
        yield noted
        return
    signal.signal(signal.SIGINT, note)
    sys.unraisablehook = again
    try:
        yield noted
    finally:
        signal.signal(signal.SIGINT, before)
        sys.unraisablehook = hook


def _in_llvm(frame: FrameType | None) -> bool:
    """Whether LLVM is at work below, and waits for what Python answers."""
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith("llvmlite."):
            return True
        frame = frame.f_back
    return False


def _say(message: str) -> None:
    """Say something on stderr, if it can be written to; a terminal obeys nothing of it."""
    shown = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in message)
    with suppress(OSError):
        click.echo(shown, err=True)


def _written(status: int) -> int:
    """Bring what was printed to its place; what has none is an error, unless there was another."""
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except BrokenPipeError:
            _give_up(stream)
        except OSError as error:
            _give_up(stream)
            if status in (DONE, CLAIM_FAILS):
                status = BAD_INPUT
                _say(_of_the_system(error))
    return status


def _give_up(stream: TextIO) -> None:
    """Let what is still to be written to a stream go nowhere, at exit too."""
    with suppress(OSError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


if __name__ == "__main__":
    main()

"""The ``compass`` program: its commands, and errors as one message and an exit code."""

import errno
import functools
import logging
import os
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TextIO

import click

import compass
from compass.cli.clock import clock
from compass.cli.commands import COMMANDS
from compass.cli.interruption import interrupts_noted
from compass.cli.options import told_of
from compass.cli.parameters import meant, parameter
from compass.cli.refusals import check_given, in_words_of_the_user
from compass.cli.running import called
from compass.cli.shared import (
    CLAIM_FAILS,
    JSON,
    QUIET,
    announce_compilation,
    print_result,
    say_boxes,
    watched,
)
from compass.cli.special import SPECIAL
from compass.errors import ArgumentError, CompassError, near

DONE, BAD_INPUT, BROKEN, INTERRUPTED = 0, 2, 3, 130


class Commands(click.Group):
    """A group of the commands of `compass.cli.commands`."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Make a command."""
        return command(name) if name in COMMANDS else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command named; of one that there is not, name the one that is near."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            ctx.fail(error.message + meant(args[0], COMMANDS))

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; a reader of its pipe that has seen enough (head, say) ends it well."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            _give_up(sys.stdout)
            return DONE


@functools.cache
def command(name: str) -> click.Command:
    """Make a command of its name: what it is told is looked at, and what it finds is printed."""
    names, help = COMMANDS[name]
    told = {each: told_of(each, name) for each in names.split()}
    run = SPECIAL.get(name, functools.partial(called, name))

    def begin(**given: Any) -> object:
        check_given(given, told)
        return run(**given)

    parameters = [parameter(each, told[each]) for each in told]
    return prepared(click.Command(name, callback=begin, params=parameters, help=help))


def prepared(command: click.Command) -> click.Command:
    """Return a command as the program has it: what it returns is printed.

    Its refusals are in words of the user; ``--json`` and ``--quiet`` are options of every command.
    """
    command.params += [
        _flag(JSON, "--json", help="Print one JSON object on stdout and nothing else."),
        _flag(QUIET, "-q", "--quiet", help="No progress, no messages; results and errors alone."),
    ]
    if command.callback is not None:
        command.callback = _printed(command.callback)
    return command


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
    with interrupts_noted() as interrupts:
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
        if isinstance(error, click.NoSuchOption):  # click offers names that are not near
            offered = near(error.option_name, error.possibilities or ())
            error = click.NoSuchOption(error.option_name, possibilities=offered, ctx=error.ctx)
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

"""The ``compass`` program: finds its commands, and turns errors into one message and an exit code.

Every other module of this folder that defines ``command`` is a subcommand named by its file.
"""

import os
import sys
from importlib import import_module
from pkgutil import iter_modules

import click

import compass
from compass.errors import CompassError

DONE, CLAIM_FAILS, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class Commands(click.Group):
    """A group whose subcommands are the modules of ``compass.cli``, imported when named."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the command files, without this one and the shared ones."""
        package = import_module("compass.cli")
        names = (module.name for module in iter_modules(package.__path__))
        return sorted(name for name in names if name not in ("main", "shared"))

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import the file of a command."""
        if name not in self.list_commands(ctx):
            return None
        loaded = import_module(f"compass.cli.{name}").command
        assert isinstance(loaded, click.Command)
        return loaded


@click.command(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(compass.__version__, prog_name="compass")
def program() -> None:
    """Design navigation constellations around Mars.

    A design file goes in; coverage, geometry, access and landing-navigation quality come out.
    Exit status: 0 done, 1 the claim asked about does not hold, 2 bad usage or bad input.
    """


def main() -> None:
    """Run the program; errors that a user can mend become one message and exit code 2."""
    try:
        status = program.main(standalone_mode=False)
    except click.exceptions.Exit as finished:
        status = finished.exit_code
    except click.ClickException as error:
        error.show()
        status = BAD_INPUT
    except CompassError as error:
        click.echo(str(error), err=True)
        status = BAD_INPUT
    except BrokenPipeError:
        # The reader of a pipe (head, say) has seen enough; silence the flush at exit too.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = DONE
    except OSError as error:
        if error.filename is None:
            raise
        # the system's word on a file that the user named, where no command has a better one
        click.echo(f"{error.filename}: {error.strerror}; give another name", err=True)
        status = BAD_INPUT
    except (KeyboardInterrupt, click.exceptions.Abort):
        click.echo("interrupted; nothing half-written was left behind", err=True)
        status = INTERRUPTED
    sys.exit(status if isinstance(status, int) else DONE)


if __name__ == "__main__":
    main()

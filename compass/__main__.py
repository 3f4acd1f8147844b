"""Where the program begins: ^C is an interruption from the first import on."""

import atexit
import os
import signal
import sys
from typing import NoReturn

#: Bytes of address space and of data below which libraries end the program in ways of their own.
LEAST = {"-v": 500_000_000, "-d": 200_000_000}


def check_room() -> None:
    """End with one line where the user's limit of memory leaves no room for the libraries."""
    from compass.memory import user_limits

    for option, most in user_limits().items():
        if most < LEAST[option]:
            print(
                f"not enough memory: a limit of {most / 1e9:.2g} GB (ulimit {option}) is less than "
                f"the {LEAST[option] / 1e9:g} GB with which this begins; allow more",
                file=sys.stderr,
            )
            sys.exit(2)


def main() -> None:
    """Run ``compass``."""
    check_room()
    try:
        from compass.cli.main import main as program
    except KeyboardInterrupt:
        print("interrupted; nothing half-written was left behind", file=sys.stderr)
        sys.exit(130)
    try:
        program()
    except SystemExit as ended:
        _leave(ended.code if isinstance(ended.code, int) else 0)


def _leave(status: int) -> NoReturn:
    """End the process as soon as what was to be done at the end is done.

    All is said by then. To take every library apart, as Python would, takes a fifth of a short
    command's time, and a ^C meanwhile would kill the process by its signal instead of giving 130.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    atexit._run_exitfuncs()
    os._exit(status)


if __name__ == "__main__":
    main()

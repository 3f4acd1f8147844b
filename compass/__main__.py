"""Where the program begins: ^C is an interruption from the first import on."""

import sys

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
    program()


if __name__ == "__main__":
    main()

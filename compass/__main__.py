"""Where the program begins: ^C is an interruption from the first import on."""

import sys


def main() -> None:
    """Run ``compass``."""
    try:
        from compass.cli.main import main as program
    except KeyboardInterrupt:
        print("interrupted; nothing half-written was left behind", file=sys.stderr)
        sys.exit(130)
    program()


if __name__ == "__main__":
    main()

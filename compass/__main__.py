"""``python -m compass``: the program."""

from compass.cli.main import main

main()

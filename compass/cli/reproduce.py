"""``compass reproduce``: a source paper, number by number."""

from pathlib import Path

import compass
from compass.cli.options import takes
from compass.cli.parameters import Word, argument
from compass.cli.shared import put
from compass.papers import PAPERS


@takes("paper output", paper=argument(type=Word(PAPERS)))
def command(paper: str, output: Path | None) -> object:
    """Every number of a source PAPER: published, computed, and who is right.

    Exit status 1 if a number differs and the paper is not shown to be wrong.
    """
    result = compass.reproduce(paper)
    put(result.write, output)
    return result

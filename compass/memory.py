"""What does not fit into this machine's memory is refused before it is begun."""

import os

from compass.errors import ArgumentError

#: Share of the memory that one thing may take.
MOST = 0.9


def check_fits(needed: float, asked: str, advice: str) -> None:
    """Refuse what takes more bytes than this machine can give.

    Parameters
    ----------
    needed
        Bytes.
    asked
        What takes them, as a sentence begins that goes on with "would take".
    advice
        What to do instead.

    Raises
    ------
    ArgumentError
        With how much it would take and how much there is.
    """
    there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > MOST * there:
        raise ArgumentError(
            f"{asked} would take {needed / 1e9:.3g} GB, this machine has {there / 1e9:.3g}; "
            f"{advice}"
        )

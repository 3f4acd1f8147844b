"""What does not fit into this machine's memory is refused before it is begun."""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from compass.errors import ArgumentError

#: Share of the memory that one thing may take.
MOST = 0.9


#: Files in which a container's limit stands, or a word where it has none.
CONTAINER = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)


def limits() -> Iterator[float]:
    """What this process may have at most, bytes: of the machine, a container, and the user."""
    yield os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for file in CONTAINER:
        with suppress(OSError, ValueError):
            yield int(file.read_text())
    yield from user_limits().values()


def user_limits() -> dict[str, float]:
    """What the user lets a process have at most, bytes, by the option of `ulimit` that says so."""
    try:
        import resource
    except ImportError:  # not on Windows
        return {}
    limits = {"-v": resource.getrlimit(resource.RLIMIT_AS)[0]}
    limits["-d"] = resource.getrlimit(resource.RLIMIT_DATA)[0]
    return {option: most for option, most in limits.items() if most != resource.RLIM_INFINITY}


def check_fits(needed: float, asked: str, advice: str) -> None:
    """Refuse what takes more bytes than there can be.

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
    there = min(limits())
    if needed > MOST * there:
        raise ArgumentError(
            f"{asked} would take {needed / 1e9:.3g} GB of memory, there are {there / 1e9:.3g}; "
            f"{advice}"
        )

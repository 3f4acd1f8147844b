"""Bars on stderr for what takes time; silent where nobody watches."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm

#: Seconds from which on a user wants to know beforehand.
LONG_S = 10.0


def bar(wanted: bool, title: str, items: Any = None, **options: Any) -> tqdm:
    """Return a bar (of items, if given); shown only if wanted and stderr is a terminal."""
    return tqdm(items, desc=title, disable=None if wanted else True, **options)


def foretell(wanted: bool, title: str, seconds: float, size: float | None = None) -> None:
    """Say on stderr what something will take, if that is wanted and long enough to be told."""
    if wanted and seconds > LONG_S:
        minutes = f"{seconds / 60:.2g} minutes" if seconds >= 120 else f"{seconds:.0f} s"
        room = "" if size is None else f" and {size / 1e9:.2g} GB"
        tqdm.write(f"{title}: about {minutes}{room}", file=sys.stderr)


@contextmanager
def parts_bar(wanted: bool, title: str) -> Iterator[Callable[[str, float], None]]:
    """Yield a function that is told what is worked on and which part of it is done, 0 to 1."""
    shape = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
    with bar(wanted, title, total=1.0, leave=False, bar_format=shape) as shown:

        def told(what: str, part: float) -> None:
            shown.set_description_str(f"{title}: {what}", refresh=False)
            shown.update(part - shown.n)
            shown.refresh()

        yield told

"""Bars on stderr for what takes time; silent where nobody watches."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm


def bar(wanted: bool, title: str, items: Any = None, **options: Any) -> tqdm:
    """Return a bar (of items, if given); shown only if wanted and stderr is a terminal."""
    return tqdm(items, desc=title, disable=None if wanted else True, **options)


@contextmanager
def parts_bar(wanted: bool, title: str) -> Iterator[Callable[[str, float], None]]:
    """Yield a function that is told what is worked on and which part of it is done, 0 to 1."""
    shape = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
    with bar(wanted, title, total=1.0, leave=False, bar_format=shape) as shown:

        def told(what: str, part: float) -> None:
            shown.set_description(f"{title}: {what}", refresh=False)
            shown.update(part - shown.n)
            shown.refresh()

        yield told

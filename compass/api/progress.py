"""Bars on stderr for what takes time; silent where nobody watches."""

from typing import Any

from tqdm import tqdm


def bar(wanted: bool, title: str, items: Any = None, **options: Any) -> tqdm:
    """Return a bar (of items, if given); shown only if wanted and stderr is a terminal."""
    return tqdm(items, desc=title, disable=None if wanted else True, **options)

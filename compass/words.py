"""Words with numbers in sentences."""

from collections.abc import Sequence


def counted(number: int, noun: str) -> str:
    """A number and its noun, which has an s unless there is one: ``1 satellite, 2 satellites``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def listed(names: Sequence[str]) -> str:
    """Names in a row: "a, b and c"."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last

"""Who is told that a kernel is about to be compiled, and the time that this takes.

Both are asked for before Numba is loaded.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from time import monotonic

#: Called, from whichever thread compiles, before each compilation.
listeners: list[Callable[[], None]] = []

#: Called when this process begins to compile (True) and when it has done (False).
watchers: list[Callable[[bool], None]] = []


class _Stopwatch:
    """Seconds in which some thread of this process compiled, or waited for one that did."""

    def __init__(self) -> None:
        self._lock, self._busy, self._since, self._spent = Lock(), 0, 0.0, 0.0

    def begin(self) -> bool:
        """Count one more; return whether it is the only one."""
        with self._lock:
            if not self._busy:
                self._since = monotonic()
            self._busy += 1
            return self._busy == 1

    def end(self) -> bool:
        """Count one fewer; return whether none is left."""
        with self._lock:
            self._busy -= 1
            if not self._busy:
                self._spent += monotonic() - self._since
            return not self._busy

    def rest(self) -> float:
        """Seconds, as `monotonic` counts them, less those."""
        with self._lock:
            now = monotonic()
            return now - self._spent - (now - self._since if self._busy else 0.0)


_STOPWATCH = _Stopwatch()


@contextmanager
def compiling() -> Iterator[None]:
    """Stop `worked` while a kernel is compiled."""
    if _STOPWATCH.begin():
        for tell in tuple(watchers):
            tell(True)
    try:
        yield
    finally:
        if _STOPWATCH.end():
            for tell in tuple(watchers):
                tell(False)


def worked() -> float:
    """Seconds since some moment, but for those in which this process compiled, as budgets count."""
    return _STOPWATCH.rest()

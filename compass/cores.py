"""How many threads to work with, and work shared among them."""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Found = TypeVar("Found")


def cores(asked: int | None = None) -> int:
    """As many as were asked for, or one a core that this process may run on.

    A batch system gives a job some cores of a node; work for all of the node's would crowd them,
    and every thread holds memory of its own.
    """
    if asked:
        return asked
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def shared(work: Callable[[Item], Found], items: Iterable[Item]) -> Iterator[Found]:
    """Yield what comes of each item, in order, one thread a core; ^C begins no further one."""
    pool = ThreadPoolExecutor(cores())
    try:
        yield from pool.map(work, items)
    finally:
        pool.shutdown(cancel_futures=True)

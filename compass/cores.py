"""How many threads to work with, and work shared among them."""

import os
from collections.abc import Callable, Generator, Iterable
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


def in_blocks(
    work: Callable[[slice], object], count: int, block: int, threads: int | None = None
) -> None:
    """Hand numbers below `count` to `work` in slices of `block`, shared among threads.

    What is a single block's, or a single thread's, is done in the thread at hand: one started for
    it costs more than a short filter run.
    """
    parts = [slice(first, min(first + block, count)) for first in range(0, count, block)]
    if len(parts) == 1 or cores(threads) == 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(cores(threads)) as pool:
        list(pool.map(work, parts))


def shared(
    work: Callable[[Item], Found], items: Iterable[Item], threads: int | None = None
) -> Generator[Found, None, None]:
    """Yield what comes of each item, in order; ^C, or who asks no more, begins no further one.

    A single thread is the one at hand.
    """
    if cores(threads) == 1:
        yield from map(work, items)
        return
    pool = ThreadPoolExecutor(cores(threads))
    try:
        yield from pool.map(work, items)
    finally:
        pool.shutdown(cancel_futures=True)

"""How many threads to work with."""

import os


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

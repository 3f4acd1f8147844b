"""Who does the work: this process or processes of its own; for a Dask cluster see `cluster`.

Every kind has ``run(stage, batches)``, which yields each batch with what was found, in the order
in which they finish, and keeps only a few batches a worker on their way: a queue of millions
would burden a scheduler, and what is on its way is what a kill loses. A batch whose worker died
is given to another; after `ATTEMPTS` deaths it comes back with None.
"""

import os
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Protocol

from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.study.stages import Found, evaluate

#: Workers that may die of a batch before it is left out.
ATTEMPTS = 3

Result = tuple[NDArray, Found | None]


class Workers(Protocol):
    """Anything that puts batches of candidates through a stage."""

    count: int

    def run(self, stage: str, batches: Iterable[NDArray]) -> Iterator[Result]:
        """Yield each batch and what was found, as they finish."""

    def close(self) -> None:
        """Let the workers go."""


class Here:
    """The process itself."""

    count = 1

    def __init__(self, study: Study) -> None:
        self._study = study

    def run(self, stage: str, batches: Iterable[NDArray]) -> Iterator[Result]:
        """As `Workers.run`."""
        for rows in batches:
            yield rows, evaluate(stage, self._study, rows)

    def close(self) -> None:
        """Nothing to let go."""


_study: Study  # of a worker process


def _begin(study: Study) -> None:
    """Start a worker process: keep the study, leave ^C to the client, and end when it ends."""
    import signal
    from multiprocessing import connection, parent_process

    global _study
    _study = study
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _work(stage: str, rows: NDArray) -> Found:
    return evaluate(stage, _study, rows)


class Processes:
    """Worker processes on this machine, replaced when they die."""

    def __init__(self, study: Study, count: int) -> None:
        self.count = count
        self._study = study
        self._pool = self._start()

    def _start(self) -> ProcessPoolExecutor:
        from multiprocessing import get_context

        return ProcessPoolExecutor(
            self.count, get_context("spawn"), initializer=_begin, initargs=(self._study,)
        )

    def run(self, stage: str, batches: Iterable[NDArray]) -> Iterator[Result]:
        """As `Workers.run`."""
        source, again = iter(batches), list[tuple[NDArray, int]]()
        flying: dict[Future[Found], tuple[NDArray, int]] = {}
        while True:
            while len(flying) < self.count + 1:
                rows, deaths = again.pop() if again else (next(source, None), 0)
                if rows is None:
                    break
                if deaths >= ATTEMPTS:
                    yield rows, None
                    continue
                try:
                    flying[self._pool.submit(_work, stage, rows)] = rows, deaths
                except BrokenProcessPool:  # noticed between two results
                    again.append((rows, deaths))
                    break
            if not flying and not again:
                return
            broken = not flying
            for future in wait(flying, return_when=FIRST_COMPLETED).done:
                rows, deaths = flying.pop(future)
                try:
                    yield rows, future.result()
                except BrokenProcessPool:
                    again.append((rows, deaths + 1))
                    broken = True
            if broken:  # all on their way are lost with the pool
                again += [(rows, deaths + 1) for rows, deaths in flying.values()]
                flying.clear()
                self._pool.shutdown(wait=False, cancel_futures=True)
                self._pool = self._start()

    def close(self) -> None:
        """End the processes; batches on their way are dropped."""
        processes = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()

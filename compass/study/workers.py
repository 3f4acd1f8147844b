"""Who does the work: this process, processes of its own, or a Dask cluster. Same numbers by each.

Every kind has ``run(stage, batches)``, which yields each batch with what was found, in the order
in which they finish, and keeps only a few batches a worker on their way: a queue of millions
would burden a scheduler, and what is on its way is what a kill loses. A batch whose worker died
is given to another; after `ATTEMPTS` deaths it comes back with None.
"""

import os
import queue
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, Protocol
from urllib.parse import urlsplit

from numpy.typing import NDArray

import compass
from compass.errors import ArgumentError, CompassError
from compass.inputs.study import Study
from compass.study.stages import Found, evaluate

#: Workers that may die of a batch before it is left out.
ATTEMPTS = 3

#: Batches on their way for each thread of a cluster.
AHEAD = 2

#: Seconds that a scheduler has to answer.
PATIENCE = 15.0

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


@dataclass(frozen=True)
class Tls:
    """Files of a cluster's TLS: certificate of the authority, own certificate, own key."""

    ca: Path
    cert: Path
    key: Path


def _remote(version: str, stage: str, study: Study, rows: NDArray) -> Found:
    """Work on a cluster, which must run the client's version."""
    if version != compass.__version__:
        raise CompassError(
            f"the cluster runs compass {compass.__version__}, this is {version}; "
            "install the same version on both"
        )
    return evaluate(stage, study, rows)


class Cluster:
    """A Dask cluster, by its scheduler's address.

    Raises
    ------
    ArgumentError
        The extra is not installed, the scheduler does not answer, or it has no workers.
    """

    def __init__(self, study: Study, address: str, tls: Tls | None = None) -> None:
        try:
            from distributed import Client, Security
        except ImportError as error:
            raise ArgumentError("--scheduler: needs Dask; install compass-mars[cluster]") from error
        place = urlsplit(address)
        try:
            known = place.hostname and place.port
        except ValueError:
            known = None
        if not known:
            raise ArgumentError(
                f"--scheduler = {address}: not an address; write it as tcp://host:port"
            )
        security = None
        if tls is not None:
            security = Security(
                tls_ca_file=str(tls.ca),
                tls_client_cert=str(tls.cert),
                tls_client_key=str(tls.key),
                require_encryption=True,
            )
        self._study, self._address = study, address
        try:
            self._client = Client(
                address, timeout=PATIENCE, security=security, set_as_default=False
            )
        except (OSError, TimeoutError, ValueError, TypeError) as error:
            raise ArgumentError(
                f"--scheduler = {address}: does not answer within {PATIENCE:g} s "
                f"({type(error).__name__}: {error}); check the address, that `dask scheduler` "
                "runs there, and TLS"
            ) from error
        try:
            self._client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            self.close()
            raise ArgumentError(
                f"--scheduler = {address}: has no worker; start `dask worker {address}`"
            ) from error
        self.count = sum(self._client.nthreads().values())

    def run(self, stage: str, batches: Iterable[NDArray]) -> Iterator[Result]:
        """As `Workers.run`.

        Raises
        ------
        CompassError
            The scheduler is lost, or runs another version.
        """
        source = iter(batches)
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        flying: dict[str, tuple[Any, NDArray]] = {}
        while True:
            while len(flying) < AHEAD * self.count and (rows := next(source, None)) is not None:
                future = self._client.submit(
                    _remote, compass.__version__, stage, self._study, rows, pure=False
                )
                flying[future.key] = future, rows
                future.add_done_callback(done.put)
            if not flying:
                return
            with suppress(queue.Empty):
                future = done.get(timeout=1.0)
                if future.key in flying:
                    _, rows = flying.pop(future.key)
                    yield rows, self._result(future)
                continue
            if self._client.status != "running":
                self._lost()

    def _result(self, future: Any) -> Found | None:
        from concurrent.futures import CancelledError

        from distributed.scheduler import KilledWorker

        try:
            found: Found = future.result(timeout=PATIENCE)
        except KilledWorker:
            return None
        except (CancelledError, OSError, TimeoutError):
            self._lost()
        return found

    def _lost(self) -> NoReturn:
        raise CompassError(
            f"--scheduler = {self._address}: lost; every finished candidate is stored; start the "
            "scheduler and workers again and run the same command"
        )

    def close(self) -> None:
        """Leave the cluster."""
        with suppress(Exception):
            self._client.close(timeout=2)

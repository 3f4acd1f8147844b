"""A Dask cluster as workers."""

import queue
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import urlsplit

from numpy.typing import NDArray

import compass
from compass.errors import ArgumentError, CompassError
from compass.inputs.study import Study
from compass.study.stages import Found, evaluate
from compass.study.workers import Result

#: Batches on their way for each thread of a cluster.
AHEAD = 2

#: Seconds that a scheduler has to answer.
PATIENCE = 15.0


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

"""A Dask cluster as workers, and how long a run waits for one that does not answer.

A machine that is cut off or stands still tells nobody, and TCP alone would wait for it without
end. So the scheduler is asked every `WATCH` seconds; one that is silent for `SILENCE` seconds is
lost, and so is a cluster without a worker for as long: in all, a run stops within a minute of the
cut. A shorter cut costs nothing but its time. A worker that is cut off is the scheduler's to
miss; its tasks go to others.
"""

import asyncio
import pickle
import queue
import ssl
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import inf
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from numpy.typing import NDArray

import compass
from compass.errors import ArgumentError, CompassError
from compass.study.errand import ByValue, able, work
from compass.words import counted

#: Does a stage of some work on rows: candidates of a study, or rows of a map.
Job = Callable[[str, NDArray], Any]

#: Batches on their way for each thread of a cluster.
AHEAD = 2

#: Workers that cannot do the work that are named.
NAMED = 5

#: Seconds that a scheduler has to answer at the start, and then to have a worker.
PATIENCE = 15.0

#: Seconds between two questions to the scheduler: is it there, who works for it?
WATCH = 5.0

#: Seconds for which a scheduler may be silent, or without a worker; Dask's own limit to drop a
#: client, so waiting longer would be in vain.
SILENCE = 30.0


@dataclass(frozen=True)
class Tls:
    """Files of a cluster's TLS: certificate of the authority, own certificate, own key."""

    ca: Path
    cert: Path
    key: Path

    def check(self) -> None:
        """Refuse files that are not what they should be.

        Raises
        ------
        ArgumentError
            One is not there, cannot be read or is not PEM, or the key is of another certificate.
        """
        for file in (self.ca, self.cert, self.key):
            if not file.is_file():
                raise ArgumentError(f"{file}: no such file; give a certificate or key (PEM)")
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        try:
            context.load_verify_locations(self.ca)
        except OSError as error:
            raise ArgumentError(
                f"--tls-ca = {self.ca}: not a certificate of an authority (PEM): {_why(error)}"
            ) from error
        try:
            context.load_cert_chain(self.cert, self.key)
        except OSError as error:
            raise ArgumentError(
                f"--tls-cert = {self.cert}, --tls-key = {self.key}: not a certificate and its key "
                f"(PEM): {_why(error)}"
            ) from error


def evaluated(stage: str, job: bytes, rows: bytes) -> Any:
    """Do a stage of a job on some rows, that come pickled."""
    return _unpacked(job)(stage, pickle.loads(rows))


@lru_cache(maxsize=4)
def _unpacked(job: bytes) -> Job:
    unpacked: Job = pickle.loads(job)
    return unpacked


class Cluster:
    """A Dask cluster, by its scheduler's address.

    Parameters
    ----------
    job
        What is sent to the machines and does the work there: called with a stage and some rows.
    address, tls
        Of the scheduler.
    kept
        What a user has of the work if it ends before its time.

    Raises
    ------
    ArgumentError
        The extra is not installed, the files of TLS are no good, or the scheduler does not
        answer, is none, has no workers, or one that cannot do the work.
    """

    def __init__(
        self,
        job: Job,
        address: str,
        tls: Tls | None = None,
        *,
        kept: str = "every finished candidate is stored",
    ) -> None:
        try:
            from distributed import Client, Security
        except ImportError as error:
            raise ArgumentError("--scheduler: needs Dask; install compass-mars[cluster]") from error
        self._job, self._option = pickle.dumps(job), f"--scheduler = {address}"
        self._kept = kept
        address = self._checked(address, tls)
        security = Security()  # of Dask's own configuration
        if tls is not None:
            tls.check()
            security = Security(
                tls_ca_file=str(tls.ca),
                tls_client_cert=str(tls.cert),
                tls_client_key=str(tls.key),
                require_encryption=True,
            )
        elif address.startswith("tls:") and not security.tls_ca_file:
            raise ArgumentError(
                f"{self._option}: needs certificates; give --tls-ca, --tls-cert and --tls-key"
            )
        self._greet(address, security)
        try:
            self._client = Client(
                address, timeout=PATIENCE, security=security, set_as_default=False
            )
        except OSError as error:
            raise ArgumentError(f"{self._option}: went away; try again") from error
        try:
            self._client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            self.close()
            raise ArgumentError(
                f"{self._option}: has no worker; start `dask worker {address}`"
            ) from error
        self._work = ByValue(work)
        try:
            self._check_workers()
            self.count, self._attended = 1, time.monotonic()
            self._answered = inf  # since when; until then machines load and compile
            self._look()
        except BaseException:
            self.close()
            raise

    def _check_workers(self) -> None:
        """Refuse workers that cannot do the work, which would lose them."""
        try:
            versions = self._client.get_versions()["workers"]
            here = ".".join(map(str, sys.version_info[:2]))
            unfit = {
                where: f"Python {theirs}, this is {here}"
                for where, found in versions.items()
                if (theirs := ".".join(found["host"]["python"].split(".")[:2])) != here
            }
            alike = [where for where in versions if where not in unfit]
            for where, found in self._client.run(ByValue(able), workers=alike).items():
                if found != compass.__version__:
                    other = f"compass {found}, this is {compass.__version__}"
                    unfit[where] = found if " " in found else other
        except OSError as error:
            raise self._lost() from error
        if unfit:
            named = "; ".join(f"{where}: {why}" for where, why in sorted(unfit.items())[:NAMED])
            raise ArgumentError(
                f"{self._option}: {len(unfit)} of {counted(len(versions), 'worker')} "
                f"cannot do the work: {named}; they are left as they are: "
                f"install compass-mars {compass.__version__} with the same Python there, or "
                "end them"
            )

    def _checked(self, address: str, tls: Tls | None) -> str:
        """Return the address as Dask wants it."""
        try:
            place = urlsplit(address.strip())
            known = place.scheme in ("tcp", "tls") and place.hostname and place.port
            if not known or place.username is not None or place.path not in ("", "/"):
                raise ValueError
        except ValueError as error:
            raise ArgumentError(
                f"{self._option}: not an address; write it as tcp://host:port or, with TLS, "
                "tls://host:port"
            ) from error
        if tls is not None and place.scheme != "tls":
            raise ArgumentError(f"{self._option}: with certificates, write it as tls://host:port")
        return f"{place.scheme}://{place.netloc}"

    def _greet(self, address: str, security: Any) -> None:
        """Find out who is there; Dask's client would wait without end for one that is silent."""
        from distributed import rpc

        async def identity() -> dict[str, Any]:
            arguments = security.get_connection_args("client")
            there = rpc(address, timeout=PATIENCE / 2, connection_args=arguments)
            try:
                found: dict[str, Any] = await there.identity()
            finally:
                await there.close_rpc()
            return found

        remedy = "check the address, that `dask scheduler` runs there, and whether it has TLS"
        try:
            found = asyncio.run(asyncio.wait_for(identity(), PATIENCE))
        except TimeoutError as error:
            raise ArgumentError(
                f"{self._option}: does not answer within {PATIENCE:g} s; {remedy}"
            ) from error
        except OSError as error:
            raise ArgumentError(
                f"{self._option}: no connection: {_why(error)}; {remedy}"
            ) from error
        if found.get("type") != "Scheduler":
            raise ArgumentError(f"{self._option}: a Dask {found.get('type')}, not a scheduler")

    def now(self) -> float:
        """As `Workers.now`, but stands until the first answer: who compiles is not known."""
        return max(time.monotonic() - self._answered, 0.0)

    def run(
        self, stage: str, batches: Iterable[NDArray], until: float = inf
    ) -> Iterator[tuple[NDArray, Any]]:
        """As `Workers.run`; a machine ends what it has begun, and nobody asks for it.

        Raises
        ------
        CompassError
            The scheduler is lost, has no worker any more, or a worker cannot do the work.
        """
        source = iter(batches)
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        flying: dict[str, tuple[Any, NDArray]] = {}
        suspects: list[NDArray] = []

        def fly(rows: NDArray) -> None:
            future = self._submit(stage, rows)
            flying[future.key] = future, rows
            future.add_done_callback(done.put)

        while (now := self.now()) < until:
            if time.monotonic() - self._looked > WATCH:
                self._look()
            while len(flying) < AHEAD * self.count and (rows := next(source, None)) is not None:
                fly(rows)
            if not flying and suspects:
                # alone: Dask blames a death on all that its worker had
                fly(suspects.pop())
            if not flying:
                return
            try:
                future = done.get(timeout=min(WATCH, until - now))
                found = self._result(future)
            except queue.Empty:
                continue
            except OSError:  # its worker went away with what it found, and another begins anew
                self._look()
                future.add_done_callback(done.put)
            else:
                _, rows = flying.pop(future.key)
                self._answered = min(self._answered, time.monotonic())
                if found is None and rows.size > 1:
                    suspects += [rows[k : k + 1] for k in range(rows.size)]
                else:
                    yield rows, found
        self._client.cancel([future for future, _ in flying.values()])

    def _submit(self, stage: str, rows: NDArray) -> Any:
        from distributed.client import ClosedClientError

        try:
            arguments = compass.__version__, stage, self._job, pickle.dumps(rows)
            return self._client.submit(self._work, *arguments, pure=False)
        except ClosedClientError as error:
            raise self._lost() from error

    def _result(self, future: Any) -> Any:
        from distributed import CancelledError
        from distributed.scheduler import KilledWorker

        try:
            worst = future.result(timeout=PATIENCE)
        except KilledWorker:
            return None
        except CancelledError as error:  # as all are when the connection breaks
            raise self._lost() from error
        except (OSError, CompassError):
            raise
        except Exception as error:  # what a candidate raises is in what was found
            raise CompassError(
                f"{self._option}: cannot do the work ({_why(error)}); have compass "
                f"{compass.__version__} and the same Python and Dask on every worker, and run the "
                f"same command; {self._kept}"
            ) from error
        return worst

    def _look(self) -> None:
        """Ask the scheduler for its workers, whose number may change.

        Raises
        ------
        CompassError
            It is silent, or has had none for long.
        """
        try:
            count = sum(self._client.nthreads(callback_timeout=SILENCE).values())
        except Exception as error:  # of whatever kind: there is no answer
            raise self._lost() from error
        self._looked = time.monotonic()
        if count:
            self.count, self._attended = count, self._looked
        elif self._looked - self._attended > SILENCE:
            raise CompassError(
                f"{self._option}: has had no worker for {SILENCE:g} s; {self._kept}; start workers "
                "again and run the same command"
            )

    def _lost(self) -> CompassError:
        return CompassError(
            f"{self._option}: lost; {self._kept}; see that the network is there and the scheduler "
            "and its workers run, and run the same command"
        )

    def close(self) -> None:
        """Leave the cluster; its scheduler drops what is not finished."""
        try:
            self._client.close(timeout=2)
        except Exception:
            self._client.status = "closed"  # or it tries again, and longer, as the program ends


def _why(error: BaseException) -> str:
    """Say on one line what is at the bottom of an error."""
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join(f"{type(error).__name__}: {error}".split())

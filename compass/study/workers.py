"""Who does the work: processes of this machine; for a Dask cluster see `cluster`.

Every kind has ``run(stage, batches, until)``, which yields each batch with what was found, in the
order in which they finish, and keeps only a few batches a worker on their way: a queue of millions
would burden a scheduler, and what is on its way is what a kill loses. So does the time `until`
which it may take, as its own ``now()`` tells it: what has been begun by then is given up. That
clock stands while a worker loads what it needs and while kernels are compiled, there or here.
A batch whose worker died is given to another; after `ATTEMPTS` deaths (Dask has its own limit) and
when all others are through, its candidates are tried one by one. Only one that kills again comes
back with None.
"""

import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from math import inf
from multiprocessing import connection, get_context, parent_process, resource_tracker
from types import ModuleType
from typing import Any, Protocol

from numpy.typing import NDArray

from compass.core.compiling import watchers, worked
from compass.errors import CompassError
from compass.inputs.study import Study
from compass.study.stages import Found, evaluate

#: Workers that may die of a batch before its candidates are tried one by one.
ATTEMPTS = 3

#: Batches that a process has at once: one that it works on, and one so that it need not wait.
HELD = 2

#: Seconds between two signs of life of a process, and for how long one that gives none is waited
#: for: a stopped process is not dead, and would be waited for without end. A process that works
#: gives its signs beside its work; until the first it is loading what it needs.
BEAT, SILENCE, LOADING = 5.0, 60.0, 600.0

Result = tuple[NDArray, Found | None]


class Workers(Protocol):
    """Anything that puts batches of candidates through a stage."""

    count: int

    def run(self, stage: str, batches: Iterable[NDArray], until: float = inf) -> Iterator[Result]:
        """Yield each batch and what was found, as they finish, until a time."""

    def now(self) -> float:
        """Seconds of work since some moment."""

    def close(self) -> None:
        """Let the workers go."""


def _serve(end: connection.Connection, study: Study, beat: float) -> None:
    """Work in a process of its own: leave ^C to the client, give signs of life, end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent, sending = parent_process(), threading.Lock()
    assert parent is not None

    def send(what: Found | bool | None) -> None:
        with sending:
            end.send(what)

    def tell(stands: bool) -> None:
        with suppress(OSError):  # the client is gone
            send(stands)

    def watch() -> None:
        with suppress(OSError):
            while not connection.wait([parent.sentinel], timeout=beat):
                send(None)
        os._exit(1)

    watchers.append(tell)
    tell(False)
    threading.Thread(target=watch, daemon=True).start()
    try:
        while True:
            stage, rows = end.recv()
            send(evaluate(stage, study, rows))
    except (EOFError, OSError):
        pass  # the client is gone


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Let a process begin that ^C in the terminal, which goes to all, does not reach."""
    resource_tracker.ensure_running()  # its own start would let them through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _callers_script_hidden() -> Iterator[None]:
    """Let a process begin without running the caller's script again, which would start it over."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


class _Process:
    """A worker process, and the batches that it has, with the deaths that each has caused."""

    def __init__(self, study: Study) -> None:
        context = get_context("spawn")
        self.held: deque[tuple[NDArray, int]] = deque()
        self.silent, self.heard = 0.0, False  # for so many seconds; and whether ever
        self.stands = True  # it loads or compiles
        try:
            self.end, its = context.Pipe()
            self._process = context.Process(target=_serve, args=(its, study, BEAT), daemon=True)
            with _interrupts_held_back(), _callers_script_hidden():
                self._process.start()
        except OSError as error:  # too many open files or processes
            raise CompassError(
                f"a worker process cannot be started: {error.strerror}; give fewer with --workers; "
                "every finished candidate is stored"
            ) from error
        its.close()  # so that its death is the end of the connection

    @property
    def is_lost(self) -> bool:
        """Whether it has been silent for too long."""
        return self.silent >= (SILENCE if self.heard else LOADING)

    def give(self, stage: str, rows: NDArray, deaths: int) -> None:
        """Add a batch to what it has."""
        self.held.append((rows, deaths))
        with suppress(OSError):  # it is dead, as whoever waits for it will see
            self.end.send((stage, rows))

    def take(self) -> Found | None:
        """What it found of the first batch that it has; None for any other sign of life.

        Raises
        ------
        OSError
            It died.
        """
        try:
            found: Found | bool | None = self.end.recv()
        except EOFError as error:
            raise BrokenPipeError from error
        if isinstance(found, bool):
            self.stands = found
            return None
        return found

    def stop(self) -> str:
        """End it, even if it stands still; return how it ended."""
        self._process.kill()
        self._process.join()
        self.end.close()
        code = self._process.exitcode or 0
        return signal.Signals(-code).name if code < 0 else f"exit status {code}"


class Processes:
    """Worker processes on this machine, replaced when they die.

    Each has its own batches, so that one that dies harms no other and the batch that it died of
    is known.
    """

    def __init__(self, study: Study, count: int) -> None:
        self.count = count
        self._study = study
        self._team: list[_Process] = []  # begun when there is something to do
        self._deaths, self._proven, self._round = 0, False, time.monotonic()
        self._stood, self._since = 0.0, inf  # so long; and since when now, if it does

    def now(self) -> float:
        """As `Workers.now`."""
        return worked() - self._stood - max(worked() - self._since, 0.0)

    def _look_who_stands(self) -> None:
        """Note whether the clock stands from now on: somebody who has work loads or compiles."""
        now = worked()
        if any(worker.held and worker.stands for worker in self._team):
            self._since = min(self._since, now)
        else:
            self._stood, self._since = self._stood + max(now - self._since, 0.0), inf

    def run(self, stage: str, batches: Iterable[NDArray], until: float = inf) -> Iterator[Result]:
        """As `Workers.run`.

        Raises
        ------
        CompassError
            Worker after worker dies, before any has found anything.
        """
        source, again = iter(batches), deque[tuple[NDArray, int]]()
        self._give_up()  # what an earlier run has left
        while self.now() < until:
            while sum(len(w.held) for w in self._team) < HELD * self.count:
                if (rows := next(source, None)) is not None:
                    self._freest().give(stage, rows, 0)
                elif again:
                    self._freest().give(stage, *again.popleft())
                else:
                    break
            self._look_who_stands()
            ends: dict[Any, _Process] = {w.end: w for w in self._team if w.held}
            if not ends:
                return
            for worker in self._heard(ends, until):
                try:
                    if worker.is_lost:
                        raise TimeoutError
                    if (found := worker.take()) is None:
                        continue
                    self._proven = True
                    yield worker.held.popleft()[0], found
                    continue
                except OSError:
                    rows, deaths = worker.held.popleft()
                again += worker.held  # which are not to blame
                self._count_death(worker)
                if deaths + 1 < ATTEMPTS:
                    again.append((rows, deaths + 1))
                elif rows.size > 1:
                    again += [(rows[k : k + 1], ATTEMPTS - 1) for k in range(rows.size)]
                else:
                    yield rows, None
        self._give_up()

    def _give_up(self) -> None:
        """End the processes that have something to do."""
        for worker in [w for w in self._team if w.held]:
            self._dismiss(worker)
        self._look_who_stands()

    def _heard(self, ends: dict[Any, _Process], until: float) -> list[_Process]:
        """Those that say something, or have been silent too long.

        Time for which this process was stopped itself, as with all of a terminal, is none in which
        others were silent: a round counts for no more than it may wait.
        """
        left = until - self.now() if self._since == inf else inf  # whoever stands will say when not
        ready = connection.wait(list(ends), min(BEAT, max(left, 0.0)))
        now = time.monotonic()
        passed, self._round = min(now - self._round, BEAT), now
        for end, worker in ends.items():
            worker.silent = 0.0 if end in ready else worker.silent + passed
            worker.heard |= end in ready
        return [worker for end, worker in ends.items() if end in ready or worker.is_lost]

    def _freest(self) -> _Process:
        """The worker with the least to do, a new one if all have something."""
        if len(self._team) < self.count and all(w.held for w in self._team):
            self._team.append(_Process(self._study))
        return min(self._team, key=lambda w: len(w.held))

    def _dismiss(self, worker: _Process) -> str:
        self._team.remove(worker)
        return worker.stop()

    def _count_death(self, worker: _Process) -> None:
        how = self._dismiss(worker)
        self._deaths += 1
        if not self._proven and self._deaths >= ATTEMPTS * (self.count + 1):
            raise CompassError(
                f"worker processes die before they find anything ({how}); see whether the system "
                "has killed them for their memory, and give fewer with --workers; every finished "
                "candidate is stored"
            )

    def close(self) -> None:
        """End the processes; batches on their way are dropped."""
        for worker in list(self._team):
            self._dismiss(worker)

"""The runner of a study: every stage over every candidate that gets so far, stored as it goes.

A run adds to the store what is not there yet, so the same command resumes a run that was killed,
and a finished study is read, not computed. What is found does not depend on the workers.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from math import inf
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.study.bounds import FINER, LEVELS, ends, limited_figures
from compass.study.candidates import batches, candidates, described, identities
from compass.study.clocks import best_by_errors, clock_columns
from compass.study.draws import ALL_DRAWS
from compass.study.order import bound_limits, settle
from compass.study.results import results_of
from compass.study.stages import Found
from compass.study.store import Store
from compass.study.survivors import finalists, gather, known_by, mapped, passed
from compass.study.workers import Workers

#: Candidates left out that are named.
NAMED = 5

#: Candidates a task: some 80 ms of work, to dwarf its handling, and little enough to lose.
BATCH = (
    {"screen": 500, "map": 128, "requirements": 4, "areas": 4, "orbits": 1, "entry": 96}
    | dict.fromkeys(["clocks", *LEVELS, *FINER, *ALL_DRAWS], 1)
    | {"bounds-1": 8, "draws-1": 4}
)


#: Of a run whose time is limited tasks are so many times smaller: what it has begun is lost then.
HASTE = 8


class Bar(Protocol):
    """What a progress bar can do, as tqdm's."""

    def update(self, n: int) -> Any:
        """Count n more."""


#: Makes a bar: title, total, already done.
Bars = Callable[[str, int, int], AbstractContextManager[Bar]]


@dataclass
class Summary:
    """What a run did.

    Attributes
    ----------
    candidates
        In the study (looked at so far, for an optimiser).
    reached, computed, failed
        By stage: candidates that came to it; of these computed in this run; raised an error.
    unfinished
        Candidates left out because their workers died or had too little memory; the same command
        tries them again.
    lethal
        What the first few of these are.
    seconds
        Work of this run, by stage, summed over the workers.
    bounded
        Candidates whose geometry has proven bounds, by how near these had to come.
    drawn
        Candidates of which more was drawn, by how much.
    over
        The stage in which the time was over; empty if the run came to its end.
    """

    candidates: int = 0
    reached: dict[str, int] = field(default_factory=dict)
    computed: dict[str, int] = field(default_factory=dict)
    failed: dict[str, int] = field(default_factory=dict)
    unfinished: int = 0
    lethal: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    bounded: dict[str, int] = field(default_factory=dict)
    drawn: dict[str, int] = field(default_factory=dict)
    over: str = ""

    def count(self, stage: str, computed: int, found: Found) -> None:
        """Count what came of a batch."""
        self.seconds[stage] = self.seconds.get(stage, 0.0) + found.seconds
        self.computed[stage] = self.computed.get(stage, 0) + computed
        self.failed[stage] = self.failed.get(stage, 0) + len(found.errors)

    def end(self, stage: str, reached: int) -> None:
        """Note how many have come through a stage, or to a level."""
        if stage in (*LEVELS, *FINER):
            self.bounded[stage] = reached
        elif stage in ALL_DRAWS:
            self.drawn[stage] = reached
        else:
            self.reached[stage] = reached
        self.count(stage, 0, Found({}, {}, 0.0))


class TimeOverError(Exception):
    """The time that a run may take is over; the stage in which it was."""


def run_trade(
    study: Study, store: Store, workers: Workers, bars: Bars, budget_s: float | None = None
) -> Summary:
    """Bring a study to its end: screen, map, orbits, entry; or generation by generation (NSGA-II).

    Then bounds decide the order, and the best of the front are looked at with other clocks.

    Limits on geometry are told by proven bounds, right behind the map; NSGA-II, which looks at
    many that are given up again, goes by samples until its end. Given `budget_s`, the run ends
    after so many seconds wherever it is, and uses what the default leaves of them for nearer bounds
    where the order is still open; the next run goes on from what is stored.

    Raises
    ------
    DesignError
        The study has no candidate.
    OutputError
        The store cannot be written; what it holds stays good.
    """
    until = inf if budget_s is None else workers.now() + budget_s
    run = Run(study, store, workers, bars, until)
    try:
        run.whole()
    except TimeOverError as over:
        run.summary.over = str(over)
    return run.summary


class Run:
    """A run of a study, and what it did."""

    def __init__(
        self, study: Study, store: Store, workers: Workers, bars: Bars, until: float
    ) -> None:
        self.study, self.store, self.workers, self.bars = study, store, workers, bars
        self.until, self.summary = until, Summary()

    def whole(self) -> None:
        """All that a study wants to know.

        Raises
        ------
        TimeOverError
            The time was over before.
        """
        study, store, summary = self.study, self.store, self.summary
        if study.sampling.method == "nsga2":
            from compass.study.evolve import evolve

            try:
                evolve(study, store, partial(self.stage, bars=Silent), self.bars)
            finally:
                summary.candidates = store.finished
        else:
            found = candidates(study)
            summary.candidates = len(found)
            self.stage("screen", batches(found, BATCH["screen"]), total=len(found))
            before = "screen"
            for stage in ("map", "requirements", "areas", "orbits"):
                if stage in study.stages:
                    self.stage(stage, passed(study, store, before))
                    if stage == "map" and limited_figures(study):
                        bound_limits(mapped(study, store), self.stage)
                    before = stage
            if study.entry is not None:
                self.stage("entry", finalists(study, store))
        self.settle()
        if self.until < inf:
            self.settle(takewhile(lambda _: self.workers.now() < self.until, FINER))

    def settle(self, finer: Iterable[str] = ()) -> None:
        """Tell who is of the front, and of the best of these what other clocks make of them."""
        study, store = self.study, self.store
        rows = passed(study, store, study.stages[-1])
        sorted_by = {o.figure for o in study.objectives}
        wanted = gather(store, identities(rows), sorted_by, known_by())
        rows = rows[~np.isnan(np.column_stack(list(wanted.values()))).any(axis=1)]
        sides = {end for figure in study.named for end in ends(figure)}

        def figures(some: NDArray, levels: Sequence[str]) -> dict[str, NDArray[np.float64]]:
            return gather(store, identities(some), study.named | sides, known_by(levels))

        settle(study, rows, figures, self.stage, finer)
        if clock_columns(study) and store.finished:
            some = best_by_errors(study, results_of(study, store.batches, store.path))
            self.stage("clocks", some)

    def stage(
        self,
        stage: str,
        rows: NDArray | Iterable[NDArray],
        *,
        total: int | None = None,
        bars: Bars | None = None,
    ) -> None:
        """Put candidates through a stage, but for those that the store has.

        Raises
        ------
        TimeOverError
            Some are left, and the time is over.
        """
        if isinstance(rows, np.ndarray):
            total = rows.size
            # a short stage is shared among all workers
            most = BATCH[stage] if self.until == inf else BATCH[stage] // HASTE
            size = max(1, min(most, rows.size // (2 * self.workers.count)))
            rows = [rows[k : k + size] for k in range(0, rows.size, size)]
        known = self.store.done.get(stage, set())
        missing = _Missing(rows, known, lambda: self.workers.now() >= self.until)
        with (bars or self.bars)(stage, total or 0, len(known)) as bar:
            for batch, found in self.workers.run(stage, missing, self.until):
                missing.away -= batch.size
                bar.update(self._keep(stage, batch, found))
        self.summary.end(stage, len(self.store.done.get(stage, ())))
        if missing.left:
            raise TimeOverError(stage)

    def _keep(self, stage: str, batch: NDArray, found: Found | None) -> int:
        """Store what was found of a batch and count it; return how many are stored."""
        summary = self.summary
        lost = batch if found is None else batch[list(found.left)]
        summary.unfinished += lost.size
        summary.lethal = [*summary.lethal, *map(described, lost[:NAMED])][:NAMED]
        if found is None or lost.size == batch.size:
            return 0
        batch, found = found.without_left(batch) if lost.size else (batch, found)
        self.store.add(stage, batch, found)
        summary.count(stage, batch.size, found)
        return batch.size


class _Missing:
    """Batches without the candidates that are known, as long as there is time.

    Attributes
    ----------
    away
        Candidates that were given away and have not come back.
    """

    def __init__(self, rows: Iterable[NDArray], known: set[str], over: Callable[[], bool]) -> None:
        self._rows, self._known, self._over, self.away = iter(rows), known, over, 0

    def __iter__(self) -> Iterator[NDArray]:
        return self

    def __next__(self) -> NDArray:
        if self._over():
            raise StopIteration
        batch = self._next()
        self.away += batch.size
        return batch

    def _next(self) -> NDArray:
        for batch in self._rows:
            todo = [key not in self._known for key in identities(batch)]
            if (left := batch[todo]).size:
                return left
        raise StopIteration

    @property
    def left(self) -> bool:
        """Whether the time was over before all were back."""
        if self.away:
            return True
        try:
            self._next()
        except StopIteration:
            return False
        return True


class Silent:
    """No bar."""

    def __init__(self, *_: object) -> None:
        pass

    def update(self, n: int) -> None:
        """Count nothing."""

    def __enter__(self) -> "Silent":
        return self

    def __exit__(self, *_: object) -> None:
        """End nothing."""

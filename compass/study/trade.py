"""The runner of a study: every stage over every candidate that gets so far, stored as it goes.

A run adds to the store what is not there yet, so the same command resumes a run that was killed,
and a finished study is read, not computed. What is found does not depend on the workers.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from itertools import takewhile
from math import inf
from time import monotonic
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.quantities.merits import MERITS
from compass.study.bounds import FINER, LEVELS, bound_columns, ends, limited_figures
from compass.study.candidates import ROW, batches, candidates, described, identities
from compass.study.clocks import best_by_errors, clock_columns
from compass.study.draws import ALL_DRAWS, FURTHER
from compass.study.order import bound_limits, may_hold, settle
from compass.study.pareto import best
from compass.study.results import results_of
from compass.study.stages import FINDERS, figures_of, passing
from compass.study.store import Store
from compass.study.workers import Workers

#: Candidates left out that are named.
NAMED = 5

#: Candidates a task: some 80 ms of work, to dwarf its handling, and little enough to lose.
BATCH = (
    {
        "screen": 500,
        "map": 128,
        "requirements": 4,
        "areas": 4,
        "orbits": 1,
        "entry": 96,
        "clocks": 1,
    }
    | dict.fromkeys(LEVELS, 8)
    | dict.fromkeys(ALL_DRAWS, 4)
    | dict.fromkeys(FINER, 1)
)

#: Figure of the map that tells most about a lander's bound before it is judged: over the patterns
#: of designs/study-fourfold.toml from 14 satellites on, rank correlation 0.8 with its median and
#: with its 95th percentile.
STAND_IN = "gdop_p50"


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


def run_trade(
    study: Study, store: Store, workers: Workers, bars: Bars, budget_s: float = 0.0
) -> Summary:
    """Bring a study to its end: screen, map, orbits, entry; or generation by generation (NSGA-II).

    Then bounds decide the order, and the best of the front are looked at with other clocks.

    Limits on geometry are told by proven bounds, right behind the map; NSGA-II, which looks at
    many that are given up again, goes by samples until its end. Where bounds leave the order open,
    nearer ones are looked for as long as `budget_s` lasts; the next run goes on from there.

    Raises
    ------
    DesignError
        The study has no candidate.
    OutputError
        The store cannot be written; what it holds stays good.
    """
    summary = Summary()

    def refine(level: str, rows: NDArray, until: float = inf) -> None:
        _refine(level, rows, store, workers, bars, summary, until)

    if study.sampling.method == "nsga2":
        from compass.study.evolve import evolve

        evolve(
            study,
            store,
            lambda stage, rows: _stage(stage, rows, store, workers, None, summary),
            bars,
        )
        summary.candidates = store.finished
    else:
        found = candidates(study)
        summary.candidates = len(found)
        _stage("screen", batches(found, BATCH["screen"]), store, workers, bars, summary, len(found))
        before = "screen"
        for stage in ("map", "requirements", "areas", "orbits"):
            if stage in study.stages:
                _stage(stage, passed(study, store, before), store, workers, bars, summary)
                if stage == "map" and limited_figures(study):
                    bound_limits(mapped(study, store), refine)
                before = stage
        if study.entry is not None:
            _stage("entry", finalists(study, store), store, workers, bars, summary)
    _settle(study, store, refine, budget_s)
    if clock_columns(study) and store.finished:
        some = best_by_errors(study, results_of(study, store.batches, store.path))
        _stage("clocks", some, store, workers, bars, summary)
    return summary


def _settle(
    study: Study, store: Store, refine: Callable[[str, NDArray, float], None], budget_s: float
) -> None:
    """Bring bounds of those that may be of the front as near as it takes to tell."""
    rows = passed(study, store, study.stages[-1])
    wanted = gather(store, identities(rows), {o.figure for o in study.objectives})
    rows = rows[~np.isnan(np.column_stack(list(wanted.values()))).any(axis=1)]

    sides = {end for figure in study.named for end in ends(figure)}

    def figures(some: NDArray, levels: Sequence[str]) -> dict[str, NDArray[np.float64]]:
        later = {*LEVELS, *FINER, *ALL_DRAWS} - {*levels}
        known = [stage for stage in FINDERS if stage not in later]
        return gather(store, identities(some), study.named | sides, known)

    def within(level: str, some: NDArray) -> None:
        refine(level, some, until if level in (*FINER, *FURTHER) else inf)

    until = monotonic() + budget_s
    settle(study, rows, figures, within, takewhile(lambda _: monotonic() < until, FINER))


def _refine(
    level: str,
    rows: NDArray,
    store: Store,
    workers: Workers,
    bars: Bars,
    summary: Summary,
    until: float,
) -> None:
    """Bring bounds of candidates nearer at a level, but for those whose bounds the store has."""
    own = Summary()
    _stage(level, rows, store, workers, bars, own, until=until)
    reached = summary.drawn if level in ALL_DRAWS else summary.bounded
    reached[level] = own.reached[level]
    summary.seconds[level] = summary.seconds.get(level, 0.0) + own.seconds.get(level, 0.0)
    summary.unfinished += own.unfinished
    summary.lethal = [*summary.lethal, *own.lethal][:NAMED]


def _stage(
    stage: str,
    rows: NDArray | Iterable[NDArray],
    store: Store,
    workers: Workers,
    bars: Bars | None,
    summary: Summary,
    total: int | None = None,
    until: float = inf,
) -> None:
    """Put candidates through a stage, but for those that the store has; begin none after a time."""
    if isinstance(rows, np.ndarray):
        total = rows.size
        # a short stage is shared among all workers
        size = max(1, min(BATCH[stage], rows.size // (2 * workers.count)))
        rows = [rows[k : k + size] for k in range(0, rows.size, size)]
    already = len(store.done.get(stage, ()))
    missing = takewhile(lambda _: monotonic() < until, _missing(rows, store.done.get(stage, set())))
    computed, failed = 0, 0
    with bars(stage, total or 0, already) if bars else _Silent() as bar:
        for batch, found in workers.run(stage, missing):
            lost = batch if found is None else batch[list(found.left)]
            summary.unfinished += lost.size
            summary.lethal = [*summary.lethal, *map(described, lost[:NAMED])][:NAMED]
            if lost.size == batch.size or found is None:
                continue
            batch, found = found.without_left(batch) if lost.size else (batch, found)
            store.add(stage, batch, found)
            computed += batch.size
            failed += len(found.errors)
            summary.seconds[stage] = summary.seconds.get(stage, 0.0) + found.seconds
            bar.update(batch.size)
    summary.reached[stage] = len(store.done.get(stage, ()))
    summary.computed[stage] = summary.computed.get(stage, 0) + computed
    summary.failed[stage] = summary.failed.get(stage, 0) + failed


class _Silent:
    """No bar."""

    def update(self, n: int) -> None:
        """Count nothing."""

    def __enter__(self) -> "_Silent":
        return self

    def __exit__(self, *_: object) -> None:
        """End nothing."""


def _missing(rows: Iterable[NDArray], done: set[str]) -> Iterator[NDArray]:
    """Batches without the candidates that are done."""
    for batch in rows:
        todo = [key not in done for key in identities(batch)] if done else slice(None)
        if (left := batch[todo]).size:
            yield left


def passed(study: Study, store: Store, stage: str) -> NDArray:
    """Candidates that meet every constraint up to and with this stage, in the order of rows.

    Limits on geometry break by proven bounds where there are any: who may keep them goes on.
    """
    if stage == "map" and (limited := limited_figures(study)):
        rows = mapped(study, store)
        known = gather(store, identities(rows), {*limited, *bound_columns(study)})
        return rows[may_hold([c for c in study.constraints if c.figure in limited], known)]
    return _passed(study, store, stage)


def mapped(study: Study, store: Store) -> NDArray:
    """Candidates that have been mapped, and break at most limits that proven bounds tell."""
    limited = limited_figures(study)
    others = tuple(c for c in study.constraints if c.figure not in limited)
    return _passed(replace(study, constraints=others), store, "map")


def _passed(study: Study, store: Store, stage: str) -> NDArray:
    """Candidates at a stage that meet its constraints, as it found them."""
    found = [np.empty(0, ROW)]
    for batch in store.batches[stage]:
        figures = batch.found.figures
        keep = passing(study, stage, figures)
        keep[list(batch.found.errors)] = False
        found.append(batch.rows[keep])
    return np.unique(np.concatenate(found))


def finalists(study: Study, store: Store) -> NDArray:
    """Candidates whose entries are judged: the best fronts of what is known before.

    `STAND_IN` takes the place of objectives that only entries tell.
    """
    assert study.entry is not None
    rows = passed(study, store, study.stages[study.stages.index("entry") - 1])
    if rows.size <= study.entry.finalists:
        return rows
    signs = {o.figure: o.sign for o in study.objectives if MERITS[o.figure].stage != "entry"}
    if len(signs) < len({o.figure for o in study.objectives}):
        signs.setdefault(STAND_IN, 1)
    values = gather(store, identities(rows), set(signs))
    columns = np.column_stack([sign * values[name] for name, sign in signs.items()])
    columns[np.isnan(columns)] = np.inf
    return rows[best(columns, study.entry.finalists)]


def gather(
    store: Store, keys: list[str], names: set[str], stages: Iterable[str] = FINDERS
) -> dict[str, NDArray[np.float64]]:
    """Figures of some candidates from every stage, or some of them; nan where there is none."""
    place = {key: k for k, key in enumerate(keys)}
    found = {name: np.full(len(keys), np.nan) for name in names}
    for stage in stages:
        own = names & set(figures_of(stage, store.study))
        for batch in store.batches[stage] if own else ():
            ids = identities(batch.rows)
            pairs = [(place[key], k) for k, key in enumerate(ids) if key in place]
            if pairs:
                there, here = np.array(pairs).T
                for name in own:
                    found[name][there] = batch.found.figures[name][here]
    return found

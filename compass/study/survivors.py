"""Who goes on: candidates that meet the constraints so far, and those whose entries are judged."""

from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Study
from compass.quantities.merits import MERITS
from compass.study.bounds import FINER, LEVELS, bound_columns, limited_figures
from compass.study.candidates import ROW, identities
from compass.study.draws import ALL_DRAWS
from compass.study.order import may_hold
from compass.study.pareto import best
from compass.study.stages import FINDERS, figures_of, passing
from compass.study.store import Store

#: Figure of the map that tells most about a lander's bound before it is judged: over the patterns
#: of designs/study-fourfold.toml from 14 satellites on, rank correlation 0.8 with its median and
#: with its 95th percentile.
STAND_IN = "gdop_p50"


def passed(study: Study, store: Store, stage: str) -> NDArray:
    """Candidates that meet every constraint up to and with this stage, in the order of rows.

    Limits on geometry break by proven bounds where there are any: who may keep them goes on.
    """
    if stage == "map" and (limited := limited_figures(study)):
        rows = mapped(study, store)
        names, stages = {*limited, *bound_columns(study)}, known_by(list(LEVELS)[:1])
        known = gather(store, identities(rows), names, stages)
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
    values = gather(store, identities(rows), set(signs), known_by())
    columns = np.column_stack([sign * values[name] for name, sign in signs.items()])
    columns[np.isnan(columns)] = np.inf
    return rows[best(columns, study.entry.finalists)]


def known_by(levels: Collection[str] = ()) -> list[str]:
    """Stages, and of the levels of bounds and draws some.

    What a run that was stopped has found of the others plays no role in who goes on: it ends alike.
    """
    others = {*LEVELS, *FINER, *ALL_DRAWS} - {*levels}
    return [stage for stage in FINDERS if stage not in others]


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

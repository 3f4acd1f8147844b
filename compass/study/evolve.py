"""Candidates by evolution: NSGA-II over mixed whole and real variables.

The optimiser is deterministic for a seed and sees only stored figures. A run that resumes
replays the generations from the store, at little cost, up to where it was killed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError
from compass.inputs.study import Study
from compass.quantities.merits import MERITS, STAGES
from compass.study.area_figures import area_columns
from compass.study.candidates import blocks, identities, pick
from compass.study.draw_bounds import side_columns
from compass.study.requirement_figures import requirement_columns
from compass.study.stages import passing
from compass.study.store import Store

VARIABLES = ("kind", "size", "planes", "phasing", "inclination", "radius", "mask")

#: Whole variables are drawn in so many steps of the unit interval.
STEPS = 10_000


class Known:
    """All figures in a store, of the few candidates of an optimiser; each batch is read once."""

    def __init__(self, store: Store) -> None:
        study, self._batches = store.study, store.batches
        self._taken = dict.fromkeys(store.batches, 0)
        own = area_columns(study), requirement_columns(study), side_columns(study)
        self._names = (*MERITS, *(name for columns in own for name in columns))
        self._values: dict[str, NDArray[np.float64]] = {}

    def figures(self, keys: list[str]) -> dict[str, NDArray[np.float64]]:
        """By name those of some candidates, nan where there is none; shape (n,) each."""
        self._take_in()
        unknown = np.full(len(self._names), np.nan)
        table = [self._values.get(key, unknown) for key in keys]
        return dict(zip(self._names, np.array(table).T, strict=True))

    def _take_in(self) -> None:
        """Take in what was added since."""
        names = list(self._names)
        for stage in STAGES:  # a run adds bounds and further draws at its end
            batches = self._batches.get(stage, [])
            for batch in batches[self._taken.get(stage, 0) :]:
                found = batch.found.figures
                columns = [names.index(name) for name in found]
                values = np.column_stack(list(found.values()))
                for key, row in zip(identities(batch.rows), values, strict=True):
                    self._values.setdefault(key, np.full(len(names), np.nan))[columns] = row
            self._taken[stage] = len(batches)


def evolve(
    study: Study,
    store: Store,
    stage: Callable[[str, NDArray], None],
    bars: Any,
) -> None:
    """Evolve a population of candidates for the study's objectives, under its constraints.

    A candidate that fails a stage's constraints goes no further: its violation counts the
    stages missed and then the constraints, and NSGA-II ranks it behind all that fail less.

    Parameters
    ----------
    study, store
        The study and its store.
    stage
        Puts candidates through a stage, into the store, unless they are there.
    bars
        As in `compass.study.trade.run_trade`.

    Raises
    ------
    ArgumentError
        pymoo is not installed.
    """
    try:
        from pymoo.core.mixed import MixedVariableGA
        from pymoo.core.problem import Problem
        from pymoo.core.variable import Integer, Real
        from pymoo.operators.survival.rank_and_crowding import RankAndCrowding
        from pymoo.optimize import minimize
    except ImportError as error:
        raise ArgumentError(
            "sampling.method = 'nsga2': needs pymoo; install compass-mars[pareto]"
        ) from error
    choices = blocks(study)
    population = study.sampling.population or 4
    generations = study.sampling.generations or 1
    variables: dict[str, Any] = {
        name: Integer(bounds=(0, STEPS - 1)) if k < 4 else Real(bounds=(0.0, 1.0))
        for k, name in enumerate(VARIABLES)
    }
    known = Known(store)
    with bars("generation", generations, 0) as bar:

        class _Problem(Problem):
            def __init__(self) -> None:
                super().__init__(vars=variables, n_obj=len(study.objectives), n_ieq_constr=1)

            def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
                share = np.array(
                    [
                        [(p[n] + 0.5) / STEPS if k < 4 else p[n] for k, n in enumerate(VARIABLES)]
                        for p in x
                    ]
                )
                out["F"], violation = assess(study, known, stage, pick(study, choices, share))
                out["G"] = violation[:, np.newaxis]
                bar.update(1)

        minimize(
            _Problem(),
            MixedVariableGA(pop_size=population, survival=RankAndCrowding()),
            ("n_gen", generations),
            seed=study.seed,
            verbose=False,
        )


def assess(
    study: Study, known: Known, stage: Callable[[str, NDArray], None], rows: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Objectives (to be minimised, shape (n, m)) and violations (0: none, shape (n,))."""
    stages = study.stages
    going = np.arange(rows.size)
    violation = np.zeros(rows.size)
    keys = identities(rows)
    for level, name in enumerate(stages):
        stage(name, np.unique(rows[going]))
        figures = known.figures([keys[k] for k in going])
        keep = passing(study, name, figures)
        failed = going[~keep]
        missed = [
            sum(not c.holds(float(figures[c.figure][k])) for c in study.constraints)
            for k in np.flatnonzero(~keep)
        ]
        violation[failed] = len(stages) - level + np.array(missed, dtype=float) / 100
        going = going[keep]
        if not going.size:
            break
    values = known.figures(keys)
    objectives = np.column_stack([o.sign * values[o.figure] for o in study.objectives])
    return np.where(np.isfinite(objectives), objectives, 1e12), violation

"""A run that may take so long: it ends then wherever it is, and what it left undone is done later.

Reached among the candidates of a stage and within one, in maps, proofs, draws and entries.
"""

import time
from dataclasses import replace

import numpy as np
import pytest

from compass.api.trade import TradeResult
from compass.core.compiling import compiling
from compass.inputs.study import Constraint, Objective
from compass.quantities.merits import STAGES
from compass.study import stages, trade, workers
from compass.study.bounds import FINER, LEVELS, ends
from compass.study.candidates import candidates
from compass.study.draws import DRAWS
from compass.study.results import read_results, still_waiting
from compass.study.store import Store
from compass.study.trade import run_trade
from compass.study.workers import Processes
from tests.one_process import OneProcess
from tests.study.test_trade import Bars

GEOMETRY, ENTRIES = "gdop_p95", "crlb_position_m.p95"

#: How far apart bounds are at each level.
WIDTHS = {"entry": 0.4, "draws-1": 0.2, "draws-2": 0.02, "draws-3": 0.01} | {
    "bounds-1": 0.4, "bounds-2": 0.05, "bounds-3": 0.01, "bounds-4": 1e-3, "bounds-5": 1e-6,
}  # fmt: skip


@pytest.fixture
def study(tiny, monkeypatch):
    """Sort by size, geometry and entries, whose bounds are made up, level by level."""
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)
    monkeypatch.setattr("compass.study.order.DRAWS", DRAWS)
    monkeypatch.setattr(trade, "BATCH", dict.fromkeys(stages.FINDERS, 2))

    def found(level, study, rows):
        columns = {name: np.full(rows.size, np.nan) for name in stages.figures_of(level, study)}
        figure = GEOMETRY if level in (*LEVELS, *FINER) else ENTRIES
        middle = 3.0 + 1e-3 * rows["inclination_deg"] + 0.03 * (rows["phasing"] % 2)
        if figure in columns:
            columns[figure] = middle
        for end, side in zip(ends(figure), (-0.5, 0.5), strict=True):
            columns[end] = middle + side * WIDTHS[level]
        return columns

    for level in WIDTHS:
        monkeypatch.setitem(
            stages.FINDERS, level, lambda study, rows, level=level: found(level, study, rows)
        )
    made = tiny(entry=True)
    return replace(
        made,
        objectives=tuple(Objective(name, 1) for name in ("satellites", GEOMETRY, ENTRIES)),
        constraints=(*made.constraints, Constraint(GEOMETRY, -np.inf, 5.0, False)),
        entry=replace(made.entry, finalists=100),
    )


class Clock:
    """A clock that stands until it is put beyond all budgets."""

    now = 0.0

    def __call__(self):
        return self.now


class OutOfTime(OneProcess):
    """Begins a second batch of a stage, in the midst of which the time is over."""

    def __init__(self, study, stage, clock):
        super().__init__(study)
        self._stage, self._clock = stage, clock

    def run(self, stage, some, until):
        for k, rows in enumerate(some):
            if stage == self._stage and k == 1:
                self._clock.now = np.inf
                return
            yield from super().run(stage, [rows], until)


def run(study, folder, team=None, budget_s=None):
    with Store(folder, study) as store:
        return run_trade(study, store, team or OneProcess(study), Bars(), budget_s)


@pytest.mark.parametrize(
    "stage", ["screen", "map", "bounds-1", "entry", "draws-1", "bounds-2", "draws-2", "bounds-4"]
)
def test_wherever_the_time_is_over_the_next_run_ends_as_one_that_was_not_stopped(
    study, tmp_path, monkeypatch, stage
):
    clock = Clock()
    monkeypatch.setattr(OneProcess, "now", lambda self: clock())
    whole = run(study, tmp_path / "whole", budget_s=1.0)
    assert not whole.over and {"bounds-5", "draws-2"} <= {*whole.bounded, *whole.drawn}
    once = run(study, tmp_path / "stopped", OutOfTime(study, stage, clock), budget_s=1.0)
    assert once.over == stage
    assert 0 < once.computed[stage] < whole.computed[stage]
    results = read_results(study, tmp_path / "stopped")
    first = results.front.values == 0
    early = stage in ("screen", "map", "bounds-1", "entry")
    assert (results.attrs["waiting"] > 0) == early
    assert first.any() == (stage not in ("screen", "map", "bounds-1"))
    decided = results.decided.values[first]
    assert not (decided.any() if early else decided.all())
    result = TradeResult(study, tmp_path / "stopped", once, results)
    assert f"the time allowed was over during stage {stage}" in str(result)
    assert result.to_dict()["over"] == stage
    assert result.holds == (bool(result.front) and not early)
    clock.now = 0.0
    again = run(study, tmp_path / "stopped", budget_s=1.0)
    assert not again.over
    total = {name: once.computed.get(name, 0) + n for name, n in again.computed.items()}
    assert total == whole.computed  # nothing is found twice but what had been given up
    pair = [read_results(study, tmp_path / name).drop_attrs() for name in ("whole", "stopped")]
    assert pair[0].identical(pair[1])


class UntilLarger(OneProcess):
    """Has no time any more when a level comes to patterns of more than five satellites."""

    def __init__(self, study, clock):
        super().__init__(study)
        self._clock = clock

    def run(self, stage, some, until):
        for rows in some:
            if stage == "bounds-2" and rows["satellites"].max() > 5:
                self._clock.now = np.inf
                return
            yield from super().run(stage, [rows], until)


def test_whom_a_level_has_put_out_before_a_stop_is_a_rival_until_then_all_the_same(
    tiny, tmp_path, monkeypatch
):
    """Whoever it might have beaten is looked into, stopped in between or not."""
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)
    monkeypatch.setattr(trade, "BATCH", dict.fromkeys(stages.FINDERS, 1))
    # what bounds leave open of five satellites: the most of their share, and the dilution's width
    vague = {"bounds-1": (0.95, 100.0), "bounds-2": (0.85, 1.0), "bounds-3": (0.85, 1.0)}

    def found(level, study, rows):
        doubted = rows["satellites"] == 5
        columns = {name: np.full(rows.size, np.nan) for name in stages.figures_of(level, study)}
        columns["availability_low"] = np.where(doubted, 0.8, 0.95)
        columns["availability_high"] = np.where(doubted, vague[level][0], 0.97)
        middle = 3.0 + rows["phasing"] + 10.0 * rows["planes"] + 0.1 * rows["inclination_deg"]
        for end, side in zip(ends(GEOMETRY), (-0.5, 0.5), strict=True):
            columns[end] = middle + side * np.where(doubted, vague[level][1], WIDTHS[level] / 4.0)
        return columns

    for level in vague:
        monkeypatch.setitem(
            stages.FINDERS, level, lambda study, rows, level=level: found(level, study, rows)
        )
    made = tiny()
    share = Constraint("availability", 0.9, np.inf, False)
    study = replace(
        made,
        objectives=tuple(Objective(name, 1) for name in (GEOMETRY, "satellites")),
        constraints=(*made.constraints, share),
    )
    clock = Clock()
    monkeypatch.setattr(OneProcess, "now", lambda self: clock())
    whole = run(study, tmp_path / "whole", budget_s=1.0)
    once = run(study, tmp_path / "stopped", UntilLarger(study, clock), budget_s=1.0)
    assert once.over == "bounds-2" and 0 < once.computed["bounds-2"] < whole.bounded["bounds-2"]
    clock.now = 0.0
    run(study, tmp_path / "stopped", budget_s=1.0)
    pair = [read_results(study, tmp_path / name).drop_attrs() for name in ("whole", "stopped")]
    assert pair[0].identical(pair[1])


def test_a_finalist_that_later_bounds_put_out_was_looked_at_all_the_same(tiny):
    made = tiny(entry=True)
    limits = (*made.constraints, Constraint(GEOMETRY, -np.inf, 5.0, False))
    study = replace(made, constraints=limits, entry=replace(made.entry, finalists=3))
    count = len(candidates(study))
    figures = {c.figure: np.ones(count) for c in limits}
    figures |= {end: np.ones(count) for end in ends(GEOMETRY)}
    stage, fine = np.full(count, STAGES.index("map"), "i1"), np.ones(count, bool)
    stage[:2] = STAGES.index("entry")
    assert still_waiting(study, figures, stage, fine) == 1
    stage[2] = STAGES.index("entry")
    for end in ends(GEOMETRY):
        figures[end][0] = 6.0
    assert still_waiting(study, figures, stage, fine) == 0


def test_a_process_is_ended_in_the_midst_of_a_candidate(tiny, monkeypatch):
    monkeypatch.setattr(workers, "_serve", serve_endlessly)
    rows = candidates(tiny()).rows(0, 6)
    team = Processes(tiny(), 2)
    try:
        began = team.now()
        some = [rows[k : k + 1] for k in range(6)]
        found = list(team.run("screen", some, began + 4.0))
        assert 4.0 <= team.now() - began < 6.0
        assert all(batch["phasing"] % 2 == 0 for batch, _ in found)
        assert not any(worker.held for worker in team._team)
    finally:
        team.close()


def serve_endlessly(end, study, beat):
    """As a worker that is never done with patterns of odd phasing."""
    honest = workers.evaluate

    def slowly(stage, study, rows):
        time.sleep(1e3 * (rows["phasing"][0] % 2))
        return honest(stage, study, rows)

    workers.evaluate = slowly
    workers._serve(end, study, beat)


def test_no_time_of_a_run_is_spent_on_loading_and_compiling(tiny, monkeypatch):
    monkeypatch.setattr(workers, "_serve", serve_after_compiling)
    rows = candidates(tiny()).rows(0, 3)
    team = Processes(tiny(), 1)
    try:
        began, until = time.monotonic(), team.now() + 0.8
        found = list(team.run("screen", [rows[k : k + 1] for k in range(3)], until))
        assert len(found) == 3 and time.monotonic() - began > 3.0
    finally:
        team.close()


def serve_after_compiling(end, study, beat):
    """As a worker that compiles anew for each candidate."""
    honest = workers.evaluate

    def compiled(stage, study, rows):
        with compiling():
            time.sleep(1.0)
        return honest(stage, study, rows)

    workers.evaluate = compiled
    workers._serve(end, study, beat)


def test_tasks_of_a_run_that_may_end_anywhere_are_small(tiny, tmp_path):
    """Else runs of a few seconds would begin the same candidates again and again."""
    study, sizes = tiny(), {}

    class Sees(OneProcess):
        def run(self, stage, some, until):
            for rows in some:
                sizes.setdefault(until < np.inf, []).append(rows.size)
                yield from super().run(stage, [rows], until)

    for name, budget_s in (("a", None), ("b", 1e6)):
        with Store(tmp_path / name, study) as store, pytest.MonkeyPatch.context() as patch:
            patch.setitem(trade.BATCH, "map", 8)
            run_trade(study, store, Sees(study), Bars(), budget_s)
    assert max(sizes[False][1:]) == 8 and max(sizes[True][1:]) == 1

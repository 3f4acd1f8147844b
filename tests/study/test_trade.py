"""The runner: the same numbers whoever works, resumed or not; what raises, dies or is evolved."""

import contextlib
import os
import resource
import signal
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from compass.errors import CompassError
from compass.inputs.study import Objective
from compass.quantities.merits import MERITS
from compass.study import stages, survivors, trade, workers
from compass.study import store as store_module
from compass.study.candidates import candidates, identities
from compass.study.choice import finalists_of
from compass.study.evolve import Known, assess
from compass.study.results import read_results
from compass.study.store import Store
from compass.study.survivors import finalists, gather, passed
from compass.study.trade import run_trade
from compass.study.workers import Processes
from tests.one_process import OneProcess


class Bars:
    """Counts what bars are told."""

    def __init__(self):
        self.told = []

    def __call__(self, title, total, already):
        self.told.append([title, total, already, 0])
        return contextlib.nullcontext(self)

    def update(self, n):
        self.told[-1][3] += n


def run(study, folder, team=None, bars=None):
    with Store(folder, study) as store:
        return run_trade(study, store, team or OneProcess(study), bars or Bars())


def test_every_stage_over_what_gets_so_far(tiny, tmp_path, monkeypatch):
    monkeypatch.setitem(trade.BATCH, "screen", 7)
    study, bars = tiny(entry=True), Bars()
    summary = run(study, tmp_path, bars=bars)
    results = read_results(study, tmp_path)
    proven = int((results.fold_proven == 1).sum())
    assert 3 < proven < 52
    assert summary.candidates == 52
    assert summary.reached == summary.computed == {"screen": 52, "map": proven, "entry": 3}
    assert summary.failed == {"screen": 0, "map": 0, "entry": 0} and summary.unfinished == 0
    assert bars.told == [["screen", 52, 0, 52], ["map", proven, 0, proven], ["entry", 3, 0, 3]]
    judged = results.isel(candidate=np.flatnonzero(results.stage == "entry"))
    assert np.isfinite(judged["crlb_position_m.p95"]).all()
    again = run(study, tmp_path)
    assert again.computed == {"screen": 0, "map": 0, "entry": 0}
    assert read_results(study, tmp_path).identical(results)


def test_finalists_are_the_best_fronts(tiny, tmp_path):
    study = tiny(entry=True)
    run(study, tmp_path)
    results = read_results(study, tmp_path)
    with Store(tmp_path, study) as store:
        keys = set(identities(finalists(study, store)))
        assert len(passed(study, store, "map")) == int(results.feasible.sum())
    front = set(results.identity.values[results.front.values == 0])
    assert len(keys) == 3 and (keys <= front or front <= keys)


def test_a_constraint_on_entries_is_met_by_none_that_was_not_judged(tiny, tmp_path):
    study = tiny('[[constraint]]\nfigure = "crlb_position_m.p95"\nat_least = 0', entry=True)
    run(study, tmp_path)
    results = read_results(study, tmp_path)
    assert int(results.feasible.sum()) == 3
    assert set(results.stage.values[results.feasible]) == {"entry"}
    assert not (results.front.values[results.stage.values != "entry"] >= 0).any()


def test_geometry_stands_in_for_what_only_entries_tell(tiny, monkeypatch):
    study = replace(tiny(entry=True), objectives=(Objective("crlb_position_m.p95", 1),))
    rows = candidates(study).rows(0, 52)
    gdop = np.random.default_rng(0).permutation(52).astype(float)
    monkeypatch.setattr(survivors, "passed", lambda *_: rows)
    monkeypatch.setattr(
        survivors, "gather", lambda _store, _keys, names, _stages: dict.fromkeys(names, gdop)
    )
    assert set(identities(finalists(study, None))) == set(identities(rows[gdop < 3]))
    both = replace(study, objectives=(*study.objectives, Objective("satellites", 1)))
    few = np.where(rows["satellites"] == 5, 1.0, 2.0)
    values = {"satellites": few, "gdop_p50": np.where(gdop == 7, 0.0, 1.0)}
    monkeypatch.setattr(survivors, "gather", lambda *_: values)
    assert identities(rows[gdop == 7])[0] in identities(finalists(both, None))


def test_two_processes_find_the_same(tiny, tmp_path, monkeypatch):
    monkeypatch.setitem(trade.BATCH, "screen", 5)
    study = tiny()
    run(study, tmp_path / "one")
    script = tmp_path / "student.py"  # of the caller, which no worker is to run again
    script.write_text("raise SystemExit(9)")
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None)
    monkeypatch.setattr(sys.modules["__main__"], "__file__", str(script), raising=False)
    team = Processes(study, 2)
    try:
        run(study, tmp_path / "two", team)
    finally:
        team.close()
    one, two = (read_results(study, tmp_path / name) for name in ("one", "two"))
    assert one.identical(two)


def test_only_a_few_batches_are_on_their_way(tiny):
    study = tiny()
    taken = 0

    def source():
        nonlocal taken
        for rows in [candidates(study).rows(k, k + 2) for k in range(0, 40, 2)]:
            taken += 1
            yield rows

    team = Processes(study, 2)
    try:
        for count, (rows, found) in enumerate(team.run("screen", source()), start=1):
            assert rows.size == 2 and not found.errors
            # what a kill could lose: one batch a worker, one waiting, and those finished with it
            assert taken - count < 2 * (team.count + 1)
    finally:
        team.close()
    assert taken == count == 20


def serve_lethally(end, study, beat):
    """As a worker that dies of seven planes."""
    honest = workers.evaluate

    def evaluate(stage, study, rows):
        if 7 in rows["planes"]:
            os._exit(9)
        return honest(stage, study, rows)

    workers.evaluate = evaluate
    workers._serve(end, study, beat)


@pytest.fixture
def lethal(monkeypatch):
    monkeypatch.setattr(workers, "_serve", serve_lethally)
    monkeypatch.setattr(workers, "ATTEMPTS", 2)


def test_only_the_candidate_that_kills_its_workers_is_left_out(tiny, lethal):
    study = tiny()
    rows = candidates(study).rows(0, 52)
    bad, good = rows[rows["planes"] == 7][:1], rows[rows["planes"] == 1]
    team = Processes(study, 1)
    try:
        found = list(team.run("screen", [good, np.concatenate([good[:2], bad, good[2:]]), good]))
        (lost,) = [batch for batch, what in found if what is None]
        assert np.array_equal(lost, bad)
        # its mates were found one by one, the batches around it at the first go
        assert sorted(batch.size for batch, _ in found) == [1] * (good.size + 1) + [good.size] * 2
    finally:
        team.close()


def test_a_worker_that_stands_still_is_replaced(tiny, monkeypatch):
    """Stopped, not dead: it answers nothing, and nothing says so."""
    monkeypatch.setattr(workers, "BEAT", 0.2)
    monkeypatch.setattr(workers, "SILENCE", 2.0)
    study = tiny()
    rows = candidates(study).rows(0, 52)
    team = Processes(study, 1)
    try:
        work = team.run("screen", [rows[:26], rows[26:39], rows[39:]])
        found = [next(work)]
        pid = team._team[0]._process.pid
        os.kill(pid, signal.SIGSTOP)
        found += work
        assert team._team[0]._process.pid != pid and all(what for _, what in found)
        assert np.array_equal(np.sort(np.concatenate([r for r, _ in found])), np.sort(rows))
    finally:
        team.close()


def test_a_worker_with_much_to_do_is_waited_for(tiny, monkeypatch):
    """Its signs come beside its work."""
    monkeypatch.setattr(workers, "BEAT", 0.1)
    monkeypatch.setattr(workers, "SILENCE", 2.0)
    monkeypatch.setattr(workers, "_serve", serve_slowly)
    team = Processes(tiny(), 1)
    try:
        found = list(team.run("screen", [candidates(tiny()).rows(0, k) for k in (1, 2)]))
        assert len(found) == 2 and all(what for _, what in found) and team._deaths == 0
    finally:
        team.close()


def serve_slowly(end, study, beat):
    """As a worker that takes 4 s for everything."""
    honest = workers.evaluate
    workers.evaluate = lambda *arguments: time.sleep(4) or honest(*arguments)
    workers._serve(end, study, beat)


def test_a_candidate_for_which_memory_ran_out_is_tried_again(tiny, tmp_path, monkeypatch):
    honest = stages.FINDERS["screen"]

    def hungry(study, rows):
        if 7 in rows["planes"]:
            raise MemoryError
        if 6 in rows["planes"]:
            raise RuntimeError("six")
        return honest(study, rows)

    study = tiny()
    monkeypatch.setitem(stages.FINDERS, "screen", hungry)
    summary = run(study, tmp_path)
    assert summary.unfinished == 14 and len(summary.lethal) == trade.NAMED
    assert summary.computed["screen"] == 52 - 14 and summary.failed["screen"] == 12
    assert set(read_results(study, tmp_path).planes.values) == {1, 2, 3, 5, 6}
    monkeypatch.setitem(stages.FINDERS, "screen", honest)
    again = run(study, tmp_path)
    assert again.computed["screen"] == 14 and again.unfinished == 0
    results = read_results(study, tmp_path)
    assert set(results.planes.values[results.error == "RuntimeError: six"]) == {6}


def test_workers_that_only_die_end_the_run(tiny, lethal):
    study = tiny()
    rows = candidates(study).rows(0, 52)
    bad = rows[rows["planes"] == 7]
    team = Processes(study, 1)
    try:
        with pytest.raises(CompassError, match=r"die before they find anything \(exit status 9\)"):
            list(team.run("screen", [bad, bad]))
    finally:
        team.close()


def test_too_many_processes_are_refused(tiny):
    study = tiny()
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    team = Processes(study, 500)
    rows = candidates(study).rows(0, 52)
    try:
        resource.setrlimit(
            resource.RLIMIT_NOFILE, (len(os.listdir("/proc/self/fd")) + 4, before[1])
        )
        with pytest.raises(CompassError, match="cannot be started: Too many open files; give few"):
            list(team.run("screen", [rows[k : k + 1] for k in range(52)]))
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
        team.close()


def test_what_raises_is_recorded_and_the_rest_goes_on(tiny, tmp_path, monkeypatch):
    study, honest = tiny(), stages.FINDERS["map"]

    def flawed(study, rows):
        if 5 in rows["planes"]:
            raise RuntimeError("five planes")
        return honest(study, rows)

    monkeypatch.setitem(stages.FINDERS, "map", flawed)
    summary = run(study, tmp_path)
    results = read_results(study, tmp_path)
    bad = results.error == "RuntimeError: five planes"
    assert summary.failed["map"] == int(bad.sum()) > 0
    assert set(results.planes.values[bad]) == {5} and not results.feasible.values[bad].any()
    assert run(study, tmp_path).computed["map"] == 0  # recorded, not tried for ever


def test_lost_batches_are_counted_and_tried_again(tiny, tmp_path):
    study = tiny()

    class Loses(OneProcess):
        def run(self, stage, batches, until):
            for k, (rows, found) in enumerate(super().run(stage, batches, until)):
                yield rows, None if stage == "map" and k == 0 else found

    summary = run(study, tmp_path, Loses(study))
    assert summary.unfinished > 0
    again = run(study, tmp_path)
    assert again.unfinished == 0 and again.computed["map"] == summary.unfinished


EVOLVE = 'seed = 2\n[sampling]\nmethod = "nsga2"\npopulation = 12\ngenerations = 8'


@pytest.mark.filterwarnings("ignore::DeprecationWarning:pymoo.*")
def test_evolution_finds_the_front_and_resumes(tiny, tmp_path):
    pytest.importorskip("pymoo")
    study = tiny(EVOLVE)
    summary = run(study, tmp_path)
    results = read_results(study, tmp_path)
    assert 12 <= summary.candidates == results.sizes["candidate"] <= 52
    assert results.feasible.any()
    # the smallest there is, known from the full grid
    grid = tiny()
    run(grid, tmp_path / "grid")
    whole = read_results(grid, tmp_path / "grid")
    best = int(whole.satellites.values[whole.feasible.values].min())
    assert int(results.satellites.values[results.feasible.values].min()) == best
    again = run(study, tmp_path)
    assert again.computed["screen"] == 0 and again.candidates == summary.candidates
    assert read_results(study, tmp_path).identical(results)


def test_violations_count_stages_then_constraints(tiny, tmp_path):
    study = tiny()
    rows = candidates(study).rows(0, 52)
    with Store(tmp_path, study) as store:
        going = trade.Run(study, store, OneProcess(study), Bars(), np.inf)
        values, violation = assess(study, Known(store), going.stage, rows)
        proven = np.isin(identities(rows), identities(passed(study, store, "screen")))
    assert np.array_equal(violation == 0, proven)
    assert np.all(violation[~proven] == 2.01)  # two stages missed, one constraint not met
    assert np.array_equal(values[:, 0], rows["satellites"])


def test_what_is_known_is_read_once(tiny, tmp_path, monkeypatch):
    study = tiny()
    rows, read = candidates(study).rows(0, 52), []
    honest = store_module.batch_of
    monkeypatch.setattr(store_module, "batch_of", lambda *a: read.append(1) or honest(*a))
    with Store(tmp_path, study) as store:
        known = Known(store)
        assert np.isnan(known.figures(identities(rows))["fold_proven"]).all()
        for part in (rows[:5], rows[5:]):
            store.add("screen", part, stages.evaluate("screen", study, part))
            figures = known.figures(identities(rows))
        mapped = stages.evaluate("map", study, rows[:7])
        store.add("map", rows[:7], mapped)
        both = known.figures(identities(rows))
        assert not read  # what a run adds it knows
    with Store(tmp_path, study) as store:
        again = Known(store).figures(identities(rows))
        everything = gather(store, identities(rows), set(MERITS))
        assert len(read) == 3
    assert all(np.array_equal(both[n], again[n], equal_nan=True) for n in MERITS)
    assert np.array_equal(both["satellites"], rows["satellites"])
    assert np.isnan(figures["gdop_p50"]).all()
    assert all(np.array_equal(both[n], everything[n], equal_nan=True) for n in MERITS)


def test_finalists_and_yardstick(tiny, tmp_path):
    study = tiny(entry=True)
    run(study, tmp_path)
    results = read_results(study, tmp_path)
    chosen = finalists_of(study, results)
    assert chosen[0].role.startswith("balanced")
    roles = "; ".join(f.role for f in chosen)
    assert "smallest number of satellites" in roles and "largest highest mask" in roles
    small = next(f for f in chosen if "smallest number" in f.role)
    front = results.isel(candidate=np.flatnonzero(results.front == 0))
    assert small.figures["satellites"] == front.satellites.min()

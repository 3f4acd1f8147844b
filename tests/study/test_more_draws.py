"""More draws where draws alone tell: the earlier ones again and more, only of whom is open."""

from dataclasses import replace

import numpy as np
import pytest

from compass.api.trade import TradeResult
from compass.inputs.study import Objective
from compass.study import stages
from compass.study.bounds import ends
from compass.study.candidates import batches, candidates, make_constellation
from compass.study.draws import DRAWS, drawn_columns, more_draws
from compass.study.pareto import fronts
from compass.study.pattern_judging import entries_of, entry_figures, judged
from compass.study.results import first_front, read_results
from compass.study.store import Store
from compass.study.trade import run_trade
from tests.one_process import OneProcess
from tests.study.test_trade import Bars

FIGURE = "crlb_position_m.p95"

#: How far apart bounds are at each level.
WIDTHS = {"entry": 0.4, "draws-1": 0.2, "draws-2": 0.02, "draws-3": 0.01}


@pytest.fixture
def study(tiny):
    """Sort by size and what landers know of their place."""
    found = tiny(entry=True)
    return replace(
        found,
        objectives=(Objective("satellites", 1), Objective(FIGURE, 1)),
        entry=replace(found.entry, finalists=100),
    )


@pytest.fixture
def asked(monkeypatch):
    """Let each stage find bounds about a value that candidates have; give what it was asked of."""
    calls = []
    monkeypatch.setattr("compass.study.order.DRAWS", DRAWS)

    def found(level, study, rows):
        calls.append((level, rows.size))
        columns = {name: np.full(rows.size, np.nan) for name in stages.figures_of(level, study)}
        low, high = ends(FIGURE)
        columns[FIGURE] = 10.0 + 1e-2 * rows["inclination_deg"] + 0.3 * (rows["phasing"] % 2)
        columns[low] = columns[FIGURE] - 0.5 * WIDTHS[level]
        columns[high] = columns[FIGURE] + 0.5 * WIDTHS[level]
        return columns

    for level in WIDTHS:
        monkeypatch.setitem(
            stages.FINDERS, level, lambda study, rows, level=level: found(level, study, rows)
        )
    return calls


class StoppedError(Exception):
    """The run was stopped."""


class Stopping(OneProcess):
    """Stops in the midst of a level."""

    def run(self, stage, some, until):
        for k, rows in enumerate(some):
            if stage == "draws-2" and k:
                raise StoppedError
            yield from super().run(stage, [rows], until)


def run(study, folder, team=None):
    with Store(folder, study) as store:
        return run_trade(study, store, team or OneProcess(study), Bars())


def counts(asked):
    return [sum(n for name, n in asked if name == level) for level in WIDTHS]


def test_only_of_whom_is_open_more_is_drawn_and_what_stays_so_is_said(study, tmp_path, asked):
    summary = run(study, tmp_path)
    results = read_results(study, tmp_path)
    judged, *drawn = counts(asked)
    assert judged == int(results.feasible.sum()) > drawn[0] > drawn[1] >= drawn[2] > 0
    assert list(summary.drawn.values()) == drawn
    front = first_front(study, results)
    for row in front:
        low, high = row[f"{FIGURE}_interval"]
        assert low < row[FIGURE] < high
    of_them = results.isel(candidate=np.flatnonzero(results.feasible.values))
    first = fronts(np.column_stack([of_them.satellites.values, of_them[FIGURE].values])) == 0
    shown, decided = of_them.front.values == 0, of_them.decided.values
    assert np.all(shown[first]) and np.array_equal(first[decided], shown[decided])
    # what has one value with another no draws tell apart
    undecided = int((shown & ~decided).sum())
    assert 1 < undecided == sum(not row["decided"] for row in front)
    result = TradeResult(study, tmp_path, summary, results)
    assert f"of {undecided} it is not decided within the budget" in str(result)
    assert f"more was drawn of {drawn[0]} (to 16 entries), then of" in " ".join(str(result).split())
    assert result.to_dict()["evidence"][FIGURE] == "bounds that hold in 95 of 100 cases"
    assert not result.to_dict()["rests_on_samples"]


def test_a_run_that_is_stopped_and_goes_on_ends_as_one_that_is_not(
    study, tmp_path, asked, monkeypatch
):
    monkeypatch.setattr("compass.study.trade.BATCH", dict.fromkeys(stages.FINDERS, 2))
    run(study, tmp_path / "whole")
    once = counts(asked)
    asked.clear()
    with pytest.raises(StoppedError):
        run(study, tmp_path / "stopped", Stopping(study))
    run(study, tmp_path / "stopped")
    assert counts(asked) == once
    pair = [read_results(study, tmp_path / name).drop_attrs() for name in ("whole", "stopped")]
    assert pair[0].identical(pair[1])


def test_entries_of_a_level_begin_with_those_judged_before(study):
    more = replace(study, entry=replace(study.entry, samples=4 * study.entry.samples))
    few, many = entries_of(study), entries_of(more)
    part = slice(few.size)
    assert many.size == 4 * few.size
    assert np.array_equal(many.paths[part], few.paths)
    assert np.array_equal(many.arrivals.phase[part], few.arrivals.phase)


def test_more_draws_are_what_the_stage_finds_of_so_many_entries(study):
    rows = next(batches(candidates(study), 2))
    more = replace(study, entry=replace(study.entry, samples=4 * study.entry.samples))
    found, own = more_draws("draws-1", study, rows), entry_figures(more, rows)
    assert set(found) == set(drawn_columns(study)) == {FIGURE, *ends(FIGURE)}
    for name, values in found.items():
        assert np.array_equal(values, own[name])
    low, high = (found[end] for end in ends(FIGURE))
    assert np.all(low <= found[FIGURE]) and np.all(found[FIGURE] <= high)


def test_the_median_in_view_lies_between_bounds_the_same_by_either_kernel(study):
    """Of so few entries nearly all that is possible; of more, nearer."""
    name = "in_view.median"
    study = replace(study, objectives=(Objective("satellites", 1), Objective(name, -1)))
    rows = next(batches(candidates(study), 2))
    found, more = entry_figures(study, rows), more_draws("draws-1", study, rows)
    assert set(more) == {name, *ends(name)}
    low, high = (found[end] for end in ends(name))
    assert np.all((low <= found[name]) & (found[name] <= high))
    assert np.all(more[ends(name)[1]] - more[ends(name)[0]] < high - low)
    for k, row in enumerate(rows):
        one = judged(study, entries_of(study), make_constellation(row), float(row["mask_deg"]))
        assert [one[end] for end in ends(name)] == [low[k], high[k]]

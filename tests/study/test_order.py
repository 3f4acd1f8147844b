"""Order by brackets: against the definition, refined where open, the same whoever works."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from compass.api.trade import TradeResult
from compass.inputs.study import Constraint, Objective
from compass.study import stages, trade
from compass.study.bounds import (
    BESIDE,
    BOUNDED,
    FINER,
    LEVELS,
    bound_columns,
    bounds,
    bracketed_figures,
    ends,
)
from compass.study.candidates import ROW
from compass.study.choice import rows_in
from compass.study.order import may_beat, order_of
from compass.study.pareto import fronts
from compass.study.results import first_front, read_results
from compass.study.store import Store
from compass.study.trade import run_trade
from compass.study.workers import Processes
from tests.one_process import OneProcess
from tests.study.test_trade import Bars

brackets = st.integers(1, 3).flatmap(
    lambda m: arrays(
        float, st.tuples(st.just(2), st.integers(1, 12), st.just(m)), elements=st.integers(0, 5)
    )
)


@given(brackets, st.integers(0, 2**32 - 1))
def test_wherever_in_brackets_the_values_lie_what_is_decided_holds(ends_of, seed):
    low, high = np.sort(ends_of, axis=0)
    surely = fronts(low, high)
    sure_of_front = ~may_beat(low, high).any(axis=0)
    generator = np.random.default_rng(seed)
    for _ in range(5):
        share = generator.choice([0.0, 1.0, 0.3], size=low.shape)
        front = fronts(low + share * (high - low))
        assert np.all(front[sure_of_front] == 0)
        assert np.all(front[surely > 0] > 0)
    same = fronts(low, low)
    assert np.array_equal(same, fronts(low))
    assert np.array_equal(~may_beat(low, low).any(axis=0), same == 0)


def study_of(tiny, figure="gdop_p95", goal=1, limit=np.inf):
    """A study that sorts by size and one figure of geometry."""
    objectives = (Objective("satellites", 1), Objective(figure, goal))
    limits = (Constraint(figure, -np.inf, limit, False),) if limit < np.inf else ()
    return replace(tiny(), objectives=objectives, constraints=tiny().constraints + limits)


def figures(study, low, high):
    """Columns of three candidates of one size, all of whose other constraints are met."""
    names = study.named | {"satellites"}
    known = {name: np.ones(len(low)) for name in names}
    return known | dict(zip(ends("gdop_p95"), (np.array(low), np.array(high)), strict=True))


def test_what_straddles_a_limit_is_not_counted_and_looked_into(tiny):
    study = study_of(tiny, limit=3.0)
    found = order_of(study, figures(study, [2.0, 2.5, 3.5], [2.2, 3.5, 4.0]), np.ones(3, bool))
    assert found.feasible.tolist() == [True, False, False]
    assert found.straddling.tolist() == found.open.tolist() == [False, True, False]
    assert found.front.tolist() == [0, -1, -1]
    assert found.decided.tolist() == [True, False, True]


@pytest.mark.parametrize(("rival", "sure"), [((2.0, 2.2), False), ((2.9, 3.1), True)])
def test_none_is_surely_of_the_front_while_one_that_would_beat_it_may_keep_a_limit(
    tiny, rival, sure
):
    study = study_of(tiny)
    share = Constraint("availability", 0.9, np.inf, False)
    study = replace(study, constraints=(*study.constraints, share))
    known = figures(study, [2.6, rival[0]], [2.8, rival[1]])
    known |= dict(zip(ends("availability"), np.array([[0.92, 0.8], [0.95, 0.95]]), strict=True))
    found = order_of(study, known, np.ones(2, bool))
    assert found.front.tolist() == [0, -1]
    assert found.straddling.tolist() == [False, True]
    assert found.decided.tolist() == [sure, False]
    assert found.open.tolist() == [not sure, True]


def test_a_larger_share_is_better(tiny):
    study = study_of(tiny, "availability", -1)
    known = {name: np.ones(2) for name in study.named}
    known |= dict(
        zip(ends("availability"), (np.array([0.8, 0.5]), np.array([0.9, 0.6])), strict=True)
    )
    found = order_of(study, known, np.ones(2, bool))
    assert found.front.tolist() == [0, 1]
    assert found.decided.all() and not found.open.any()


def run(study, folder, batch=4, budget_s=None):
    with Store(folder, study) as store, pytest.MonkeyPatch.context() as patch:
        patch.setitem(trade.BATCH, "bounds-1", batch)
        return run_trade(study, store, OneProcess(study), Bars(), budget_s)


def test_only_what_is_open_is_brought_nearer(tiny, tmp_path, monkeypatch):
    """Brackets about 3 whose width a level cuts to a hundredth; one size beats all larger ones."""
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)
    asked = []

    def bracketed(level, study, rows):
        asked.append((level, rows.size))
        width = {"bounds-1": 0.3, "bounds-2": 1e-2, "bounds-3": 1e-4}[level]
        found = {name: np.full(rows.size, np.nan) for name in bound_columns(study)}
        low, high = ends("gdop_p95")
        middle = 3.0 + 1e-3 * rows["inclination_deg"] + 0.5 * (rows["phasing"] % 2)
        found[low], found[high] = middle - 0.7 * width, middle + 0.3 * width
        return found

    for level in LEVELS:
        monkeypatch.setitem(
            stages.FINDERS, level, lambda study, rows, level=level: bracketed(level, study, rows)
        )
    study = study_of(tiny)
    summary = run(study, tmp_path / "a")
    results = read_results(study, tmp_path / "a")
    counts = [sum(n for name, n in asked if name == level) for level in LEVELS]
    assert counts[0] == int(results.feasible.sum()) > counts[1] > 0
    assert summary.bounded["bounds-1"] == counts[0]
    front = first_front(study, results)
    smallest = int(results.satellites.values[results.feasible.values].min())
    assert front[0]["satellites"] == smallest
    for row in front:
        low, high = row["gdop_p95_bracket"]
        assert low <= row["gdop_p95"] <= high
    shown = str(TradeResult(study, tmp_path / "a", summary, results))
    assert "between proven bounds, everywhere and for all time: GDOP, 95th percentile" in shown
    # in other batches the same, and the second time nothing is asked
    run(study, tmp_path / "b", batch=1)
    other = read_results(study, tmp_path / "b")
    assert results.drop_attrs().identical(other.drop_attrs())
    asked.clear()
    run(study, tmp_path / "b")
    assert not asked


def test_more_time_decides_what_the_levels_leave_open_and_is_not_asked_twice(
    tiny, tmp_path, monkeypatch
):
    """Brackets that only a finer level tells apart; a budget that ends after one candidate."""
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)
    clock, asked = [0.0], []
    monkeypatch.setattr(OneProcess, "now", lambda self: clock[0])

    def bracketed(level, study, rows):
        asked.append((level, rows.size))
        clock[0] += 1.0
        width = 1e-6 if level == "bounds-4" else 0.7
        found = {name: np.full(rows.size, np.nan) for name in bound_columns(study)}
        low, high = ends("gdop_p95")
        middle = 3.0 + 1e-3 * rows["inclination_deg"] + 0.1 * rows["phasing"]
        found[low], found[high] = middle - width, middle + width
        return found

    for level in LEVELS | FINER:
        monkeypatch.setitem(
            stages.FINDERS, level, lambda study, rows, level=level: bracketed(level, study, rows)
        )
    study = study_of(tiny)

    def undecided():
        results = read_results(study, tmp_path)
        return int((~results.decided.values & (results.front.values == 0)).sum())

    run(study, tmp_path)
    assert not {level for level, _ in asked} & set(FINER)
    before = undecided()
    assert before > 2
    asked.clear()
    run(study, tmp_path, budget_s=1.0)
    assert asked == [("bounds-4", 1)]
    run(study, tmp_path, budget_s=1e6)
    assert undecided() == 0 and {level for level, _ in asked} == {"bounds-4"}
    assert len(asked) == before and all(size == 1 for _, size in asked)
    run(study, tmp_path, budget_s=1e6)
    assert len(asked) == before


def test_what_cannot_be_told_is_said(tiny, tmp_path, monkeypatch):
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)

    def wide(study, rows):
        found = {name: np.full(rows.size, np.nan) for name in bound_columns(study)}
        for name, value in zip(ends("availability"), (0.2, 0.95), strict=True):
            found[name] = np.full(rows.size, value)
        return found

    for level in LEVELS:
        monkeypatch.setitem(stages.FINDERS, level, wide)
    study = study_of(tiny, "availability", -1)
    summary = run(study, tmp_path)
    results = read_results(study, tmp_path)
    first = results.front.values == 0
    assert first.sum() > 1 and not results.decided.values[first].all()
    result = TradeResult(study, tmp_path, summary, results)
    assert "it is not decided within the budget" in str(result)
    limited = study_of(tiny, "availability", -1, limit=0.9)
    summary = run(limited, tmp_path / "limited")
    results = read_results(limited, tmp_path / "limited")
    assert results.straddling.any() and not results.feasible.any()
    result = TradeResult(limited, tmp_path / "limited", summary, results)
    assert "not decided within the budget whether they meet a limit" in str(result)
    assert result.to_dict()["straddling"] == int(results.straddling.sum())


@pytest.mark.slow
def test_the_front_that_bounds_decide_is_that_of_figures_known_far_better(
    tiny, tmp_path, monkeypatch
):
    """With the levels and the processes that a user has."""
    monkeypatch.setattr("compass.study.order.LEVELS", LEVELS)
    study = study_of(tiny, "availability", -1)
    team = Processes(study, 1)
    try:
        with Store(tmp_path, study) as store:
            summary = run_trade(study, store, team, Bars())
    finally:
        team.close()
    results = read_results(study, tmp_path)
    results = results.isel(candidate=np.flatnonzero(results.feasible.values))
    assert results.decided.all() and not summary.unfinished
    assert summary.bounded["bounds-1"] == results.sizes["candidate"] > summary.bounded["bounds-2"]
    better = bounds(LEVELS["bounds-3"], study, rows_in(results))
    low, high = (better[end] for end in ends("availability"))
    assert np.all(results.availability_low.values <= high)
    assert np.all(low <= results.availability_high.values)
    known = np.column_stack([results.satellites.values, -0.5 * (low + high)])
    assert np.array_equal(fronts(known) == 0, results.front.values == 0)


@pytest.mark.slow
def test_bounds_are_those_of_the_figures_themselves(tiny):
    from compass.study.candidates import batches, candidates, make_constellation
    from tests.coverage.test_certified_geometry import samples

    study = study_of(tiny, "availability", -1)
    study = replace(study, objectives=(*study.objectives, Objective("gdop_p50", 1)))
    rows = np.concatenate(list(batches(candidates(study), 100)))[::17]
    coarse, fine = (bounds(LEVELS[name], study, rows) for name in ("bounds-1", "bounds-2"))
    for figure in BOUNDED:
        low, high = ends(figure)
        if figure not in study.named:
            assert np.isnan(coarse[low]).all()
            continue
        assert np.all(coarse[low] <= fine[high]) and np.all(fine[low] <= coarse[high])
    for k, row in enumerate(rows):
        c, mask = make_constellation(row), np.radians(row["mask_deg"])
        gdop, pdop = samples(c, study.figure, mask, 4000, k)
        spread = 5 * np.sqrt(0.25 / gdop.size)
        share = (pdop <= study.map.pdop_max).mean()
        assert fine["availability_low"][k] - spread <= share
        assert share <= fine["availability_high"][k] + spread
        assert (gdop <= fine["gdop_p50_low"][k]).mean() <= 0.5 + spread
        assert (gdop <= fine["gdop_p50_high"][k]).mean() >= 0.5 - spread


def test_of_what_is_only_limited_it_is_told_on_which_side_it_is(tiny):
    study = study_of(tiny, "gdop_p50", limit=3.0)
    study = replace(study, objectives=study.objectives[:1])
    rows = np.array([(0, 18, 3, 1, 60.0, 20427.7, 5.0), (0, 5, 5, 1, 40.0, 20427.7, 5.0)], ROW)
    found = bounds(LEVELS["bounds-1"], study, rows)
    low, high = (found[end] for end in ends("gdop_p50"))
    assert low[0] == 0.0 and high[0] == 3.0 * (1.0 - BESIDE)
    assert low[1] >= 3.0 * (1.0 + BESIDE) and high[1] == np.inf
    # that is no value: the sampled one stands
    assert bracketed_figures(study) == []

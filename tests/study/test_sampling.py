"""Sampled figures say over what, and how far off they may be: against a far finer sampling."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from compass.inputs.study import read_study_text
from compass.pages.trade_finalists import against, verdict
from compass.quantities.merits import MERITS, merits_of
from compass.study.candidates import candidates
from compass.study.choice import Finalist
from compass.study.pattern_map import map_figures
from compass.study.sampling import doubtful, map_errors, sampled_over, sampling_of

TEXT = """
name = "fifteen"
[study]
patterns = ["walker-delta"]
satellites = [15]
inclination_deg = 50
orbits = ["areosynchronous"]
mask_deg = 5
[map]
step_deg = 15
epochs = 4
[[objective]]
figure = "gdop_p95"
"""


@pytest.fixture(scope="module")
def study():
    return read_study_text(TEXT)


@pytest.mark.slow
def test_errors_of_sampling_cover_what_a_fine_sampling_finds(study):
    rows = candidates(study).rows(0, 24)
    dense = replace(study, map=study.map.model_copy(update={"step_deg": 2.0, "epochs": 61}))
    coarse, fine, errors = (
        map_figures(study, rows),
        map_figures(dense, rows),
        map_errors(study, rows),
    )
    for name in (n for n in merits_of("map") if not MERITS[n].needs):
        known = np.isfinite(coarse[name]) & np.isfinite(fine[name])
        off = np.abs(coarse[name][known] - fine[name][known])
        assert known.sum() >= 12
        share = (off <= errors[name][known]).mean()
        assert share >= (0.5 if name == "gdop_p95_zone" else 0.9), name
        # and are no excuse for everything: within ten times what they are of
        assert np.median(errors[name][known]) < 10 * np.median(off) + 1e-12, name


def test_infinities_are_told_apart_where_they_are():
    infinity = np.inf
    values = {"x": np.array([1.0, 1.0, infinity, infinity, 2.0])}
    finer = {"x": np.array([1.0, 1.5, infinity, 3.0, infinity])}
    assert doubtful(values, [finer])["x"].tolist() == [0.0, 1.0, 0.0, infinity, infinity]
    further = {"x": np.array([1.25, 1.0, infinity, 3.0, infinity])}
    assert doubtful(values, [finer, further])["x"][:2].tolist() == [0.5, 1.0]


def test_what_is_sampled_says_over_what(study):
    assert sampling_of(study, "gdop_p95") == "15 deg cells, 4 epochs"
    assert sampling_of(study, "satellites") == sampling_of(study, "fold_proven") == ""
    assert sampled_over(study, ["identity", "planes", "availability", "gdop_p95"]) == (
        "share of area and time with a good PDOP; GDOP, 95th percentile: over "
        "15 deg cells, 4 epochs"
    )
    mapped = [name for name in MERITS if MERITS[name].stage == "map" and name != "count_mean"]
    assert [name for name in MERITS if sampling_of(study, name)] == mapped


@pytest.mark.parametrize(("entries", "most"), [(8, "37"), (1000, "0.37")])
def test_the_fewest_in_view_of_entries_says_how_many_others_may_have_fewer(study, entries, most):
    judged = replace(study, entry=SimpleNamespace(samples=entries))
    said = sampling_of(judged, "in_view.min")
    assert said.startswith(f"{entries} entries, fewer in at most {most} % of all (bounds that hold")
    assert sampling_of(judged, "in_view.median") == f"{entries} entries"
    # were it so many of all that have fewer, none of those judged would in one case of forty
    assert (1 - float(most) / 100) ** entries == pytest.approx(0.025, rel=0.03)


def one(value, error):
    row = np.zeros(1, candidates(read_study_text(TEXT)).rows(0, 1).dtype)[0]
    return Finalist("x", row, {"gdop_p95": value}, {"gdop_p95": error})


@pytest.mark.parametrize(
    ("a", "b", "order", "word"),
    [
        ((9.3, 0.5), (10.0, 0.5), "not told apart by the sampling in", "not told apart"),
        ((9.3, 0.3), (10.0, 0.3), "better in", "beats it in all"),
        ((10.0, 0.3), (9.3, 0.3), "worse in", "loses in all"),
        ((10.0, 9.0), (10.0, 9.0), "equal in", "equal"),
        ((10.0, np.inf), (np.inf, 0.0), "better in", "beats it in all"),
        ((np.nan, 0.1), (9.0, 0.1), "not comparable in", "not comparable"),
    ],
)
def test_no_order_is_claimed_inside_the_sampling(study, a, b, order, word):
    assert against(study, one(*a), one(*b)).startswith(order)
    assert verdict(study, one(*a), one(*b)) == word


@pytest.mark.slow
def test_a_pattern_that_a_coarse_sampling_prefers_is_not_called_better(study):
    """15/15/2 against 15/5/1: 7 % by 4 epochs on 15 degree cells, half a percent by 109 on 2."""
    rows = candidates(study).rows(0, 24)
    chosen = [rows[(rows["planes"] == p) & (rows["phasing"] == f)] for p, f in ((15, 2), (5, 1))]
    found = [
        Finalist(
            "x", row[0], {n: float(v[0]) for n, v in map_figures(study, row).items()},
            {n: float(v[0]) for n, v in map_errors(study, row).items()},
        )
        for row in chosen
    ]  # fmt: skip
    assert "better" not in against(study, *found) and "worse" not in against(study, *found)

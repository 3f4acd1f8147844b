"""A map's certified figures: what they stand for, and where there are none."""

import json

import numpy as np
import pytest

import compass
from compass.coverage.certified_effort import Effort
from compass.coverage.share import mean_fold_shares
from compass.errors import ArgumentError
from compass.quantities.draws import quantile_bounds
from compass.quantities.percentile import percentile
from compass.study.certified import certified_figures
from compass.study.mapping import MapOptions


@pytest.mark.slow
def test_map_says_what_is_certain(seed_design, tmp_path):
    made = compass.map(seed_design, step_deg=15, epochs=6)
    assert {"fold_share.7", "tdop.p99"} <= made.evidence().keys()
    numbers = json.loads(json.dumps(made.to_dict()))
    # the answer comes first, and every bracket beside its middle
    assert list(numbers)[:5] == ["design", "fold", "met", "areas", "count"] and numbers["met"]
    assert list(numbers["gdop"])[:3] == ["p50", "p50_bracket", "p90"]
    low, high = numbers["availability_bracket"]
    assert 0 <= low <= numbers["availability"] <= high <= 1
    assert "proven bounds" in str(made) and "verified shifts" in str(made)
    attrs = made.dataset.attrs
    assert list(attrs["availability_bracket"]) == [low, high]
    made.write(tmp_path / "m.nc")
    assert made.certified is not None
    # 15/5/1 has four satellites in view at times, and lines of sight that lie on a cone
    assert numbers["pdop_worst_bracket"][1] is None
    assert numbers["pdop_worst_at"]["value"] > 1e4
    assert "The largest PDOP is unbounded near " in str(made)


@pytest.mark.slow
def test_brackets_hold_what_an_independent_program_found(seed_design):
    found = certified_figures(seed_design, MapOptions(pdop_max=6.0), folds=range(4, 10))
    # 15/5/1 at 45 deg, 20,427 km, on the sphere of 3396.2 km
    assert found.availability.low <= 0.9736178 and found.availability.high >= 0.9736164
    assert found.availability.width <= 2e-4
    assert (
        found.dops["gdop"][95].high - found.dops["gdop"][95].low
        <= 2e-2 * found.dops["gdop"][95].high
    )
    exact = mean_fold_shares(
        seed_design.constellation, sphere_radius=seed_design.figure.equatorial_radius
    )
    numbers = found.numbers()["fold_share"]
    for fold in range(4, 10):
        low, high = numbers[f"{fold}_bracket"]
        assert low <= exact.share[fold:].sum() + exact.error and high - low <= 2e-3
        assert exact.share[fold:].sum() - exact.error <= high
    assert numbers["4_bracket"] == [1.0, 1.0]  # always four
    sampled = compass.map(seed_design, step_deg=3, epochs=109, budget_s=0.01).dataset
    p95 = float(sampled.cells_dop.sel(dop="gdop", global_percentile=95))
    assert found.dops["gdop"][95].low == pytest.approx(p95, rel=0.03)


def test_drifting_orbits_over_a_duration_have_brackets(seed_design, monkeypatch):
    monkeypatch.setattr("compass.coverage.certified_geometry.BUDGET_BOXES", 0)
    found = certified_figures(seed_design, MapOptions(motion="j2", duration_h=2.0))
    assert "over 2 h from the epoch, mean motion under J2" in found.scope
    assert "ended early: as many boxes of places and moments as allowed" in found.scope
    assert (found.dops["gdop"][95].low, found.dops["gdop"][95].high) == (0.0, np.inf)
    nothing = {"gdop": {}, "pdop": {}, "tdop": {}, "fold_share": {}}
    assert found.numbers() == nothing  # bounds that say nothing are none
    later = certified_figures(seed_design, MapOptions(start_day=2.0))
    assert "over 24.623 h from 48 h after the epoch, two-body" in later.scope


def test_without_bounds_the_sample_is_said(seed_design, monkeypatch):
    """As after ^C: a middle of 0 and infinity had stood for a percentile that was sampled."""
    monkeypatch.setattr("compass.coverage.certified_geometry.BUDGET_BOXES", 0)
    made = compass.map(seed_design, step_deg=30, epochs=2)
    numbers, evidence = made.numbers(), made.evidence()
    values = made.drawn.values
    assert numbers["gdop"]["p95"] == percentile(values["gdop"], 95) < np.inf
    assert numbers["gdop"]["p95_interval"] == list(quantile_bounds(values["gdop"], 95))
    assert numbers["availability"] == (values["pdop"] <= 6.0).mean() > 0.0
    assert made.dataset.attrs["gdop_p95_interval"] == numbers["gdop"]["p95_interval"]
    told = (*numbers, *numbers["gdop"], *numbers["fold_share"])
    assert not [name for name in told if name.endswith("_bracket")]
    # the fewest and the most in view are found by other proofs, the mean is the caps' area
    assert numbers["count"]["max_bracket"] == [9, 9]
    assert evidence["count.mean"].startswith("between proven bounds")
    for name in ("availability", "gdop.p95", "fold_share.5"):
        assert evidence[name].startswith("bounds that hold in 95 of 100 cases")
    assert "(95 % of area and time); bounds that hold in 95 of 100 cases" in str(made)
    assert "∞" not in str(made)
    assert "availability_bracket" not in made.dataset.attrs
    beyond = {"p95": np.inf, "p95_bracket": [1e5, np.inf]}  # the largest limit looked at
    assert str(made._percentile("gdop", {"gdop": beyond}, "p95")) == "∞"


@pytest.mark.slow
def test_integrated_paths_have_brackets_over_their_span(seed_design):
    effort = Effort(width=0.05, budget_s=20.0)
    found = certified_figures(seed_design, MapOptions(motion="numerical", duration_h=1.5), effort)
    assert "over 1.5 h from the epoch, numerical motion" in found.scope
    sampled = compass.map(
        seed_design, step_deg=4, epochs=10, motion="numerical", duration_h=1.5, budget_s=0.01
    )
    share = float(sampled.dataset.cells_availability)
    assert found.availability.low - 2e-3 < share < found.availability.high + 2e-3
    assert found.availability.width <= 0.05


def test_a_limit_below_one_is_refused(seed_design):
    with pytest.raises(ArgumentError, match=r"pdop_max = 0\.5: allowed 1 to"):
        compass.map(seed_design, pdop_max=0.5)

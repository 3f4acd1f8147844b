"""Figures of a study at sites and in regions: those of a map of each candidate, and kept to."""

from dataclasses import replace

import numpy as np
import pytest

from compass.api.trade import TradeResult
from compass.coverage.areas import Area, Near, areas_of
from compass.coverage.areas import area_figures as coverage_areas
from compass.design import Design
from compass.errors import DesignError
from compass.inputs.study import read_study_text
from compass.sites import Mask
from compass.study.area_figures import area_bounds, area_columns, area_figures, shown_areas
from compass.study.bounds import LEVELS, bound_columns, bounds, bracketed_figures
from compass.study.candidates import batches, candidates, make_constellation
from compass.study.columns import shown
from compass.study.evolve import Known
from compass.study.results import first_front, read_results
from compass.study.stages import FINDERS
from compass.study.store import Store
from compass.study.trade import Silent, run_trade
from compass.study.yardstick import _by_itself
from tests.evidence import unknown, unknown_variables
from tests.one_process import OneProcess
from tests.study.conftest import TEXT

PLACES = """
[[station]]
name = "E"
latitude_deg = 5
longitude_deg = 20
mask_deg = 10
"""
ROUGH = Near(0.1, 0.5, 2000)


@pytest.fixture
def placed():
    """Give a study of few candidates, mapped at a site and in a band too."""

    def make(more="", where='sites = ["E"]\nregion = "lat:-10:10"', fold=1):
        text = TEXT.format(fold=fold, more=PLACES + more)
        made = read_study_text(text.replace("epochs = 2", f"epochs = 2\n{where}"), "tiny.toml")
        space = replace(made.space, satellites=(6,), planes=(2,), inclination_deg=(40.0,))
        return replace(made, space=space)

    return make


def first(study):
    """The first candidate, as a batch."""
    return next(batches(candidates(study), 1))


@pytest.mark.slow
def test_figures_are_those_of_a_map_at_the_same_places(placed):
    """The study's brackets and finer ones of `compass.map` overlap; fold and margin agree."""
    study = placed()
    row = first(study)
    found = area_figures(study, row, Near(0.2, 0.5, 2000))
    c = replace(make_constellation(row[0]), repeat=(1, 1))
    mask = Mask.constant(float(np.radians(row[0]["mask_deg"])))
    design = Design(c, figure=study.figure, mask=mask, fold=1, stations=study.sites)
    asked = areas_of(
        design, sites=study.sites, regions=study.regions, fold=1, span=(0.0, 1.0),
        near=Near(0.05, 0.3, 100_000),
    )  # fmt: skip
    areas = coverage_areas(asked, study.map.pdop_max, 30.0)
    for number, area in enumerate(areas, start=1):
        met, margin = (found[f"area_{number}_{part}"][0] for part in ("met", "margin_deg"))
        assert met == area.fold.met
        assert np.radians(margin) == pytest.approx(area.fold.margin, abs=1e-4)
        for part, (low, high) in {
            "availability": area.availability, "gdop_p50": area.gdop[50], "gdop_p95": area.gdop[95],
        }.items():  # fmt: skip
            assert found[f"area_{number}_{part}_low"][0] <= high
            assert found[f"area_{number}_{part}_high"][0] >= low
    both = [[found[f"area_{k}_gdop_p50_{end}"][0] for k in (1, 2)] for end in ("low", "high")]
    assert [found[f"area_gdop_p50_{end}"][0] for end in ("low", "high")] == list(map(max, both))
    least = [min(found[f"area_{k}_{part}"][0] for k in (1, 2)) for part in ("margin_deg", "met")]
    assert [found["area_margin_deg"][0], found["area_fold_met"][0]] == least


def test_areas_are_a_stage_and_sorted_by_bounds_that_come_nearer(placed, tmp_path, monkeypatch):
    """What levels find takes the place of what the stage found; evolution sees the stage's."""

    def vague(study, rows):
        ends = {"area_availability_low": 0.0, "area_availability_high": 1.0}
        found = area_figures(study, rows, ROUGH)
        return found | {name: np.full(rows.size, end) for name, end in ends.items()}

    monkeypatch.setitem(FINDERS, "areas", vague)
    monkeypatch.setattr("compass.study.order.LEVELS", {"bounds-2": ROUGH})
    nearer = dict.fromkeys(("area_availability", "area_gdop_p95"), (0.4, 0.5))
    asked = []

    def bounds(study, row, names, near):
        asked.append(tuple(names))
        return {name: nearer[name] for name in names}

    monkeypatch.setattr("compass.study.bounds.area_bounds", bounds)
    study = placed(
        '[[objective]]\nfigure = "area_availability"\n[[objective]]\nfigure = "requirement_share"\n'
        '[[constraint]]\nfigure = "area_fold_met"\nat_least = 0\n'
        '[[requirement]]\nsites = ["E"]\nfold = 1\nshare = 0.1\n'
    )
    assert study.stages == ("screen", "map", "requirements", "areas")
    assert set(bound_columns(study)) >= {"area_availability_low", "area_availability_high"}
    assert "area_gdop_p50" in bracketed_figures(study)
    with Store(tmp_path, study) as store:
        summary = run_trade(study, store, OneProcess(study), Silent)
        results = read_results(study, tmp_path)
        seen = Known(store).figures(list(results.identity.values))
    np.testing.assert_array_equal(seen["area_margin_deg"], results.area_margin_deg)
    assert set(asked) == {("area_availability",)}
    front = first_front(study, results)
    assert front
    for one in front:
        assert one["area_availability_bracket"] == [0.4, 0.5]
        assert one["area_availability"] == pytest.approx(0.45)
        assert one["area_1_margin_deg"] >= one["area_margin_deg"]
    found = TradeResult(study, tmp_path, summary, results)
    assert unknown(found.to_dict()) == [] and unknown_variables(results) == []
    assert results.area_availability.attrs["evidence"] == "proven, or between proven bounds"
    said = " ".join(str(found).split())
    assert "E: GDOP, 95th percentile" in said and "lat:-10:10: horizon may rise by, deg" in said
    assert results.area_2_met.attrs["long_name"] == "lat:-10:10: fold always in view"


def test_geometry_is_not_looked_at_where_the_fold_demanded_is_refuted(placed):
    """Seven are never in view of six."""
    demanded = '[[constraint]]\nfigure = "area_fold_met"\nat_least = 1\n'
    study = placed(demanded, fold=7)
    found = area_figures(study, first(study), ROUGH)
    assert found["area_fold_met"][0] == 0.0
    assert np.isnan([found["area_availability"][0], found["area_1_gdop_p95_low"][0]]).all()
    columns = {name: [found[name][0]] for name in area_columns(study)}
    assert all("GDOP" not in heading for heading, _ in shown(shown_areas(study), columns))


@pytest.mark.slow
def test_a_design_to_compare_with_has_the_same_figures(placed):
    """By the functions of one constellation: the brackets meet, the margin agrees."""
    study = placed()
    row = first(study)
    c = replace(make_constellation(row[0]), repeat=(1, 1))
    known, _ = _by_itself(study, c, float(row[0]["mask_deg"]))
    found = area_figures(study, row, ROUGH)
    assert known["area_margin_deg"] == found["area_margin_deg"][0]
    low, high = area_bounds(study, row[0], ["area_gdop_p95"], ROUGH)["area_gdop_p95"]
    assert low <= known["area_gdop_p95_high"] and high >= known["area_gdop_p95_low"]


def test_faults_of_places_are_told(placed, tiny):
    with pytest.raises(DesignError, match=r"map.sites = 'X': no such \[\[station\]\]; there are E"):
        placed(where='sites = ["X"]')
    with pytest.raises(DesignError, match=r"map.region = lat:9:0: latitudes must lie"):
        placed(where='region = "lat:9:0"')
    with pytest.raises(DesignError, match=r"without places; add sites or region to \[map\]"):
        tiny('[[objective]]\nfigure = "area_gdop_p95"\n')


def test_sites_stand_in_the_order_in_which_they_are_named(placed):
    other = '[[station]]\nname = "F"\nlatitude_deg = 0\nlongitude_deg = 0\n'
    study = placed(other, where='sites = ["F", "E"]')
    assert [site.name for site in study.sites] == ["F", "E"]
    assert "F" in area_columns(study)["area_1_met"]["long_name"]


def test_the_first_level_leaves_areas_as_their_stage_left_them(placed, monkeypatch):
    """Which has come as near; both percentiles of an area are from one search."""
    asked = []

    def percentiles(area, percents):
        asked.append(tuple(percents))
        return dict.fromkeys(percents, (1.0, 2.0))

    monkeypatch.setattr(Area, "gdop", percentiles)
    study = placed("".join(f'[[objective]]\nfigure = "area_gdop_p{q}"\n' for q in (50, 95)))
    row = first(study)
    assert not [name for name in bounds(LEVELS["bounds-1"], study, row) if "area" in name]
    assert not asked
    assert bounds(LEVELS["bounds-2"], study, row)["area_gdop_p50_high"] == 2.0
    assert asked == [(50, 95)] * 2

"""Requirements of a study: as `check` finds them on each candidate, and kept to."""

from dataclasses import replace

import numpy as np
import pytest

from compass.api.trade import TradeResult
from compass.coverage.certified_effort import Effort
from compass.coverage.requirement_verdict import verdict_of
from compass.design import Design
from compass.errors import DesignError
from compass.sites import Mask
from compass.study import requirement_figures as module
from compass.study.candidates import batches, candidates, make_constellation
from compass.study.columns import shown
from compass.study.evolve import Known
from compass.study.requirement_figures import shown_requirements
from compass.study.results import first_front, read_results
from compass.study.store import Store
from compass.study.trade import Silent, run_trade
from tests.evidence import unknown, unknown_variables
from tests.one_process import OneProcess

REQUIRED = """
[[station]]
name = "E"
latitude_deg = 0
longitude_deg = 20
[[requirement]]
name = "one in view"
sites = ["E"]
fold = 1
[[requirement]]
name = "two at times"
region = "lat:-10:10"
fold = 2
share = 0.3
share_of = "area-time"
"""


def first(study):
    """The first candidate, as a batch."""
    return next(batches(candidates(study), 1))


def test_requirements_are_a_stage_a_constraint_and_columns(tiny, tmp_path):
    study = tiny(REQUIRED)
    study = replace(study, space=replace(study.space, satellites=(5,), inclination_deg=(40.0,)))
    assert study.stages == ("screen", "map", "requirements")
    with Store(tmp_path, study) as store:
        run_trade(study, store, OneProcess(study), Silent)
        results = read_results(study, tmp_path)
        seen = Known(store).figures(list(results.identity.values))
    for name in ("requirements_met", "requirement_1_met", "requirement_share"):
        np.testing.assert_array_equal(seen[name], results[name])  # what evolution selects by
    asked = results.isel(candidate=np.flatnonzero(results.stage.values == "requirements"))
    assert asked.sizes["candidate"]
    assert not (results.feasible & (results.requirements_met != 1)).any()
    front = first_front(study, results)
    assert front
    for one in front:
        assert one["requirements_met"] == 1
        assert one["requirement_share"] <= one["requirement_share_most"]
    for k in range(asked.sizes["candidate"]):
        one = asked.isel(candidate=k)
        each = [one[f"requirement_{number}_met"].item() for number in (1, 2)]
        assert (one.requirements_met.item() == 1) == (each == [1, 1])
        known = [one[f"requirement_{number}_share"].item() for number in (1, 2)]
        assert one.requirement_share.item() == np.nanmin(known)
    assert results.requirement_2_share.attrs["long_name"].startswith("two at times: share")
    told = shown(shown_requirements(study), results)
    assert [heading.split(":")[0] for heading, _ in told] == [
        "one in view", "one in view", "two at times",
    ]  # fmt: skip


def test_a_verdict_fills_the_columns_of_its_own_requirement(tiny):
    """Each against `verdict_of`; what was not asked for after a miss stays empty."""
    study = tiny(REQUIRED)
    rows = next(batches(candidates(study), 12))
    found = module.requirement_figures(study, rows)
    for k, row in enumerate(rows):
        c = replace(make_constellation(row), repeat=(1, 1))
        design = Design(c, figure=study.figure, mask=Mask.constant(np.radians(row["mask_deg"])))
        met = True
        for number, wanted in enumerate(study.requirements, start=1):
            column = {part: found[f"requirement_{number}_{part}"][k] for part in module.PARTS}
            if not met:
                assert np.isnan(list(column.values())).all()
                continue
            verdict = verdict_of(design, wanted)
            met = verdict.met
            assert column["met"] == met
            assert column["share"] <= verdict.share[1] + 1e-12
            assert column["share_most"] >= verdict.share[0] - 1e-12
            bracketed = verdict.share[0] < verdict.share[1]
            assert (column["share"] < column["share_most"]) == bracketed
            if verdict.margin is not None:
                assert np.radians(column["margin_deg"]) == pytest.approx(verdict.margin)


def test_figures_are_those_of_verdicts_under_closed_tracks(tiny):
    """A place under tracks that the study declares closed, not its circle of latitude."""
    study = tiny(REQUIRED)
    rows = first(study)
    found = module.requirement_figures(study, rows)
    c = replace(make_constellation(rows[0]), repeat=(1, 1))
    design = Design(c, figure=study.figure, mask=Mask.constant(np.radians(5)))
    coarse = Effort(width=module.COARSE)
    verdicts = [verdict_of(design, wanted, effort=coarse) for wanted in study.requirements]
    finer = [verdict_of(design, wanted) for wanted in study.requirements]
    for one, nearer in zip(verdicts, finer, strict=True):
        assert one.met is nearer.met is not None
        if one.share and nearer.share:
            assert one.share[0] <= nearer.share[1] and nearer.share[0] <= one.share[1]
    assert found["requirements_met"][0] == all(verdict.met for verdict in verdicts)
    if verdicts[0].margin is not None:
        assert np.radians(found["requirement_margin_deg"][0]) == pytest.approx(verdicts[0].margin)
    asked = verdicts if verdicts[0].met else verdicts[:1]
    assert found["requirement_share"][0] == min(v.share[0] for v in asked if v.share)


def test_one_requirement_is_a_goal_and_a_limit(tiny, tmp_path, monkeypatch):
    """Its share sorted by brackets that are near: who may be beaten within them is not decided."""
    wanted = """
[[objective]]
figure = "requirement_2_share"
[[objective]]
figure = "requirement_1_margin_deg"
[[constraint]]
figure = "requirement_2_share_most"
at_least = 0.4
"""
    monkeypatch.setattr(module, "NEAR", 5e-3)  # half of what is asked for below
    study = tiny(REQUIRED + wanted)
    study = replace(study, space=replace(study.space, satellites=(5,), inclination_deg=(40.0,)))
    assert {(o.figure, o.goal) for o in study.objectives} >= {
        ("requirement_2_share", "largest"), ("requirement_1_margin_deg", "largest"),
    }  # fmt: skip
    with Store(tmp_path, study) as store:
        summary = run_trade(study, store, OneProcess(study), Silent)
    results = read_results(study, tmp_path)
    assert unknown(TradeResult(study, tmp_path, summary, results).to_dict()) == []
    assert unknown_variables(results) == []
    front = first_front(study, results)
    assert front
    for one in front:
        low, high = one["requirement_2_share_bracket"]
        assert high >= 0.4 and 0 <= high - low <= 1e-2
        assert low == one["requirement_2_share"]
    # by hand: within their bounds as good in all, and better in one
    good = results.isel(candidate=np.flatnonzero(results.feasible.values))
    for one in front:
        better = good.requirement_2_share.values > one["requirement_2_share_bracket"][1]
        better &= good.requirement_1_margin_deg.values >= one["requirement_1_margin_deg"]
        names = [o.figure for o in study.objectives if not o.figure.startswith("requirement")]
        signs = {o.figure: o.sign for o in study.objectives}
        for name in names:
            better &= signs[name] * good[name].values <= signs[name] * one[name]
        assert not better.any()


def test_a_share_is_narrowed_about_what_others_find(tiny):
    """The bracket of a wide verdict against one asked for finely."""
    study = tiny(REQUIRED)
    rows = first(study)
    design = Design(make_constellation(rows[0]), figure=study.figure, mask=Mask.constant(0.05))
    asked = study.requirements[1]
    wide = verdict_of(design, asked)
    near = module.narrowed(design, wide)
    low, high = near.share
    assert wide.share[0] <= low <= high <= wide.share[1] and high - low <= module.NEAR
    fine = verdict_of(design, replace(asked, share=0.5 * (low + high))).share
    assert fine[0] <= high and low <= fine[1]
    always = verdict_of(design, study.requirements[0])
    assert module.narrowed(design, always) == always


@pytest.mark.parametrize(
    ("figure", "message"),
    [
        ("requirement_3_share", r"no \[\[requirement\]\] of that number; there are 2"),
        ("requirement_0_share", "and of one requirement, K in the file, requirement_K_margin_deg"),
        ("requirement_1_met", "and of one requirement, K in the file"),
    ],
)
def test_a_figure_of_no_requirement_gets_a_message(tiny, figure, message):
    with pytest.raises(DesignError, match=message):
        tiny(f'{REQUIRED}\n[[objective]]\nfigure = "{figure}"\n')


def test_what_is_missed_ends_the_asking(tiny):
    study = tiny(REQUIRED.replace("fold = 1", "fold = 5"))
    found = module.requirement_figures(study, first(study))
    assert found["requirements_met"][0] == 0.0
    assert found["requirement_share_most"][0] < 1.0


def test_faults_of_requirements_in_studies_are_told(tiny):
    with pytest.raises(DesignError, match="sites = 'F': no such"):
        tiny(REQUIRED.replace('"E"]', '"F"]'))
    landing = '[entry]\nscenario = "entry-compass.toml"\n'
    entry = tiny(REQUIRED + landing + 'sites = ["E"]\nregion = "lat:0:9"').entry
    assert ([site.name for site in entry.sites], entry.regions) == (["E"], ("lat:0:9",))
    with pytest.raises(
        DesignError, match=r"entry.sites = 'X': no such \[\[station\]\]; there are E"
    ):
        tiny(REQUIRED + landing + 'sites = ["X"]')
    with pytest.raises(DesignError, match=r"entry.region = lat:9:0: latitudes must lie"):
        tiny(landing + 'region = "lat:9:0"')
    with pytest.raises(DesignError, match="without requirements; add a"):
        tiny('[[constraint]]\nfigure = "requirement_margin_deg"\nat_least = 2')

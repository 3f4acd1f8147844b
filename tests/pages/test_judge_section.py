"""The report's section on landing navigation."""

from types import SimpleNamespace

import numpy as np
import pytest

from compass.api.outlook import Glance
from compass.document import Answers, Picture
from compass.entry.arrivals import draw_arrivals
from compass.inputs import read_design_text
from compass.inputs.scenario import read_scenario_text
from compass.pages import judge as module
from compass.pictures import judge as pictures
from compass.pictures.style import new_figure
from compass.study.judge import campaign_of, judge_entries
from compass.study.judge_filter import NOT_RUN
from compass.study.ranking import Ranking

DESIGN = """
name = "{name}"
[constellation]
pattern = "walker-delta"
satellites = {satellites}
planes = 1
phasing = 0
inclination_deg = 50
radius_km = 20428
"""


@pytest.fixture(scope="module")
def scenario(designs):
    text = (designs / "landing.toml").read_text()
    text = text.replace("duration_s = 320", "duration_s = 10\nstep_s = 2")
    text = text.replace('[[trigger]]\nname = "parachute deployment"\nmach = 2\n', "")
    return read_scenario_text(text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', ""))


def designs_of(*sizes):
    return [
        read_design_text(DESIGN.format(name=f"{n} satellites", satellites=n), f"{n}.toml")
        for n in sizes
    ]


def with_worst(found):
    """Give figures with the worst of the entries in place of the worst that a search finds."""
    figures = found.figures()
    for part in (figures, *([figures["after_loss"]] if "after_loss" in figures else [])):
        part["worst_found"] = {"value": part["crlb_position_m"]["worst"]}
    return figures


def ranking_of(designs, scenario, samples):
    """Give a ranking without the search for the worst, the surface and the filter's runs."""
    rows, judgements = [], []
    for rank, design in enumerate(designs):
        found = judge_entries(
            design.constellation, campaign_of(scenario, samples), scenario,
            figure=design.figure, mask=design.mask,
        )  # fmt: skip
        judgements.append(found)
        filtered = {
            "runs": 4, "diverged": 0, "consistent": True, "believed": True, "ekf_position_m": {"p50": 8.0, "p95": 12.0}, "rms_over_bound": 1.1, "nees": 6.1,
            "nees_interval": {"low": 5, "high": 7},
        }  # fmt: skip
        rows.append(
            {
                "rank": rank + 1, "design": design.name, "file": design.label, "given": designs.index(design) + 1,
                "satellites": design.constellation.size, **with_worst(found),
                "budget_m": found.budget(), "answer": "no",
                **(NOT_RUN if rank else filtered),
            }
        )  # fmt: skip
    record = {
        "designs": rows, "samples": samples, "counted": "Counted.", "seed": 0, "goal_m": 10.0, "density_sigma": 0.0,
        "lift_sigma": 0.0, "ground": [],
    }  # fmt: skip
    return Ranking(record, tuple(judgements))


def test_section_has_maps_distributions_and_a_table(scenario):
    two, three = designs_of(2, 3)
    ranking = ranking_of([three, two], scenario, 4)
    section = module.judge_section(ranking, [two, three], scenario)
    assert [picture.stem for picture in section.pictures] == ["judge-map", "judge-distributions"]
    assert all(picture.drawn.startswith((b"\x89PNG", b"<svg")) for picture in section.pictures)
    table, budget, run = section.tables
    assert budget.rows[0][0] == "3 satellites"
    assert len(table.rows) == 2 and len(table.rows[0]) == len(table.header)
    assert table.rows[0][1] == "3 satellites"
    (row,) = run.rows
    assert row == ("3 satellites", 4, 0, 8.0, 12.0, 1.1, 6.1, "5.00 and 7.00", "yes")
    assert "3 satellites: within 10 m? no." in section.paragraphs


def test_cells_keep_their_largest_bound(scenario):
    (two,) = designs_of(2)
    campaign = campaign_of(scenario, 4)
    found = [
        judge_entries(two.constellation, on, scenario, figure=two.figure, mask=two.mask)
        for on in (campaign, campaign.again(draw_arrivals(4, 9)))
    ]
    cells = pictures.largest_by_cell(found)
    sigma = np.concatenate([one.position_sigma for one in found])
    assert np.nanmax(cells) == sigma.max()
    assert 1 <= np.isfinite(cells).sum() <= sigma.size
    latitude, longitude = found[0].campaign.deployment_place
    row = int((np.sin(latitude[0]) + 1) / 2 * pictures.ROWS)
    column = int((longitude[0] + np.pi) / (2 * np.pi) * pictures.COLUMNS)
    assert cells[row, column] >= found[0].position_sigma[0]


@pytest.mark.parametrize("widest", [30.0, 90.0, 4000.0])
def test_bounds_of_any_width_have_numbers_along_their_axis(widest):
    found = SimpleNamespace(
        campaign=SimpleNamespace(size=50), position_sigma=np.geomspace(8, widest, 50),
        worst_loss=None,
    )  # fmt: skip
    figure = new_figure(5.8, 4.0)
    axes = figure.add_subplot()
    pictures.draw_distributions(axes, ["one"], [found], 10.0)
    figure.canvas.draw()
    low, high = axes.get_xlim()
    told = [
        float(text.get_text())
        for text in axes.get_xticklabels(which="both")
        if text.get_text() and low <= text.get_position()[0] <= high
    ]
    assert {10.0, 20.0} <= set(told) and max(told) > widest / 3
    assert len(told) == len(set(told)) <= 20


def test_the_answer_says_which_is_best_and_whether_to_believe_it(monkeypatch):
    lasting = {"1.toml": (31.69, 40.0, "3 in view"), "2.toml": (40.0, 40.0, ""),
               "3.toml": (0.0, 40.0, "0 in view"), "4.toml": (1.2, 40.0, "gone")}  # fmt: skip
    monkeypatch.setattr(module, "glance", lambda design: Glance(design, *lasting[design.label]))
    monkeypatch.setattr(module, "flown", lambda design: f"orbits of {design.label}")
    designs = designs_of(1, 2, 3, 4)

    def row(name, p95, **filtered):
        known = {"nees": None, "believed": True, "consistent": True, **filtered}
        return {
            "design": name, "given": 1 + "ABCD".index(name), "crlb_position_m": {"p95": p95}, "worst_found": {"value": 2 * p95}, **known,
        }  # fmt: skip

    picture = Picture("p", "t", "c", b"png")
    rows = [
        row("A", 4.0, nees=50.0, believed=False, errors_over_claim=3.21),
        row("B", 8.0, nees=6.0),
        row("C", 9.0, nees=7.0, consistent=False),
        row("D", 20.0),
    ]
    record = {
        "designs": rows,
        "goal_m": 10.0,
        "deployment": "the end",
        "samples": 2048,
        "ground": [],
    }
    section = module.answer_section(record, designs, picture)
    (lead,) = section.paragraphs
    assert lead.startswith("Missed; nearest comes “A” (orbits of 1.toml), the best of 4. A lander")
    assert "place to 4 m in 95 % of 2,048 entries, at the end, to 8 m in the worst found" in lead
    assert "; 10 m are wanted." in lead
    assert "rival “B” has 2 times" in lead and "no accuracy is claimed" in lead
    (answers,) = (block for block in section.blocks if isinstance(block, Answers))
    assert [a.holds for a in answers.rows] == [False] * 4 + [None] * 4
    assert [(a.written, a.evidence) for a in answers.rows[4:]] == [
        ("31 days", "proven: compass drift 1.toml --days 33"),
        ("40 days and more", "proven: compass drift 2.toml --days 40"),
        ("no time: at the epoch 0 in view", "proven: compass drift 3.toml --days 1"),
        ("1.2 days", "proven: compass drift 4.toml --days 3"),
    ]
    easier = module.answer_section({**record, "goal_m": 16.0}, designs, picture)
    assert easier.blocks[1].rows[1].holds
    said = [a.evidence.partition("; ")[2] for a in answers.rows[:4]]
    assert said == [
        "the filter's errors are 3.21 times what it claims", "the filter is consistent",
        "the filter is not consistent", "",
    ]  # fmt: skip
    assert section.pictures == (picture,) and "So few" not in lead
    for known, bounds in zip(rows, ((3.0, 8.5), (7.0, 9.0), (8.6, 9.5), (15.0, 25.0)), strict=True):
        known["crlb_position_m"]["p95_interval"] = bounds
    (lead,) = module.answer_section(record, designs, picture).paragraphs
    assert "So few entries do not put “B” behind “A”: the bounds of their 95th" in lead

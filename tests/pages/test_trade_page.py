"""Verdicts and free variables of the trade report."""

import contextlib
import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from compass.api.outlook import Glance
from compass.document import Answers
from compass.inputs import read_design_text
from compass.inputs.study import Constraint, read_study_text
from compass.pages import trade_pictures
from compass.pages.page import write_page
from compass.pages.trade import _asked, trade_report
from compass.pages.trade_finalists import Entrant, _lasts, against, doubt, verdict
from compass.pages.trade_interactive import beside
from compass.quantities.merits import MERITS
from compass.study import ranking
from compass.study.candidates import ROW
from compass.study.choice import Finalist
from compass.study.results import read_results
from compass.study.store import Store
from compass.study.trade import run_trade
from tests.one_process import OneProcess

TEXT = """
name = "sampled"
[study]
patterns = ["walker-delta"]
satellites = { least = 6, most = 9 }
inclination_deg = { least = 30, most = 70 }
radius_km = { least = 9000, most = 21000 }
fold = 1
[sampling]
method = "latin-hypercube"
samples = 60
[map]
step_deg = 45
epochs = 2
[[constraint]]
figure = "availability"
at_least = 0
[[objective]]
figure = "satellites"
[[objective]]
figure = "gdop_p50"
"""


@pytest.fixture
def coarse(monkeypatch):
    """Coarse maps, no orbits followed: what they look like is not tested here."""
    monkeypatch.setattr(trade_pictures, "EPOCHS", 3)
    monkeypatch.setattr(trade_pictures, "CELL_DEG", 30.0)
    monkeypatch.setattr("compass.pages.trade_finalists.glance", lambda d: Glance(d, 31.7, 40.0, ""))


def finalist(satellites, gdop):
    row = np.array([(0, satellites, 1, 0, 50.0, 20000.0, 0.0)], ROW)[0]
    return Finalist("x", row, {"satellites": float(satellites), "gdop_p50": gdop})


@pytest.mark.parametrize(
    ("other", "word"),
    [
        ((10, 4.0), "loses in all"),
        ((12, 5.0), "beats it in all"),
        ((10, 6.0), "a trade"),
        ((11, 4.5), "equal"),
        ((11, np.nan), "not comparable"),
    ],
)
def test_verdicts(other, word):
    study = read_study_text(TEXT)
    assert verdict(study, finalist(11, 4.5), finalist(*other)) == word


def test_words():
    study = read_study_text(TEXT)
    text = against(study, finalist(10, 4.5), finalist(10, 3.0))
    gdop = "GDOP, median over area and time"
    how = "sampled over 45 deg cells, 2 epochs"
    assert text == f"worse in {gdop}: 4.5 against 3 (+50 %), {how}; equal in number of satellites"
    assert against(study, finalist(9, np.inf), finalist(10, 3.0)) == (
        f"better in number of satellites: 9 against 10 (−10 %); worse in {gdop}: ∞ against 3, {how}"
    )
    assert against(study, finalist(9, np.nan), finalist(9, 3.0)) == (
        f"equal in number of satellites; not comparable in {gdop}"
    )


def test_bars_are_of_what_another_sampling_moves_alone():
    """Half the width of proven bounds is no bar, nor is an error that no number says."""
    errors = {"gdop_p50": 0.2, "gdop_p95": 0.5, "availability": np.inf}
    one = replace(finalist(9, 3.0), errors=errors, brackets={"gdop_p95": (3.0, 4.0)})
    names = ("gdop_p50", "gdop_p95", "availability", "satellites")
    assert [doubt(one, name) for name in names] == [0.2, 0.0, 0.0, 0.0]
    front = xr.Dataset(
        {"decided": ("candidate", [True]), "front": ("candidate", [0])}, attrs={"waiting": 0}
    )
    sure = replace(one, errors={"gdop_p95": 0.5})
    study = read_study_text(TEXT)
    assert "Bars" in beside(study, front, [one]) and "Bars" not in beside(study, front, [sure])


def test_recommendation_names_file_and_units(landing, tmp_path, coarse):
    made = traded(landing, tmp_path / "store")
    answered, section = made.sections[:2]
    assert (
        "(finalist-1.toml)" in answered.paragraphs[0] and "Its rival is" in answered.paragraphs[0]
    )
    lead = answered.paragraphs[0]
    for part in (
        "1 in view above",
        "proven for all time; left alone on real orbits it lasts",
        "Landing: place",
    ):
        assert part in lead
    (answers,) = (block for block in answered.blocks if isinstance(block, Answers))
    assert answers.rows[0].holds and answers.rows[0].answer == "proven"
    assert any("Three areostationary relays has" in row.sure for row in answers.rows)
    assert len(answered.pictures) == 1 and "(finalist-1.toml)" in section.paragraphs[0]
    answer = made.summary["landing"]["designs"]
    own = next(row["answer"] for row in answer if row["file"] == "finalist-1.toml")
    assert any(own[1:] in text for text in section.paragraphs)
    assert "Beside Three areostationary relays it is " in section.paragraphs[3]
    # two masks, so that the tables say which
    tables = {t.title: t for s in made.sections for t in s.tables}
    figures = {row[0]: row[1:] for row in tables["Every figure of the finalists"].rows}
    assert "±" in str(figures[MERITS["gdop_p50"].quantity.heading][0])
    (front,) = answered.interactive
    assert "Bars: how far another sampling may move it." in front.caption
    # no bounds are looked for here (conftest.py)
    assert "Who is on the front: of 3 it is not decided" in front.caption
    assert "elevation mask, deg" in tables["The first Pareto front"].header
    title = "The finalists by objective, and the change from Three areostationary relays"
    assert tables[title].rows[-1][:2] == ("Three areostationary relays", "to compare with")


class Bars:
    def __call__(self, *_):
        return contextlib.nullcontext(self)

    def update(self, n):
        pass


def traded(study, folder):
    with Store(folder, study) as store:
        run_trade(study, store, OneProcess(study), Bars())
    return trade_report(study, folder)


def test_free_variables_are_shown_in_classes(tmp_path, coarse):
    made = traded(read_study_text(TEXT), tmp_path)
    assert made.summary["feasible"] == made.summary["candidates"] == 60
    stems = {p.stem for s in made.sections for p in s.pictures}
    assert "sensitivity-gdop-p50" in stems
    assert "inclination" in made.page


@pytest.mark.browser
def test_candidates_on_any_two_axes(tmp_path, coarse, opened, faults):
    study = read_study_text(TEXT)
    made = traded(study, tmp_path / "store")
    path = write_page(tmp_path / "report", made.page, made.sections)
    browser = opened(path, sum(len(s.pictures) for s in made.sections))

    def title(axis):
        return " ".join(e.text for e in browser.find_elements("css selector", f".title.{axis}"))

    assert (title("x"), title("y")) == (
        "number of satellites", "GDOP, median over area and time"
    )  # fmt: skip
    # the finalists once more, in colours of their own; nobody where GDOP is infinite
    values = [*read_results(study, tmp_path / "store").gdop_p50.values]
    values += [f["figures"]["gdop_p50"] for f in made.summary["finalists"]]

    ticks = [
        t.text for t in browser.find_elements("css selector", ".plot text[text-anchor=middle]")
    ]
    assert all(text.isdigit() for text in ticks if text != title("x") and text not in title("y"))

    def points():
        return len(browser.find_elements("css selector", ".front .plot .point"))

    assert points() == np.isfinite(values).sum() > 5
    assert not browser.find_element("css selector", "img.still").is_displayed()
    plot = browser.find_element("css selector", ".front .plot")
    tip = browser.find_element("css selector", ".front .tip")
    plot.send_keys("\ue014")  # arrow right: the first of the front says what it is
    assert "number of satellites: " in tip.text and "GDOP, median over area and time: " in tip.text
    plot.send_keys("++++")
    assert 0 < points() < np.isfinite(values).sum()
    plot.send_keys("0")
    assert points() == np.isfinite(values).sum()
    menu = browser.find_element("css selector", ".front [name=x]")
    menu.find_element("xpath", "option[text()='inclination']").click()
    assert title("x") == "inclination, deg"
    menu.find_element("xpath", "option[1]").click()
    zoomed_by_hand(browser, points)
    assert faults(browser) == [] and browser.get_log("browser") == []


def zoomed_by_hand(browser, points):
    """Zoom by mouse and by finger: what is kept is what lay within, and all comes back."""
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.actions.action_builder import ActionBuilder
    from selenium.webdriver.common.actions.pointer_input import PointerInput

    svg, everybody = browser.find_element("css selector", ".front .plot svg"), points()
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", svg)
    # a part of the plot about its second candidate from the left, in pixels from its middle
    x, y, left, top, right, bottom, wide, high = browser.execute_script(
        """
        const {points, frame, svg} = document.querySelector(".front").front;
        const one = points.slice().sort((a, b) => a.x - b.x)[1];
        return [one.x, one.y, Math.max(one.x - 40, frame.left), Math.max(one.y - 40, frame.top),
                Math.min(one.x + 40, frame.right), Math.min(one.y + 40, frame.bottom),
                svg.clientWidth, svg.clientHeight].map(Math.round);
        """
    )
    within = browser.execute_script(
        "const [l, t, r, b] = arguments; return document.querySelector('.front').front.points"
        ".filter(p => l <= p.x && p.x <= r && t <= p.y && p.y <= b).length",
        left, top, right, bottom,
    )  # fmt: skip
    assert 0 < within < everybody
    middle = (wide // 2, high // 2)
    drag = ActionChains(browser).move_to_element_with_offset(svg, left - middle[0], top - middle[1])
    drag.click_and_hold().move_by_offset(right - left, bottom - top).release().perform()
    assert points() == within
    ActionChains(browser).double_click(svg).perform()
    assert points() == everybody
    finger = ActionBuilder(browser, mouse=PointerInput("touch", "finger"))
    finger.pointer_action.move_to(svg, x - middle[0], y - middle[1]).pointer_down().pointer_up()
    finger.perform()
    assert "number of satellites: " in browser.find_element("css selector", ".front .tip").text
    for name in ("nearer", "nearer", "nearer"):
        browser.find_element("css selector", f".front [name={name}]").click()
    nearer = points()
    assert 0 < nearer < everybody  # about the candidate that was touched
    browser.find_element("css selector", ".front [name=farther]").click()
    assert nearer <= points() < everybody
    browser.find_element("css selector", ".front [name=all]").click()
    assert points() == everybody


@pytest.fixture
def landing(tmp_path, designs, monkeypatch):
    """A study with entries and two masks, cheap enough for interpreted kernels."""
    text = (designs / "landing.toml").read_text().replace("duration_s = 320", "duration_s = 10")
    text = text.replace("duration_s = 10", "duration_s = 10\nstep_s = 2")
    text = text.replace('[[trigger]]\nname = "parachute deployment"\nmach = 2\n', "")
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")
    (tmp_path / "lander.toml").write_text(text)
    surface = {
        "fold": {"wanted": 1, "outcome": "proven"}, "mask_margin_deg": 3.0,
        "gdop": {"p50": 2.0, "p50_bracket": [1.9, 2.1], "p95": 3.0, "p95_bracket": [2.9, 3.1]},
        "availability": 0.9, "availability_bracket": [0.85, 0.95],
    }  # fmt: skip
    monkeypatch.setattr(ranking, "judge_surface", lambda *_, **__: surface)
    worst = {
        "value": 9.0, "latitude_deg": 0.0, "longitude_deg": 0.0, "azimuth_deg": 0.0,
        "epoch_s": 0.0, "in_view": 1,
    }  # fmt: skip
    monkeypatch.setattr(ranking, "worst_entry", lambda *_, **__: worst | {"after_loss": worst})
    study = TEXT.replace("samples = 60", "samples = 8").replace(
        "fold = 1", "fold = 1\nmask_deg = [0, 5]"
    )
    compare = designs / "areostationary-trio.toml"
    study += f"""
[entry]
scenario = "lander.toml"
samples = 2
finalists = 4
finalist_samples = 2
filter_runs = 2
[compare]
design = "{compare}"
"""
    return read_study_text(study, "landing.toml", tmp_path)


def test_finalists_are_judged_again_and_handed_over(landing, tmp_path, coarse):
    made = traded(landing, tmp_path / "store")
    finalists, ranked = made.summary["finalists"], made.summary["landing"]["designs"]
    assert {row["file"] for row in ranked} == {f["design"] for f in finalists} | {
        landing.compare.label
    }
    assert all(row["nees"] > 0 and row["ekf_position_m"]["p95"] > 0 for row in ranked)
    assert all(row["answer"] in made.page for row in ranked)
    assert "Users on the surface" in made.page and "Hand-over" in made.page
    first = read_design_text(made.files["finalist-1.toml"]).constellation
    messages = [name for name in made.files if name.startswith("finalist-1-oem/")]
    assert len(messages) == first.size
    assert all(made.files[name].startswith("CCSDS_OEM_VERS = 2.0") for name in messages)
    assert json.loads(made.files["finalist-1.czml"])[0]["id"] == "document"
    assert "IAU:2015:49900" in made.files["finalist-1.geojson"]
    for facts in finalists:
        design = read_design_text(made.files[facts["design"]], facts["design"])
        pattern = design.constellation.pattern
        assert (pattern.satellites, pattern.planes, pattern.phasing) == (
            facts["satellites"], facts["planes"], facts["phasing"]
        )  # fmt: skip
        assert np.degrees(pattern.inclination) == pytest.approx(facts["inclination_deg"], abs=1e-12)
        assert design.constellation.semi_major_axis[0] == pytest.approx(
            1e3 * facts["radius_km"], rel=1e-15
        )
        assert np.degrees(design.mask.lowest) == pytest.approx(facts["mask_deg"], abs=1e-12)
        assert design.fold == 1 and facts["role"] in design.source


def test_filter_is_left_out_if_the_study_says_so(landing, tmp_path, coarse):
    without = replace(landing, entry=replace(landing.entry, filter_runs=0))
    made = traded(without, tmp_path / "store")
    assert all(row["nees"] is None for row in made.summary["landing"]["designs"])


@pytest.mark.parametrize(("days", "said"), [(np.nan, "31 days"), (31.5, "31.5 d")])
def test_how_long_it_lasts_is_answered_whether_or_not_a_study_asks(seed_design, days, said, coarse):
    one = replace(finalist(15, 3.0), figures={"days_proven": days})
    row = _lasts(Entrant(one, seed_design, "proven"))
    assert row.written == said and row.holds is None
    assert ("compass drift" in row.evidence) == np.isnan(days)


@pytest.mark.parametrize(
    ("constraint", "words"),
    [
        (Constraint("fold_proven", 1.0, np.inf, False), "the fold, proven"),
        (Constraint("gdop_p95", -np.inf, 10.0, True), "GDOP, 95th percentile below 10"),
        (Constraint("planes", -np.inf, 8.0, False), "at most 8"),
        (Constraint("closest_approach_deg", 1.0, np.inf, False), "at least 1"),
    ],
)
def test_constraints_are_words(constraint, words):
    assert words in _asked(constraint) and "_" not in _asked(constraint)

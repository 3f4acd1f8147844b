"""The page of a paper: the answer first, then what is wrong, then every number."""

import pytest

import compass
from compass.api.reproduce import ReproduceResult
from compass.errors import ArgumentError
from compass.pages.page import write_page
from compass.pages.paper import paper_report, paper_sections
from compass.papers.verdict import Erratum, claim, compare, computed

ROWS = (
    compare("Half-cone angle", "Table 2", "9.57", 9.5705, "deg"),
    compare(
        "Altitude", "Table 1", "20427", 17030.8, "km", erratum=Erratum("it is a radius", 20427.0)
    ),
    compare("Height", "Table 7", "3", 2.0, "km", erratum=Erratum("it is a radius", 3.0)),
    compare("Pass", "Figure 7", "6", 10.45, "h", note="the paper states no mask"),
    claim("Most", "Section 3", "over 7", 6.0, "1", "above 7", lambda most: most > 7),
    computed("Period", "none", 24.6, "h"),
)


def test_the_answer_counts_and_errors_are_told_once():
    sections = paper_sections(ReproduceResult("x", "A paper", ROWS))
    answer, differs, wrong, numbers = sections
    assert answer.paragraphs == (
        "1 of 5 published numbers and statements are reproduced; 2 are shown to be wrong; "
        "2 differ, and the paper is not shown to be wrong.",
    )
    rows = {row.question: row for row in answer.blocks[1].rows}
    assert rows["Reproduced"].written == "1 of 5" and rows["Reproduced"].holds is None
    assert rows["Differ, the paper not shown to be wrong"].holds is False
    assert rows["Computed here, nothing published"].written == "1"
    assert differs.paragraphs[0] == (
        "Figure 7, Pass: 6 h published, 10.45 h computed. The paper states no mask."
    )
    assert wrong.paragraphs == ("It is a radius: Altitude (Table 1); Height (Table 7).",)
    assert sum(len(table.rows) for table in numbers.tables) == len(ROWS)


@pytest.mark.browser
def test_a_page_of_a_paper_in_a_real_browser(tmp_path, monkeypatch, opened):
    report, sections = paper_report(ReproduceResult("x", "A <b>paper</b>", ROWS))
    opened(write_page(tmp_path, report, sections), 0)


def test_report_takes_the_name_of_a_paper(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "compass.pages.report.reproduce", lambda paper: ReproduceResult(paper, "A paper", ROWS)
    )
    made = compass.report("ballard1980", output=tmp_path, command="x")
    page = made.page.read_text(encoding="utf-8")
    assert "2 are shown to be wrong" in page and "<dd>ballard1980</dd>" in page
    assert made.title == "A paper" and "report designs/" not in page
    proposed = paper_sections(ReproduceResult("kelly2018", "A paper", ROWS))[0].blocks[1].rows[-1]
    assert proposed.written == "see compass report designs/compass-15-5-1.toml"


def test_a_paper_reproduced_whole_says_so():
    page, sections = paper_report(ReproduceResult("x", "A paper", ROWS[:1]))
    assert sections[0].paragraphs == (
        "1 of 1 published numbers and statements are reproduced; none differs without that.",
    )
    assert "made from Python" in page and len(sections) == 2


def test_a_paper_of_nearly_that_name_is_offered(tmp_path):
    with pytest.raises(
        ArgumentError, match=r"^kelly2081: no file and no paper; did you mean kelly"
    ):
        compass.report("kelly2081", output=tmp_path / "page")

"""Answers, tables without numbers, and columns on their decimal points."""

import math

from compass.document import Answer, Answers, Page, Proven, Table, Value, html, text
from compass.document.numbers import padding
from compass.quantities import quantity

MASK = quantity("mask_margin_deg")
ANSWERS = Answers(
    "Met?",
    (
        Answer("four in view", "proven", True, "for ever"),
        Answer("margin", Value(MASK, 6.24, Proven("for ever"))),
        Answer("<b>", "no", False),
    ),
)


def test_answers_read_without_colour():
    said = text(Page("x", (ANSWERS,)))
    assert "met" in said and "missed" in said and "6.24 deg" in said
    assert "proven, for ever" in said
    drawn = html(ANSWERS)
    assert '<span class="mark met">met</span>' in drawn
    assert "<b>" not in drawn and "&lt;b&gt;" in drawn


def test_a_table_of_zeros_is_a_sentence():
    rows = (("A", 0, 0.0), ("B", 0, Value(MASK, 0.0)))
    table = Table("Shadows", ("", "count", "longest"), rows, nothing="No shadow of A or B.")
    assert table.empty
    assert text(Page("x", (table,))).split("\n")[1] == "  No shadow of A or B."
    assert "<table" not in html(table) and "No shadow of A or B." in html(table)
    assert not Table("Shadows", ("", "count"), (("A", 1),), nothing="none").empty
    assert not Table("Shadows", ("", "count"), (("A", 0),)).empty
    assert Table("None", ("", "least"), (("A", math.inf), ("B", math.inf)), nothing="none").empty
    assert not Table("Some", ("", "least"), (("A", math.inf), ("B", 0)), nothing="none").empty


def test_long_tables_fold_and_narrow_ones_stand_side_by_side():
    long = Table("Long", ("", "n"), tuple((f"r{k}", k) for k in range(13)))
    assert long.long and not long.narrow
    assert "<details" in html(long) and "(13 rows)" in html(long)
    short = Table("Short", ("", "n"), (("a", 1.5), ("b", 2.25)))
    pair = html(Page("x", (short, short)))
    assert pair.count('<div class="tables">') == 1 and "<details" not in pair


def test_columns_stand_on_their_points():
    assert padding(["1", "2.25", "3.5"]) == [".00", "", "0"]
    assert padding(["1", "20"]) == ["", ""]
    drawn = html(Table("t", ("", "n"), (("a", 1.0), ("b", 2.25))))
    assert '1<span class="pad" aria-hidden="true">.00</span>' in drawn


def test_what_an_answer_stands_on_is_folded_away_on_a_page_and_said_in_full_in_a_terminal():
    short = Answer("q", "1", evidence="sampled, 500 runs of the filter")
    assert short.folded == ("sampled, 500 runs of the filter", "")
    long = Answer("q", "1", evidence="proven: compass drift designs/a.toml --days 33, 1,024 of 2")
    assert long.folded == ("proven", "compass drift designs/a.toml --days 33, 1,024 of 2")
    scoped = Answer("q", Value(MASK, 6.24, Proven("for all time, on undisturbed orbits")))
    assert scoped.folded == ("proven", "for all time, on undisturbed orbits")
    answers = Answers("A", (short, long))
    assert "<summary>proven</summary>compass drift designs/a.toml" in html(answers)
    assert html(answers).count("<summary>") == 1
    assert "proven: compass drift designs/a.toml --days 33" in text(Page("", (answers,)))

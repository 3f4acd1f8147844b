import pytest

from compass.document import (
    Details,
    Page,
    Picture,
    Section,
    Sentence,
    Table,
    Value,
    Verdict,
    html,
    text,
)
from compass.document.blocks import columns, facts, walk
from compass.document.evidence import Bracket, Proven, Sampled
from compass.document.html import alone, prose
from compass.quantities import quantity

MASK, FOLD = quantity("mask_margin_deg"), quantity("min_fold")


def page():
    return Page(
        "A <b>name</b>",
        (
            Verdict("proven", "4 <in view>", True),
            facts("Margins", [Value(FOLD, 4, Proven("ever")), Value(MASK, 6.238541)]),
            Details("More", (Sentence("a & b " * 40),)),
            Section("Part", (Table("Empty", ("x",), ()), Picture("p", "t", "c", b"png"))),
            Table("Long", ("name", "value"), tuple((f"n{k}", 10.0**k) for k in range(9)), 3),
        ),
    )


def test_text_has_the_answer_first():
    lines = text(page()).splitlines()
    assert lines[0] == "A <b>name</b>: PROVEN: 4 <in view>"
    assert max(map(len, lines)) <= 100
    assert "... and 6 more; JSON has them all" in lines
    assert "Empty" not in lines


def test_decimal_points_stand_below_each_other():
    lines = text(Page("x", (facts("T", [Value(MASK, 6.238), Value(FOLD, 14), Value(MASK, -0.5)]),)))
    rows = lines.splitlines()[-3:]
    places = [rows[0].index("6") + 1, rows[1].index("14") + 2, rows[2].index(".5")]
    assert len(set(places)) == 1


def test_html_escapes_what_a_user_wrote_and_shows_the_same_numbers():
    drawn = html(page())
    assert "<b>name" not in drawn and "&lt;b&gt;name" in drawn
    assert '<p class="verdict met"><strong>proven</strong>: 4 &lt;in view&gt;' in drawn
    assert "6.24" in drawn and "6.24" in text(page())
    assert "<details><summary>More</summary>" in drawn
    assert 'alt="t"' in drawn and drawn.count('<div class="pictures">') == 1
    assert "http" not in drawn  # nothing is fetched


def test_one_block_alone_and_an_open_verdict():
    assert 'class="verdict open"' in html(Verdict("", "who knows"))
    assert text(Page("x", (Sentence("a"), Verdict("", "b")))).endswith("b")


def test_columns_take_their_headings_from_the_quantities():
    table = columns("T", [[Value(FOLD, 4), Value(MASK, 1.0, whose="exact")]])
    assert table.header == ("least fold", "highest mask with the fold, exact, deg")
    assert columns("T", []).header == ()


def test_walking_finds_blocks_inside_blocks():
    kinds = [type(block).__name__ for block in walk(page().blocks)]
    assert kinds == [
        "Verdict", "Table", "Details", "Sentence", "Section", "Table", "Picture", "Table",
    ]  # fmt: skip


def test_what_is_known_alike_of_all_is_said_once():
    alike = facts("M", [Value(FOLD, 4, Proven("ever")), Value(MASK, 6.238541, Proven("ever"))])
    assert (alike.title, alike.header) == ("M (proven, ever)", ("", "value", "unit"))
    assert str(alike.rows[1][1]) == "6.23"  # still never better than what was proven
    mixed = facts("M", [Value(FOLD, 4, Proven("ever")), Value(MASK, 6.2)])
    assert (mixed.title, mixed.header[-1]) == ("M", "evidence")
    assert facts("M", [Value(FOLD, 4, Proven("ever"))]).header[-1] == "evidence"
    # what there is none of has nothing to be known, and makes no column of its own
    without = facts("M", [Value(FOLD, 4, Proven("ever")), Value(MASK, None)])
    assert (without.title, without.header[-1]) == ("M (proven, ever)", "unit")


def test_what_most_rows_say_of_how_known_they_are_is_said_once():
    once, other = Proven("ever"), Proven("today")
    most = facts("M", [Value(FOLD, k, once) for k in range(4)] + [Value(MASK, 6.2, other)])
    assert most.title == "M (proven, ever, where nothing else is said)"
    assert [row[-1] for row in most.rows] == ["", "", "", "", "proven, today"]


@pytest.mark.parametrize(
    ("error", "written"),
    [(3.7e-7, "25.00000 ± 0.00004"), (0.012, "25.0 ± 1.2"), (1e-10, "25.00000 ± 0.00001")],
)
def test_an_error_has_no_power_of_ten(error, written):
    share = quantity("requirement_share")
    assert str(Value(share, 0.25, Sampled(error))) == written


def test_a_picture_is_alone_where_none_can_stand_beside_it():
    half, wide = Picture("p", "p", "", b"<svg"), Picture("w", "w", "", b"<svg", wide=True)
    rows = [half, half, half, wide, half, Sentence("x"), half, half]
    found = [
        alone(each, rows[k + 1] if k + 1 < len(rows) else None, rows[:k])
        for k, each in enumerate(rows)
    ]
    assert found == [False, False, True, False, True, False, False, False]


def test_bounds_of_a_share_next_to_nothing_have_no_power_of_ten():
    share = quantity("requirement_share")
    assert str(Value(share, 0.0, Bracket(0.0, 1.0067e-10))) == "0 to 0.0001"
    assert str(Value(share, 0.0, Bracket(3e-7, 4e-6))) == "0 to 0.0004"


def test_code_in_a_source_is_set_as_code_and_all_else_stays_text():
    said = str(prose("by `a <b>` of <i>$x_1$</i>"))
    assert said == "by <code>a &lt;b&gt;</code> of &lt;i&gt;$x_1$&lt;/i&gt;"
    assert str(prose("one ` alone <b>")) == "one ` alone &lt;b&gt;"

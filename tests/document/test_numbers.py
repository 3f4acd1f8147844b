import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.document import Bracket, Proven, Sampled, Value
from compass.document.numbers import cell, significant
from compass.errors import ArgumentError
from compass.quantities import QUANTITIES, Quantity, quantity


@given(st.floats(-1e14, 1e14), st.integers(2, 9))
def test_a_number_is_written_to_its_digits_and_reads_back(value, digits):
    written = significant(value, digits)
    read = float(written.replace(",", ""))
    # half a unit of the last digit; before the decimal point nothing is rounded to tens
    unit = 10.0 ** math.floor(math.log10(abs(value))) if value else 1.0
    # and the nearest double of what was written may lie a rounding away
    half = min(max(0.5 * unit * 10 ** (1 - digits), 0.0), 0.5)
    assert abs(read - value) <= half * (1 + 1e-9) + 4e-16 * abs(value)


@pytest.mark.parametrize(
    ("value", "digits", "written"),
    [
        (6.238541, 3, "6.24"),
        (45.0, 4, "45"),
        (20427.0, 3, "20427"),
        (60422241.3, 5, "60,422,241"),
        (1e-9, 3, "1e-9"),
        (0.0, 3, "0"),
        (math.inf, 3, "∞"),
        (-math.inf, 3, "-∞"),
        (math.nan, 3, "none"),
    ],
)
def test_what_a_reader_sees(value, digits, written):
    assert significant(value, digits) == written


def test_a_value_is_written_by_what_it_means():
    assert str(Value(quantity("fold_proven"), True)) == "yes"
    assert str(Value(quantity("fold_proven"), 0)) == "no"
    assert str(Value(quantity("min_fold"), 4)) == "4"
    assert str(Value(quantity("min_fold"), 3, Bracket(3, 4))) == "3 to 4"
    assert str(Value(quantity("min_fold"), 3, Bracket(3, 3))) == "3"
    assert str(Value(quantity("fold_share"), 0.41687)) == "41.687"
    assert str(Value(quantity("fold_share"), 0.5, Sampled(0.001))) == "50.00 ± 0.10"
    assert str(Value(quantity("mask_margin_deg"), None)) == "none"
    assert str(Value(quantity("mask_margin_deg"), "open")) == "open"
    assert str(Value(quantity("mask_deg"), 5.0, whose="exact")) == "5"
    assert Value(quantity("mask_deg"), 5.0, whose="exact").title == "elevation mask, exact"
    assert [cell(x) for x in (None, True, 2, 2.5, "a")] == ["", "yes", "2", "2.5", "a"]


@pytest.mark.parametrize(
    ("value", "error", "digits", "written"),
    [
        (9.83124, 0.0023, 4, "9.8312 ± 0.0023"),
        (9.8, 0.0023, 4, "9.8000 ± 0.0023"),  # zeros that are known
        (9.83124, 0.0996, 3, "9.83 ± 0.10"),
        (9.83124, 5.23, 3, "9.8 ± 5.2"),
        (12345.6, 231.0, 3, "12346 ± 231"),
        (12345.6, 2.31, 3, "12346 ± 3"),
        (9.83124, 0.0023, 3, "9.831 ± 0.003"),  # finer than anyone reads: rounded up
        (9.83124, 1.2e-9, 3, "9.831 ± 0.001"),
        (3.2104e-6, 1.1e-7, 3, "3.21e-6 ± 0.11e-6"),
        (0.0, 0.0023, 3, "0.0000 ± 0.0023"),
        (-9.83124, 0.0023, 4, "-9.8312 ± 0.0023"),
        (9.83124, 0.0, 3, "9.83"),
        (math.inf, 0.1, 3, "∞"),
        (9.83124, math.inf, 3, "9.83 ± ∞"),
    ],
)
def test_a_figure_and_its_error_have_the_same_decimals(value, error, digits, written):
    of = Quantity("range_m", "m", "range", digits)
    assert str(Value(of, value, Sampled(error))) == written


@given(st.floats(-1e14, 1e14), st.floats(1e-12, 1e12), st.integers(2, 6))
def test_an_error_is_never_written_finer_than_its_figure_nor_smaller_than_it_is(
    value, error, digits
):
    written = str(Value(Quantity("range_m", "m", "range", digits), value, Sampled(error)))
    figure, doubt = (part.replace(",", "").partition("e") for part in written.split(" ± "))
    assert figure[2] == doubt[2]  # one power of ten
    assert len(figure[0].partition(".")[2]) == len(doubt[0].partition(".")[2])
    told = float("".join(doubt))
    assert 0.949 * error <= told
    last = 10.0 ** -len(doubt[0].partition(".")[2]) * 10.0 ** int(doubt[2] or 0)
    assert abs(float("".join(figure)) - value) <= 0.5001 * last + 4e-16 * abs(value)
    assert told <= max(1.051 * error, error + 1.0001 * last)


def test_evidence_says_how_well():
    assert str(Proven("for all time")) == "proven, for all time"
    assert str(Bracket(1, 2)) == "between proven bounds"
    assert str(Sampled(None, "109 epochs")) == "sampled, 109 epochs, error not known"
    with pytest.raises(ValueError, match="not in order"):
        Bracket(2, 1)


def test_every_quantity_says_what_it_is():
    for name, record in QUANTITIES.items():
        assert record.name == name
        assert record.title and record.meaning.endswith("."), name
        assert record.digits >= 1
        if record.form == "share" or record.unit == "1":
            assert record.shown_unit == ("%" if record.form == "share" else "")
        assert "-1" not in record.shown_unit
        assert record.attributes()["long_name"] == record.title
        # the name carries the unit
        if record.form == "real" and record.unit in ("deg", "km", "m", "s", "h", "km2", "rad"):
            assert any(part.endswith(f"_{record.unit}") for part in name.split(".")), name


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("delta_v_keeping_m_s_year", "m/s/year"),
        ("access.least_cn0_dbhz", "dB Hz"),
        ("access.largest_range_rate_km_s", "km/s"),
        ("room_deg", "deg"),
    ],
)
def test_a_unit_is_shown_as_people_write_it(name, shown):
    assert quantity(name).shown_unit == shown


def test_bounds_are_rounded_to_their_own_sides():
    share, dilution = QUANTITIES["availability"], QUANTITIES["gdop"]
    assert str(Value(share, 0.97, Bracket(0.97364159, 0.97367801))) == "97.364 to 97.368"
    assert str(Value(dilution, 3.4, Bracket(3.4059, 3.4101))) == "3.4 to 3.42"
    assert str(Value(dilution, 3.4, Bracket(2.5, float("inf")))) == "2.5 to ∞"
    wide = Value(share, 0.5, Bracket(0.00724262, 0.708544))  # what the width does not know is left
    assert str(wide) == "0.7 to 70.9"


def test_a_wrong_name_is_answered_with_the_near_ones():
    with pytest.raises(ArgumentError, match="did you mean mask_margin_deg"):
        quantity("mask_margin")
    with pytest.raises(ArgumentError, match="known: "):
        quantity("zzzz")

"""Numbers in sentences."""

import pytest

from compass.words import counted, days_words


@pytest.mark.parametrize(
    ("noun", "many"),
    [("epoch", "epochs"), ("batch", "batches"), ("pass", "passes"), ("day", "days")],
)
def test_one_is_one_and_all_others_are_many(noun, many):
    assert [counted(n, noun) for n in (0, 1, 2)] == [f"0 {many}", f"1 {noun}", f"2 {many}"]


@pytest.mark.parametrize(
    ("days", "said"),
    [(0.7, "0.7 days"), (1.02996, "1.02 days"), (1.0, "1 day"), (31.99, "31 days")],
)
def test_days_that_something_lasts_are_never_more_than_it_does(days, said):
    assert days_words(days) == said

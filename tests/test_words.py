"""Numbers in sentences."""

import pytest

from compass.words import counted


@pytest.mark.parametrize(
    ("noun", "many"),
    [("epoch", "epochs"), ("batch", "batches"), ("pass", "passes"), ("day", "days")],
)
def test_one_is_one_and_all_others_are_many(noun, many):
    assert [counted(n, noun) for n in (0, 1, 2)] == [f"0 {many}", f"1 {noun}", f"2 {many}"]

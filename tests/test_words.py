"""Numbers in sentences."""

import pytest

from compass.words import capital, counted, days_words, latitude_words, longitude_words, place_words


@pytest.mark.parametrize(
    ("noun", "many"),
    [("epoch", "epochs"), ("batch", "batches"), ("pass", "passes"), ("day", "days")],
)
def test_one_is_one_and_all_others_are_many(noun, many):
    assert [counted(n, noun) for n in (0, 1, 2)] == [f"0 {many}", f"1 {noun}", f"2 {many}"]


@pytest.mark.parametrize(
    ("days", "said"),
    [
        (0.7, "0.7 days"),
        (1.02996, "1.02 days"),
        (1.0, "1 day"),
        (31.99, "31 days"),
        (0.0099, "14 minutes"),
        (0.0007, "1 minute"),
        (0.0005, "less than a minute"),
    ],  # fmt: skip,
)
def test_days_that_something_lasts_are_never_more_than_it_does(days, said):
    assert days_words(days) == said


def test_a_sentence_begins_with_a_capital_and_keeps_its_names():
    assert [capital(words) for words in ("", "a DSAC in Gale", "PDOP")] == [
        "", "A DSAC in Gale", "PDOP",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("degrees", "said"),
    [
        (41.834, "41.83° N"),
        (-90.0, "90.00° S"),
        (5.7e-14, "the equator"),
        (-0.004, "the equator"),
        (-0.2, "0.20° S"),
    ],
)
def test_latitudes_are_north_or_south(degrees, said):
    assert latitude_words(degrees) == said


@pytest.mark.parametrize(
    ("degrees", "said"),
    [
        (10.67, "10.67° E"),
        (-10.67, "10.67° W"),
        (349.33, "10.67° W"),
        (-0.001, "0.00° E"),
        (180.0, "180.00° E"),
        (-180.0, "180.00° E"),
        (540.0, "180.00° E"),
    ],
)
def test_longitudes_are_east_or_west(degrees, said):
    assert longitude_words(degrees) == said
    assert place_words(-1.5, degrees, ".1f").startswith("1.5° S, ")

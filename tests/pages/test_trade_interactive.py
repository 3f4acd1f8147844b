"""The front on any two axes, whatever its figures are."""

import pytest

from compass.pages import trade_interactive as module


@pytest.mark.parametrize(
    ("columns", "tick"),
    [
        ([[5.0, 6.0], [7.0]], 1),
        ([[5.0, 6.5]], None),
        ([[0.0], [1e4]], None),
        ([[None, None], [None]], None),  # nobody sees four satellites: GDOP infinite everywhere
    ],
)
def test_ticks_between_the_numbers_of_an_axis(columns, tick):
    assert module._tick(columns) == tick

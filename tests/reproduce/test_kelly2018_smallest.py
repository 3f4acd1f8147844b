"""The paper's minimum of 15 satellites does not hold."""

import pytest

from compass.reproduce.kelly2018_smallest import rows


@pytest.mark.slow
def test_fifteen_is_not_the_minimum():
    covered, margin, fewest = rows()
    assert covered.verdict == "reproduced"
    assert "fold 4 to 9" in covered.computed
    assert margin.computed == pytest.approx(6.24, abs=0.01)
    assert fewest.verdict.startswith("erratum")
    assert fewest.computed.startswith("13:")
    assert fewest.holds

"""The paper's minimum of 15 satellites does not hold."""

import numpy as np
import pytest

from compass.coverage.margin import CoveringRadius
from compass.orbits import walker_delta
from compass.papers import kelly2018_smallest as paper
from compass.papers.kelly2018_smallest import rows
from compass.study.search import Candidate


@pytest.mark.slow
def test_fifteen_is_not_the_minimum(every_row_can_fail):
    covered, margin, fewest = rows()
    every_row_can_fail([covered, margin, fewest])
    assert covered.verdict == "reproduced"
    assert "fold 4 to 9" in covered.computed
    assert margin.computed == pytest.approx(6.24, abs=0.01)
    assert fewest.verdict == "erratum"
    assert fewest.computed.startswith("13;")


@pytest.mark.parametrize(
    ("size", "proven", "verdict"),
    [(13, True, "erratum"), (13, False, "differs"), (15, True, "reproduced")],
)
def test_the_verdict_follows_the_search(monkeypatch, size, proven, verdict):
    best = walker_delta(size, size, 2, inclination_deg=45.8, radius_km=paper.RADIUS / 1e3)
    found = [Candidate(best, 1.34, 0.05, 0.5, proven=proven)]
    monkeypatch.setattr(paper, "search", lambda *_args, **_options: found)
    monkeypatch.setattr(paper, "fold_range", lambda *_args, **_options: ((4, 4), (9, 9)))
    monkeypatch.setattr(paper, "highest_mask", lambda *_args, **_options: 0.1)
    monkeypatch.setattr(
        paper, "covering_radius", lambda *_: CoveringRadius(1.3, 1.3, 0.0, np.zeros(3))
    )
    covered, _, fewest = rows()
    assert covered.verdict == "reproduced"  # the certificate itself takes one interval
    assert fewest.verdict == verdict

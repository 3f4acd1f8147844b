"""The chapter's rows at a small size: coarse epochs, few runs, searches replaced by known places."""

import numpy as np
import pytest

from compass.entry.search import Optimum, Start
from compass.papers import yu2018, yu2018_case, yu2018_ground, yu2018_orbiters

PLACES = np.radians(
    [[-27.297, -82.7228], [-27.209, -82.7385], [-25.6395, -73.2034]]
)  # what the full search finds


@pytest.fixture
def coarse(monkeypatch):
    def found(value, parameters):
        start = Start(value, parameters, (value,), 1)
        return lambda *args, **options: Optimum("test", value, parameters, (start,), 1.0)

    caches = (yu2018_case.ground_flight, yu2018_case.orbiter_flight, yu2018_ground.best_ground)
    for cache in caches:
        cache.cache_clear()
    monkeypatch.setattr(yu2018_case, "TIMES", np.arange(0.0, 241.0, 5.0))
    monkeypatch.setattr(yu2018_case, "RUNS", 4)
    for module in (yu2018_ground, yu2018_orbiters):
        monkeypatch.setattr(module, "best_ground_beacons", found(1.64e-8, PLACES))
    monkeypatch.setattr(yu2018_orbiters, "best_orbiters", found(239.85, np.zeros((3, 3))))
    yield
    for cache in caches:
        cache.cache_clear()


def test_rows_at_a_small_size(coarse):
    rows = yu2018.rows()
    assert len(rows) == 37
    assert all(row.holds for row in rows)
    integral = next(row for row in rows if row.where == "Table 6")
    # Simpson's rule with steps of 5 s instead of 1 s: its error grows by 5^4
    assert integral.computed == pytest.approx(236.8509921, abs=1e-3)
    swapped = next(row for row in rows if row.where == "eq. 1")
    assert swapped.computed == pytest.approx(33.7, abs=0.05)
    assert swapped.verdict.startswith("erratum")
    optimum = next(row for row in rows if row.where == "Figure 4")
    assert optimum.computed == "2 west, 1 east"

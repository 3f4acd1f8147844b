"""The chapter's rows at a small size: coarse epochs, few runs, searches replaced by known places."""

from types import SimpleNamespace

import numpy as np
import pytest

from compass.entry.search import Optimum, Start
from compass.papers import (
    yu2018,
    yu2018_case,
    yu2018_ground,
    yu2018_information,
    yu2018_orbiters,
)

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


#: What neither agrees nor is shown to be wrong, at the small size.
DIFFER = {
    "Best minimum of delta over the entry (SI)",
    "Largest delta, beacons of Figure 4's words (SI)",
    "Time of 241 epochs, exact method",
}


def test_rows_at_a_small_size(coarse, every_row_can_fail):
    found = yu2018.rows()
    every_row_can_fail(found)
    rows = {row.item: row for row in found}
    assert len(rows) >= 56
    assert {item for item, row in rows.items() if not row.holds} >= DIFFER
    largest = rows["Largest delta, beacons of Figure 4's words (SI)"]
    assert largest.told.startswith("differs: -21 %")
    integral = rows["Integral of det N over 240 s, orbiters of Table 6"]
    # Simpson's rule with steps of 5 s instead of 1 s: its error grows by 5^4
    assert integral.computed == pytest.approx(236.8509921, abs=1e-3)
    swapped = next(row for row in rows.values() if row.where == "eq. 1")
    assert swapped.found[0] == pytest.approx(33.7, abs=0.05)
    assert swapped.verdict == "erratum"
    optimum = next(row for item, row in rows.items() if item.startswith("Beacons of the optimum"))
    assert (optimum.verdict, optimum.computed) == ("reproduced", "2 west, 1 east")


def test_equations_can_fail(every_row_can_fail):
    rows = yu2018_information.information_rows()
    every_row_can_fail(rows)
    assert all(row.holds for row in rows)


def test_a_wrong_information_is_found_out(monkeypatch):
    """Noise entering as sigma^-1 instead of sigma^-2, and range rates without the distance."""
    right, rates = yu2018_information.range_information, yu2018_information.rate_information
    monkeypatch.setattr(
        yu2018_information, "range_information", lambda n, s: right(n, np.sqrt(np.asarray(s)))
    )
    monkeypatch.setattr(
        yu2018_information, "rate_information", lambda n, r, v, s: rates(n, 2 * r, v, s)
    )
    wrong = {row.where for row in yu2018_information.information_rows() if not row.holds}
    assert {"eq. 31", "eq. 40", "eqs. 43 to 45", "eq. 46"} <= wrong


def test_a_failed_integration_is_no_end_of_the_flight(monkeypatch):
    """The last state that there is would be of an earlier moment."""
    flown = SimpleNamespace(
        success=False, t=np.array([0.0, 7.0]), message="step too small", y=np.zeros((6, 2))
    )
    monkeypatch.setattr(yu2018, "solve_ivp", lambda *_, **__: flown)
    with pytest.raises(RuntimeError, match=r"Newton's law at 7 s of .*: step too small"):
        yu2018.newton_end()

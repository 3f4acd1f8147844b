"""Percentiles from an estimate: whatever it is, bounds hold, come near, and tell a limit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.coverage import certified_percentile as about
from compass.coverage.certified_percentile import certified_percentile, percentile_about
from compass.coverage.certified_places import Circle
from compass.coverage.certified_share import CertifiedShare
from compass.orbits import walker_delta

RING = walker_delta(5, 5, 1, inclination_deg=50, radius_km=20000)


class Known:
    """A search whose shares are those of a law with a known percentile, as near as boxes allow."""

    scope = "by a law"

    def __init__(self, truth, tail):
        self.truth, self.tail, self.asked = truth, tail, []

    def share(self, limit, width, *, budget_boxes, level, **_):
        """Bounds half as wide for twice the boxes, until they tell the level."""
        beyond = 0.05 * (self.truth / limit) ** self.tail
        share, boxes = max(1.0 - beyond, 0.0), 100
        self.asked.append(limit)
        while abs(share - level) <= 50.0 / boxes and boxes < budget_boxes:
            boxes *= 2
        ends = np.clip((share - 30.0 / boxes, share + 20.0 / boxes), 0.0, 1.0)
        return CertifiedShare(*ends.tolist(), boxes, self.scope)


def bounds(truth, guess, monkeypatch, tail=2.0, **options):
    """Bounds by such a search."""
    search = Known(truth, tail)
    monkeypatch.setattr(about, "Search", lambda *_: search)
    wanted = {"precision": 0.05, "budget_boxes": 4_000_000, **options}
    return percentile_about(RING, 95, guess, **wanted), search


@given(st.floats(1.5, 5e4), st.floats(-2.0, 2.0), st.floats(1.0, 8.0))
def test_whatever_the_estimate_bounds_hold_and_come_near(truth, off, tail):
    with pytest.MonkeyPatch.context() as patch:
        found, search = bounds(truth, truth * math.exp(off), patch, tail)
        assert found.low < truth <= found.high
        wide = 0.2 if found.stopped else 0.05  # a level may stay too near to tell
        assert found.high - found.low <= wide * found.high
        assert len(search.asked) <= 40
        # a good estimate takes two limits, unless one is too near to tell, or it is large
        good, search = bounds(truth, truth, patch, tail, precision=0.4)
        assert good.low < truth <= good.high
        assert truth > about.LARGE or (not good.stopped and len(search.asked) == 2)


def test_a_level_too_near_to_tell_is_left_for_one_farther_out(monkeypatch):
    """One of the first limits tried is the percentile itself, for ever undecided."""
    reach = math.exp(-0.45 * math.log(1 - 0.05))
    found, search = bounds(6.0, 6.0 / reach, monkeypatch)
    assert any(limit == pytest.approx(6.0) for limit in search.asked)
    assert found.low < 6.0 < found.high < 6.0 * 1.2


@pytest.mark.parametrize("truth", [2.0, 4.0, 4.0 * math.sqrt(2.0)])
def test_bisection_that_meets_the_percentile_itself_looks_beside_it(truth, monkeypatch):
    monkeypatch.setattr(about, "Search", lambda *_: Known(truth, 2.0))
    found = certified_percentile(RING, 95, precision=1e-3, budget_boxes=4_000_000)
    assert found.stopped == "nearer than shares can tell" and found.open is None
    assert found.low < truth <= found.high < 1.05 * found.low
    # with few boxes farther out, and with next to none as before
    few = certified_percentile(RING, 95, budget_boxes=100_000)
    assert few.low < truth <= few.high < 1.3 * few.low
    none = certified_percentile(RING, 95, budget_boxes=1)
    assert none.low < truth < none.high


@pytest.mark.parametrize(("truth", "limit"), [(9.9, 10.0), (10.1, 10.0)])
def test_a_limit_between_the_bounds_is_told(truth, limit, monkeypatch):
    found, _ = bounds(truth, truth, monkeypatch, precision=0.4, limits=(limit,))
    assert (found.high < limit) if truth < limit else (found.low > limit)
    assert found.low < truth < found.high


def test_what_boxes_end_is_said_and_infinity_found(monkeypatch):
    short, _ = bounds(6.0, 50.0, monkeypatch, budget_boxes=300)
    assert short.stopped == "boxes" and short.low < 6.0 < short.high
    for guess in (math.inf, 5.0):
        rare, _ = bounds(1e9, guess, monkeypatch)
        assert (rare.low, rare.high, rare.stopped) == (1e5, math.inf, "")
    few = percentile_about(RING.without(range(2)), 95, 5.0, precision=0.1, budget_boxes=100)
    assert few.low == few.high == math.inf


@pytest.mark.slow
@pytest.mark.parametrize("guess", [1.5, 4.0, math.inf])
def test_bounds_are_those_of_bisection(guess):
    pattern = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    options = {"place": Circle(0.2), "precision": 0.02, "budget_boxes": 1e6}
    known = certified_percentile(pattern, 95, **options)
    found = percentile_about(pattern, 95, guess, **options)
    assert max(found.low, known.low) < min(found.high, known.high)
    assert not found.stopped and found.high - found.low <= 0.02 * found.high


@pytest.mark.parametrize("guess", [math.inf, 1582.0])
def test_one_as_good_as_infinite_gets_a_lower_bound_within_few_boxes(guess, monkeypatch):
    """Shares of large limits cannot be told from the percentage: samples say anything."""
    found, search = bounds(1e9, guess, monkeypatch, precision=0.5, budget_boxes=200_000)
    assert found.low >= 30.0 and found.high == math.inf
    assert search.asked[0] < 100.0

"""Percentiles: whatever is known before, bounds hold, come near, and tell a limit."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.coverage import certified_percentile as module
from compass.coverage import certified_rounds as rounds
from compass.coverage.certified_distribution import Below, Boxes, Limit
from compass.coverage.certified_percentile import certified_percentile, certified_percentiles
from compass.coverage.certified_places import Circle
from compass.coverage.certified_share import Search, certified_share
from compass.coverage.region import convex_polygon
from compass.frames import FIGURES
from compass.inputs.study import Constraint
from compass.orbits import walker_delta
from compass.sites import Mask

SPHERE = FIGURES["iau-sphere"]
RING = walker_delta(5, 5, 1, inclination_deg=50, radius_km=20000)
PATTERN = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)


class Known:
    """Shares of a law with a known 95th percentile, as near as boxes allow: 30 over their width."""

    def __init__(self, truth, tail):
        self.truth, self.tail, self.asked, self.closed = truth, tail, [], []
        self.rounds = SimpleNamespace(stopped="", left=math.inf, begin=self.begin)
        self.boxes = Boxes(np.empty((0, 8)), np.zeros((2, 1)), 0.0, np.ones(1))

    def begin(self, budget_s, budget_boxes):
        self.rounds.left = budget_boxes

    def shares(self, limits):
        """Bounds of the width asked for, off their middle by a third of it."""
        found, self.last = [], {limit.at for limit in limits}
        for limit in limits:
            if limit.width == math.inf:
                found.append(Below(0.0, 1.0))
                continue
            width = max(limit.width, 30.0 / max(self.rounds.left, 1.0))
            cost = 30.0 / width
            self.boxes.looked += int(cost)
            self.rounds.left -= cost
            self.rounds.stopped = "boxes" if self.rounds.left <= 0.0 else ""
            share = max(1.0 - 0.05 * (self.truth / limit.at) ** self.tail, 0.0)
            self.asked.append(limit.at)
            found.append(Below(max(share - width / 3, 0.0), min(share + 2 * width / 3, 1.0)))
        return found

    def close_in(self, ends):
        """Each end is one of the limits looked at last, so that boxes can be told from it."""
        values = self.last
        for low, high in ends.values():
            assert low == 0.0 or low in values
            assert high == math.inf or high in values
        self.closed.append(ends)


def bounds(truth, guess, monkeypatch, tail=2.0, **options):
    """Bounds by such a law."""
    law = Known(truth, tail)

    def lay_out(question, count, workers, boxes=None):
        return law

    monkeypatch.setattr(module, "Distribution", lay_out)
    wanted = {"precision": 0.05, **options}
    return certified_percentile(RING, 95, guess=guess, **wanted), law


@given(st.floats(0.6, 5e4), st.floats(-2.0, 2.0), st.floats(1.0, 8.0), st.booleans())
def test_whatever_is_known_before_bounds_hold_and_come_near(truth, off, tail, guessed):
    with pytest.MonkeyPatch.context() as patch:
        guess = truth * math.exp(off) if guessed else None
        for precision in (0.4, 0.05, 1e-3):
            found, law = bounds(truth, guess, patch, tail, precision=precision)
            assert found.low < truth <= found.high
            assert not found.stopped and found.high - found.low <= precision * found.high
            assert len(law.asked) <= 60
            # the share that a step of the value is worth, a few times over
            assert law.boxes.looked <= 4e4 / precision


def test_a_good_estimate_takes_two_limits(monkeypatch):
    found, law = bounds(6.0, 6.0, monkeypatch)
    assert len(law.asked) == 2 and found.low < 6.0 < found.high


@pytest.mark.parametrize("truth", [2.0, 4.0, 4.0 * math.sqrt(2.0), 45.254834])
def test_one_that_is_itself_a_limit_is_told_by_others_beside_it(truth, monkeypatch):
    found, law = bounds(truth, None, monkeypatch, precision=1e-3)
    assert any(limit == pytest.approx(truth) for limit in law.asked)
    assert found.low < truth <= found.high <= found.low / (1 - 1e-3)
    assert not found.stopped


@pytest.mark.parametrize(("truth", "limit"), [(9.9, 10.0), (10.1, 10.0)])
def test_a_limit_between_the_bounds_is_told(truth, limit, monkeypatch):
    found, law = bounds(truth, truth, monkeypatch, precision=0.4, limits=(limit,))
    assert (found.high < limit) if truth < limit else (found.low > limit)
    assert found.low < truth < found.high
    for strict in (False, True):  # either end of the bounds says the same of a study's limit
        allowed = Constraint("gdop_p95", -math.inf, limit, strict)
        assert allowed.holds([found.low, found.high]).tolist() == 2 * [truth < limit]
    assert law.closed[-1][0][0] < limit < law.closed[-1][0][1]  # its boxes are still there
    # one outside takes nothing
    free, other = bounds(truth, truth, monkeypatch, precision=0.4, limits=(20.0,))
    assert (free.low, free.high) != (found.low, found.high) and max(other.asked) < 19.0


@pytest.mark.parametrize("above", [True, False])
def test_a_limit_that_is_itself_a_bound_is_told(above, monkeypatch):
    """A percentile known to be at most 4 may be 4, which is not below it."""
    free, _ = bounds(6.0, 6.0, monkeypatch, precision=0.4)
    limit = free.high if above else free.low
    found, _ = bounds(6.0, 6.0, monkeypatch, precision=0.4, limits=(limit,))
    for strict in (False, True):
        allowed = Constraint("gdop_p95", -math.inf, limit, strict)
        assert allowed.holds([found.low, found.high]).tolist() == 2 * [above]


def test_what_boxes_end_is_said_and_infinity_found(monkeypatch):
    short, _ = bounds(6.0, 50.0, monkeypatch, budget_boxes=300)
    assert short.stopped == "boxes" and short.low < 6.0 < short.high
    for guess in (None, math.inf, 5.0):
        rare, law = bounds(1e9, guess, monkeypatch)
        assert (rare.low, rare.high, rare.stopped) == (1e5, math.inf, "")
        assert law.boxes.looked < 1e6
    few = certified_percentiles(RING.without(range(2)), (50, 95), precision=0.1)
    assert all(one.low == one.high == math.inf for one in few.of.values())


@pytest.mark.parametrize("guess", [math.inf, 1582.0])
def test_one_as_good_as_infinite_gets_a_lower_bound_within_few_boxes(guess, monkeypatch):
    """Shares of large limits cannot be told from the percentage: samples say anything."""
    found, law = bounds(1e9, guess, monkeypatch, precision=0.5, budget_boxes=20_000)
    assert found.low >= 30.0 and found.high == math.inf
    assert law.asked[0] < 100.0


@pytest.mark.slow
@pytest.mark.parametrize("dop", ["gdop", "tdop"])
def test_all_at_once_are_those_of_shares_at_their_bounds(dop):
    options = {"place": Circle(0.2), "dop": dop}
    found = certified_percentiles(PATTERN, (50, 90, 99), precision=0.02, **options)
    for percent, one in found.of.items():
        assert not one.stopped and one.high - one.low <= 0.02 * one.high
        above = certified_share(PATTERN, max(one.high, 1.0), width=1e-5, **options)
        assert above.high >= percent / 100
        if one.low >= 1.0:
            below = certified_share(PATTERN, one.low, width=1e-5, **options)
            assert below.low < percent / 100
    # each by itself, from an estimate, and in two halves
    for percent, one in found.of.items():
        again = certified_percentile(PATTERN, percent, precision=0.02, guess=5.0, **options)
        assert max(again.low, one.low) < min(again.high, one.high)
    coarse = certified_percentiles(PATTERN, (50, 90, 99), precision=0.02, budget_boxes=1500,
                                   **options)  # fmt: skip
    assert any(one.stopped == "boxes" for one in coarse.of.values())
    fine = certified_percentiles(PATTERN, (50, 90, 99), precision=0.02, start=coarse, **options)
    for percent, one in fine.of.items():
        before = coarse.of[percent]
        assert before.low <= one.low < one.high <= before.high and not one.stopped
    assert fine.boxes.looked > coarse.boxes.looked


@pytest.mark.slow
@pytest.mark.parametrize("workers", [2, 3])
def test_workers_change_no_number(workers, monkeypatch):
    monkeypatch.setattr(rounds, "PIECE", 16)
    options = {"place": Circle(0.2), "precision": 0.02, "budget_boxes": 1500}
    one = certified_percentiles(PATTERN, (50, 95), **options)
    more = certified_percentiles(PATTERN, (50, 95), workers=workers, **options)
    known, again = ([(p.low, p.high) for p in of.of.values()] for of in (one, more))
    assert known == again
    assert len(one.boxes.leaves) > 10 * rounds.PIECE
    assert one.boxes.leaves.tobytes() == more.boxes.leaves.tobytes()


def test_a_polygon_s_limit_that_no_belts_tell_ends_no_other_percentile(monkeypatch):
    """Shares below 3, where the median is, are known to within 0.2; all others as wanted."""
    law = Known(10.0, 2.0)

    def share(search, limit, width, **ends):
        if limit < 5.0:
            return SimpleNamespace(low=0.4, high=0.6, boxes=1, stopped="resolution")
        (below,) = law.shares([Limit(limit, 0, width)])
        return SimpleNamespace(low=below.low, high=below.high, boxes=1, stopped="")

    monkeypatch.setattr(Search, "share", share)
    place = convex_polygon([0.0, 0.0, 1.0], [0.0, 1.5, 0.7])
    found = certified_percentiles(RING, (50, 95), place=place, precision=0.05).of
    assert found[95].low < 10.0 <= found[95].high <= found[95].low / 0.95 and not found[95].stopped
    assert found[50].stopped == "nearer than shares can tell"


#: Four are in view for a tenth of the area and time, and three quarters of that with a GDOP of 4e3
#: to 5e6: boxes that tell whether a large limit holds there are as small as its reciprocal.
SINGULAR = walker_delta(6, 2, 1, inclination_deg=42.94, radius_km=20427)


@pytest.mark.slow
def test_what_no_boxes_tell_ends_before_memory_does(monkeypatch):
    monkeypatch.setattr(rounds, "OPEN", 3e6)
    places = {"figure": SPHERE, "mask": Mask()}
    share = certified_share(SINGULAR, 1e5, dop="gdop", width=1e-7, **places)
    assert share.stopped == "memory" and share.width > 0
    assert share.leaves.nbytes < 2 * 3e6
    found = certified_percentile(SINGULAR, 0.5, precision=1e-6, **places)
    assert found.stopped == "memory" and 1 < found.low < found.high < 10
    below, above = (
        certified_share(SINGULAR, end, dop="gdop", width=1e-2, **places)
        for end in (found.low, found.high)
    )
    assert below.low < 0.005 <= above.high


@pytest.mark.slow
def test_an_infinite_percentile_takes_few_boxes_in_singular_geometry():
    """Four are in view for a tenth of the area and time: no limit is kept in 95 % of it."""
    found = certified_percentiles(SINGULAR, (95,), figure=SPHERE, mask=Mask())
    assert found.of[95].low == module.GREATEST
    assert found.boxes.looked < 100_000  # five times as many to tell by each limit

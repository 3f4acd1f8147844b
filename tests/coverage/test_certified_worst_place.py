"""The share at the worst place: below that of every place, and reached by one of them."""

import numpy as np
import pytest

from compass.core.certified.everywhere import line_below
from compass.core.certified.volumes import volume
from compass.coverage import certified_worst_place as module
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Circle, Spot
from compass.coverage.certified_share import CertifiedShare, certified_share
from compass.coverage.certified_worst_place import certified_worst_place
from compass.coverage.geometry_verdict import geometry_verdict
from compass.coverage.region import read_regions
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import FIGURES, direction
from compass.orbits import walker_delta
from compass.requirement import Requirement

ELLIPSOID = FIGURES["iau-ellipsoid"]
FEW = walker_delta(6, 3, 1, inclination_deg=50, radius_km=20427)


def known_shares(monkeypatch, share):
    """Let a place have the share of a function, and a tile what its worst corner has, less a bit."""

    def of_tile(boxes, places, *_):
        b, lon, _, hb, hl, _ = boxes[0]
        hl = hl if places else 0.0
        corners = [share(b + x * hb, lon + y * hl) for x in (-1, 0, 1) for y in (-1, 0, 1)]
        low = min(corners) - 0.1 * (hb + hl)
        return low, low, len(boxes)

    def of_place(self, c, limit, *, place, **_):
        value = share(place.latitude, getattr(place, "longitude", 0.0))
        return CertifiedShare(value - 1e-6, value + 1e-6, 1, "")

    monkeypatch.setattr(module, "kept_everywhere", of_tile)
    monkeypatch.setattr(Effort, "share", of_place)


def test_the_search_ends_at_the_place_with_the_least(monkeypatch):
    """Of circles, and of places in a polygon: what lies outside has less and does not count."""
    known_shares(monkeypatch, lambda b, lon: 0.9 - 0.5 * np.sin(b - 0.1) ** 2)
    found, worst = certified_worst_place(FEW, 4.0, 0.5, south=-0.3, north=0.2)
    assert found.low >= 0.5 and worst < -0.2 and not found.stopped
    near, worst = certified_worst_place(
        FEW, 4.0, 0.9 - 0.5 * np.sin(0.4) ** 2, south=-0.3, north=0.2
    )
    assert near.high - near.low <= 1e-3 and worst == pytest.approx(-0.3, abs=0.01)
    early, _ = certified_worst_place(FEW, 4.0, 0.824, south=-0.3, north=0.2, budget_boxes=1)
    assert early.stopped == "boxes"
    known_shares(monkeypatch, lambda b, lon: 0.9 - 0.5 * abs(lon - 0.1) - 0.1 * abs(b - 0.1))
    (part,) = read_regions("polygon:0,0;0,20;15,0")
    low, high = part.latitudes()
    asked = {"since": 3600.0, "duration": 7200.0}
    found, worst = certified_worst_place(
        FEW, 4.0, 0.766, south=low, north=high, region=part, width=0.01, **asked
    )
    # the corner at 20 degrees east
    assert found.low <= 0.9 - 0.5 * (np.radians(20) - 0.1) - 0.01 <= found.high
    assert found.high - found.low <= 0.01 and worst < 0.02


def test_boxes_and_seconds_end_it_among_the_first_tiles(monkeypatch):
    """Of places all over Mars there are a hundred: nothing is known of those not looked at."""
    looks = []

    def of_tile(boxes, *_):
        looks.append(len(boxes))
        return 0.9, 0.9, 1000

    known_shares(monkeypatch, lambda b, lon: 0.95)
    monkeypatch.setattr(module, "kept_everywhere", of_tile)
    half_pi, asked = np.pi / 2, {"since": 0.0, "duration": 7200.0}
    few, _ = certified_worst_place(
        FEW, 4.0, 0.92, south=-half_pi, north=half_pi, budget_boxes=5000, **asked
    )
    assert len(looks) == 5
    assert (few.low, few.stopped) == (0.0, "boxes")
    # seconds take the place of boxes, as `check --budget-s` says
    late, _ = certified_worst_place(
        FEW, 4.0, 0.92, south=-half_pi, north=half_pi, effort=Effort(budget_s=1e-9), **asked
    )
    assert len(looks) == 5
    assert (late.low, late.stopped) == (0.0, "time")
    whole, _ = certified_worst_place(
        FEW, 4.0, 0.85, south=-half_pi, north=half_pi, budget_boxes=1e7, **asked
    )
    assert whole.low == pytest.approx(0.9, abs=1e-6) and not whole.stopped


@pytest.mark.parametrize("places", [False, True])
def test_a_line_lies_below_the_shares_of_all_places_and_near_them(places):
    """Of half-spaces at random, and of those that a corner of the box or its rim just touches."""
    g = np.random.default_rng(5)
    line = np.zeros(3)
    for k in range(200):
        cut = g.uniform(-1, 1, 3) * np.array([1.0, 1.0, 1.0 if k % 5 else 1e-3])
        threshold = g.uniform(-1.2, 1.2) * np.abs(cut[1:]).sum()
        line_below(threshold, cut, places, line)
        for x, y in (*g.uniform(-1, 1, (8, 2)), (1, 1), (-1, 1), (1, -1), (-1, -1), (0, 0)):
            w = cut[0] * x + (cut[1] * y if places else 0.0)
            share = volume(threshold - w, 0.0, 0.0 if places else cut[1], cut[2])
            assert line[0] + line[1] * x + line[2] * y <= share + 3e-9
    # a tenth of the sides: a hundredth of the loss, where the rim stays in the box
    losses = []
    for part in (0.1, 0.01):
        cut = np.array([0.5 * part, 0.3 * part if places else 0.3, 1.0])
        line_below(0.75, cut, places, line)
        losses.append(volume(0.75, 0.0, 0.0 if places else 0.3, 1.0) - line[0])
    assert losses[1] <= 0.011 * losses[0] + 3e-9


@pytest.mark.slow
def test_no_place_has_a_fold_for_less_time_and_one_has_it_for_no_more():
    """Of circles for ever, of places over hours and of belts whose patterns repeat."""
    c = walker_delta(15, 5, 1, inclination_deg=45, orbit="areosynchronous")
    mask, day = np.radians(15), 88642.66
    g = np.random.default_rng(1)
    found, worst = certified_worst_place(
        c, 4, None, dop="fold", mask=mask, south=0.0, north=np.radians(45), budget_boxes=3e5
    )
    assert found.high - found.low < 2e-3
    for latitude in (worst, *g.uniform(0.0, np.radians(45), 20)):
        at = certified_share(c, 4, dop="fold", mask=mask, place=Circle(latitude), width=1e-3)
        assert found.low <= at.high
    (part,) = read_regions("polygon:10,60;10,100;40,100;40,60")
    low, high = part.latitudes()
    asked = {"dop": "fold", "mask": mask, "since": 0.0, "duration": day}
    found, _ = certified_worst_place(
        c, 4, None, south=low, north=high, region=part, budget_boxes=2e5, **asked
    )
    belt = {"south": 0.0, "north": np.radians(45), "longitudes": np.radians(24)}
    everywhere, _ = certified_worst_place(c, 4, None, budget_boxes=1e5, **belt, **asked)
    assert max(found.high - found.low, everywhere.high - everywhere.low) < 0.05
    for _ in range(40):
        latitude, longitude = g.uniform(-np.radians(45), np.radians(45)), g.uniform(-np.pi, np.pi)
        at = certified_share(c, 4, place=Spot(latitude, longitude), width=1e-3, **asked)
        assert everywhere.low <= at.high
        if part.contains(direction(latitude, longitude)):
            assert found.low <= at.high


@pytest.mark.slow
def test_no_place_has_less_and_one_has_no_more():
    """Of circles for ever, and of places over some hours, each by the share of itself."""
    limit, south, north = 4.0, -0.3, 0.2
    found, worst = certified_worst_place(
        FEW, limit, 0.5, south=south, north=north, figure=ELLIPSOID, budget_boxes=2000
    )
    assert south <= worst <= north and found.low <= found.high
    for latitude in (*np.linspace(south, north, 4), worst):
        at = certified_share(FEW, limit, place=Circle(latitude), figure=ELLIPSOID, width=0.1)
        assert found.low <= at.high
    assert at.low <= found.high
    (part,) = read_regions("polygon:0,0;0,20;15,0")
    low, high = part.latitudes()
    asked = {"since": 3600.0, "duration": 7200.0}
    found, worst = certified_worst_place(
        FEW, limit, 0.5, south=low, north=high, region=part, budget_boxes=500, **asked
    )
    for latitude, longitude in ((0.0, 0.1), (0.05, 0.2), (0.2, 0.02)):
        assert part.contains(direction(latitude, longitude))
        at = certified_share(FEW, limit, place=Spot(latitude, longitude), width=0.1, **asked)
        assert found.low <= at.high
    assert low <= worst <= high


@pytest.mark.slow
def test_the_least_share_of_a_published_pattern_on_its_circles_and_places():
    """Of 17/17/3, whose grid shows 0.9456 at places and 0.9916 on circles, no more can be."""
    c = walker_delta(17, 17, 3, inclination_deg=44.2, orbit="areosynchronous")
    band = {"south": np.radians(30), "north": np.radians(34), "mask": np.radians(5)}
    circle, latitude = certified_worst_place(c, 6.0, 0.97, **band)
    assert circle.low >= 0.97 and not circle.stopped
    at = certified_share(c, 6.0, place=Circle(latitude), mask=band["mask"], width=1e-3)
    assert circle.low <= at.high and at.low <= circle.high
    told, _ = certified_worst_place(c, 6.0, 0.9917, **band)
    assert told.high <= 0.9917
    place, _ = certified_worst_place(c, 6.0, 0.9456, since=0.0, duration=88642.66, **band)
    assert place.high < 0.9456


@pytest.mark.slow
def test_a_requirement_at_the_worst_place_of_a_region_is_met_or_missed():
    c = walker_delta(24, 6, 1, inclination_deg=55, radius_km=20427)
    easy = Requirement("band", regions=("lat:-5:5",), share=0.3)
    met = geometry_verdict(Design(c), easy, "pdop", 20.0)
    assert (met.met, met.evidence, met.worst.of) == (True, "bracket", "share")
    assert abs(met.worst.latitude) <= np.radians(5)
    hard = Requirement("band", regions=("lat:0:30",), share=0.9)
    missed = geometry_verdict(Design(FEW), hard, "pdop", 3.0)
    assert missed.met is False and missed.share[1] < 0.9
    with pytest.raises(ArgumentError, match=r"limit = 0.5: a dilution of precision"):
        certified_worst_place(FEW, 0.5, 0.5, south=0.0, north=0.1)

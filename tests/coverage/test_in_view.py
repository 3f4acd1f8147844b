"""How many are in view: the mean against exact areas, the extremes against places that have them."""

from types import SimpleNamespace

import numpy as np
import pytest

from compass.coverage.drawn import drawn
from compass.coverage.fold import clearances
from compass.coverage.in_view import satellites_in_view
from compass.coverage.share import mean_fold_shares
from compass.design import Design
from compass.frames import FIGURES, direction
from compass.orbits import positions_mci, walker_delta
from compass.orbits.constellation import keplerian
from compass.sites import Mask

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]
PATTERN = walker_delta(9, 3, 1, inclination_deg=50, radius_km=20000)
ELLIPSES = keplerian(
    np.full(6, 15e6), np.full(6, 0.4), np.full(6, 1.0), np.arange(6.0), np.arange(6.0) / 2,
    np.arange(6.0) * 1.1,
)  # fmt: skip


def shares(*bounds):
    return {k: SimpleNamespace(low=low, high=high) for k, (low, high) in enumerate(bounds, 1)}


@pytest.mark.slow
@pytest.mark.parametrize("orbits", [PATTERN, ELLIPSES])
def test_the_mean_is_that_of_exact_areas(orbits):
    found = satellites_in_view(orbits, {}, (0, 9), figure=SPHERE, mask=Mask.of(7))
    exact = mean_fold_shares(
        orbits, sphere_radius=SPHERE.equatorial_radius, mask=np.radians(7), tolerance=1e-9
    )
    mean = exact.share @ np.arange(exact.share.size)
    off = 10 * exact.error + 1e-12
    assert found.mean[0] == found.mean[1] == pytest.approx(mean, abs=off)


@pytest.mark.slow
@pytest.mark.parametrize("figure", [SPHERE, ELLIPSOID])
@pytest.mark.parametrize("mask", [Mask.of(5), Mask.of([[0, 2], [90, 20], [180, 4], [270, 11]])])
def test_random_places_have_no_fewer_and_no_more(figure, mask):
    found = satellites_in_view(PATTERN, {}, (0, 9), figure=figure, mask=mask)
    design = Design(PATTERN, name="d", figure=figure.name, mask=mask)
    count = drawn(design, (0.0, 1e7), draws=4000).count
    assert found.least[0] <= count.min() and count.max() <= found.most[1]
    if mask.is_constant:
        # both are settled, and of thousands of places some have them
        assert found.least == (count.min(),) * 2 and found.most == (count.max(),) * 2
    else:
        assert found.least[0] < found.least[1] and found.most[0] < found.most[1]


@pytest.mark.slow
def test_a_span_later_on_is_looked_at_itself():
    """Minutes of two satellites over one place: before and after there are fewer, and more."""
    when = {"since": 5000.0, "duration": 60.0}
    found = satellites_in_view(PATTERN, {}, (0, 9), figure=SPHERE, mask=Mask(), **when)
    g = np.random.default_rng(2)
    counts = []
    for time in g.uniform(5000.0, 5060.0, 40):
        places = direction(np.arcsin(g.uniform(-1, 1, 2000)), g.uniform(-np.pi, np.pi, 2000))
        clear = clearances(
            positions_mci(PATTERN, [time])[:, 0], SPHERE.equatorial_radius, 0.0, places
        )
        counts.append((clear >= 0.0).sum(axis=1))
    assert found.least[0] <= np.min(counts) and np.max(counts) <= found.most[1]
    assert found.least[0] == found.least[1]


def test_other_motions_are_told_by_shares_of_all_and_of_nothing():
    folds = shares((1.0, 1.0), (0.9, 0.95), (0.2, 0.3), (0.0, 0.0))
    asked = {"figure": ELLIPSOID, "mask": Mask(), "motion": "j2"}
    found = satellites_in_view(PATTERN, folds, (1, 3), **asked)
    assert (found.least, found.most) == ((1, 1), (3, 3))
    assert found.mean == pytest.approx((2.1, 2.25))
    # a fold that was not asked for, and one more than was found, are possible
    found = satellites_in_view(PATTERN, shares((0.8, 0.9), (0.1, 0.2)), (0, 2), **asked)
    assert (found.least, found.most) == ((0, 0), (2, 9))
    assert found.mean == pytest.approx((0.9, 1.1 + 7 * 0.2))
    assert found.numbers()["max"] == 2 and found.numbers()["max_bracket"] == [2, 9]
    assert satellites_in_view(PATTERN, {}, (0, 2), **asked).mean == (0, 9.0)


def test_many_satellites_over_long_are_not_proven_one_by_one(monkeypatch):
    monkeypatch.setattr("compass.coverage.in_view.MOST_PAIRS", 10)
    found = satellites_in_view(PATTERN, {}, (2, 6), figure=SPHERE, mask=Mask())
    assert (found.least, found.most) == ((0, 2), (6, 9))

"""Shares by fold: pointwise in a box, against exact areas, and against random points."""

import math

import numpy as np
import pytest

from compass.core.certified.shares import in_view
from compass.core.certified.sights import FALL, HIGH, LOW, RISE, WIDTH
from compass.coverage.certified_places import Spot
from compass.coverage.certified_share import certified_folds
from compass.coverage.region import convex_polygon
from compass.coverage.share import mean_fold_shares
from compass.errors import ArgumentError
from compass.frames import DEFAULT_FIGURE, FIGURES
from compass.orbits import positions_mcmf, walker_delta
from compass.orbits.constellation import keplerian
from compass.sites import Mask, Site

PATTERN = walker_delta(9, 3, 1, inclination_deg=50, radius_km=20000)
FOLDS = (1, 2, 3, 4, 5)
MASK = math.radians(5)


def inside(found, share, error):
    """Whether a share lies within bounds, allowing for its own error."""
    return found.low - error <= share <= found.high + error


@pytest.mark.parametrize("seed", range(40))
def test_bounds_in_a_box_are_those_of_random_planes(seed):
    """What is surely seen, and surely hidden, is less than what random points of the box say."""
    g = np.random.default_rng(seed)
    count = int(g.integers(0, 6))
    rows, kinds = np.zeros((count + 1, WIDTH)), g.integers(1, 3, count + 1)
    rows[:, HIGH : HIGH + 4] = rows[:, LOW : LOW + 4] = g.normal(size=(count + 1, 4))
    rows[:, FALL], rows[:, RISE] = g.uniform(0, 0.2, (2, count + 1))
    heights = rows[:count, HIGH, None] + rows[:count, HIGH + 1 : HIGH + 4] @ g.uniform(
        -1, 1, (3, 20_000)
    )
    sure = kinds[:count, None] == 1
    seen = ((heights > rows[:count, FALL, None]) | sure).sum(axis=0)
    hidden = ((heights < -rows[:count, RISE, None]) & ~sure).sum(axis=0)
    folds, parts = np.arange(1.0, count + 3), np.zeros(2 * (count + 2))
    in_view(rows, kinds, count, folds, parts)
    kept, broken = parts[: folds.size], parts[folds.size :]
    for k, fold in enumerate(folds):
        assert kept[k] <= (seen >= fold).mean() + 0.02
        assert broken[k] <= (hidden > count - fold).mean() + 0.02
    # one doubtful satellite, or none, is told in full
    if (kinds[:count] == 2).sum() <= 1:
        assert kept == pytest.approx([(seen >= fold).mean() for fold in folds], abs=0.02)
        assert broken == pytest.approx([(hidden > count - f).mean() for f in folds], abs=0.02)
    in_view(rows, kinds, -1, folds, parts)
    assert not parts.any()


def test_all_folds_hold_the_exact_areas():
    exact = mean_fold_shares(
        PATTERN, sphere_radius=DEFAULT_FIGURE.equatorial_radius, mask=MASK, tolerance=1e-5
    )
    found = certified_folds(PATTERN, FOLDS, width=0.01, mask=MASK)
    for fold, one in zip(FOLDS, found, strict=True):
        assert inside(one, exact.share[fold:].sum(), exact.error)
        assert one.width <= 0.01 and not one.stopped
    assert found[0].low == found[1].low == 1.0 and found[4].high < 0.5  # always two
    finer = certified_folds(PATTERN, FOLDS, width=5e-3, mask=MASK, start=found[0])
    for one, before in zip(finer, found, strict=True):
        assert before.low <= one.low <= one.high <= before.high and one.width <= 5e-3


@pytest.mark.parametrize("place", [Spot(0.6, 1.0), convex_polygon([0, 0, 1.0], [0, 1.5, 0.7])])
def test_other_orbits_masks_and_places_meet_random_points(place):
    """Of ellipses over a horizon with azimuths on the ellipsoid; no symmetry helps."""
    g = np.random.default_rng(5)
    c = keplerian(
        g.uniform(9e6, 2e7, 7), g.uniform(0, 0.3, 7), g.uniform(0.2, 2, 7),
        *(g.uniform(0, 6, 7) for _ in range(3)),
    )  # fmt: skip
    figure, mask = FIGURES["iau-ellipsoid"], Mask.of([[0, 2], [90, 20], [180, 4], [270, 11]])
    asked = {"figure": figure, "mask": mask, "place": place, "duration": 2e4}
    found = certified_folds(c, (1, 2, 3), width=0.04, budget_boxes=4e5, **asked)
    n = 4000
    times, counts = g.uniform(0, 2e4, n), np.zeros(n)
    r = positions_mcmf(c, times)
    latitudes, longitudes = np.full(n, 0.6), np.full(n, 1.0)
    if not isinstance(place, Spot):
        tried = g.normal(size=(40 * n, 3))
        tried = tried[(tried @ place.normals.T >= 0).all(axis=1)][:n]
        latitudes = np.arctan2(tried[:, 2], np.hypot(*tried[:, :2].T))
        longitudes = np.arctan2(tried[:, 1], tried[:, 0])
    for k in range(n):
        site = Site("", latitudes[k], longitudes[k], 0.0, mask, figure)
        counts[k] = site.sees(r[:, k]).sum()
    for fold, one in zip((1, 2, 3), found, strict=True):
        # geodetic and planetocentric areas differ by less than a hundredth
        assert inside(one, (counts >= fold).mean(), 5 * math.sqrt(0.25 / n))
        assert one.width <= 0.04


def test_one_satellite_is_enough_and_a_fold_of_none_is_refused():
    one = certified_folds(PATTERN.without(range(8)), (1, 2), width=0.05)
    assert one[0].low > 0.3 and one[1].high == 0.0
    with pytest.raises(ArgumentError, match="fold = 0: satellites to ask for are 1 or more"):
        certified_folds(PATTERN, (0,))

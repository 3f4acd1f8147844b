"""The percentile of the worst zone of latitude, against each zone and random points of it."""

from itertools import pairwise

import numpy as np
import pytest

from compass.coverage.certified_percentile import certified_percentile
from compass.coverage.certified_zone import certified_worst_zone
from compass.coverage.region import latitude_band
from compass.frames import FIGURES, direction
from compass.orbits import positions_mci, walker_delta

SPHERE = FIGURES["iau-sphere"]
EDGES = np.radians([-90.0, -60.0, -30.0, 0.0])
ZONES = [latitude_band(*pair) for pair in pairwise(EDGES.tolist())]
MASK = np.radians(5.0)


def pattern(satellites, planes, phasing, inclination):
    return walker_delta(satellites, planes, phasing, inclination_deg=inclination, radius_km=20427.7)


@pytest.mark.slow
@pytest.mark.parametrize("numbers", [(15, 3, 1, 45), (16, 16, 13, 45), (24, 6, 2, 55)])
@pytest.mark.parametrize("guess", [1.0, 8.0, 1e6])
def test_the_worst_zone_is_the_worst_of_all(numbers, guess):
    c, near = pattern(*numbers), {"precision": 0.05, "budget_boxes": 1e6}
    asked = {"figure": SPHERE, "mask": MASK}
    found = certified_worst_zone(c, 95.0, ZONES, guess=guess, **near, **asked)
    each = [certified_percentile(c, 95.0, place=zone, **near, **asked) for zone in ZONES]
    assert found.low <= max(one.high for one in each)
    assert found.high >= max(one.low for one in each)
    assert found.high - found.low <= 0.06 * found.high


@pytest.mark.slow
def test_north_and_south_together_are_as_each_alone():
    c = pattern(15, 3, 1, 45)
    found = certified_worst_zone(
        c, 95.0, ZONES, guess=9.0, precision=0.02, budget_boxes=1e6, figure=SPHERE, mask=MASK
    )
    random = np.random.default_rng(5)
    worst = 0.0
    for south, north in pairwise(EDGES.tolist()):
        sine = random.uniform(np.sin(south), np.sin(north), 4000)
        side = random.choice([-1, 1], sine.size)
        users = direction(side * np.arcsin(sine), random.uniform(0, 2 * np.pi, sine.size))
        times = random.uniform(0, 2 * np.pi / c.mean_motion[0], sine.size)
        r = positions_mci(c, times) / SPHERE.equatorial_radius
        lines = np.moveaxis(r, 0, 1) - users[:, np.newaxis]
        lines /= np.linalg.norm(lines, axis=-1, keepdims=True)
        up = np.einsum("tsx,tx->ts", lines, users) >= np.sin(MASK)
        h = np.concatenate([lines, np.ones((*lines.shape[:2], 1))], axis=-1) * up[..., np.newaxis]
        normal = np.einsum("tsx,tsy->txy", h, h)
        gdop = np.sqrt(np.trace(np.linalg.pinv(normal), axis1=1, axis2=2))
        gdop[up.sum(axis=1) < 4] = np.inf
        gdop = np.sort(gdop)
        # three sigmas of how many of the points lie below
        reach = 3.0 * np.sqrt(0.95 * 0.05 * gdop.size)
        at = 0.95 * gdop.size
        assert gdop[int(at - reach)] <= found.high
        worst = max(worst, gdop[int(at + reach)])
    assert worst >= found.low


def test_where_too_few_are_seen_it_is_infinite():
    c = pattern(4, 2, 0, 10)
    found = certified_worst_zone(
        c, 95.0, ZONES, guess=np.inf, precision=0.5, budget_boxes=1e4, figure=SPHERE, mask=MASK
    )
    assert found.low >= 1e5 and found.high == np.inf
